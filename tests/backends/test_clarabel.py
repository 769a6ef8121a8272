"""Clarabel on programs solved by hand: value, velocity and every dual with its sign (T35)."""

from dataclasses import replace

import clarabel
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import csr_matrix, vstack

import lacore as la
from lacore.paths.flow import Moment, limit_problem
from lacore.paths.stage import staged
from lacore.program.certificate import certify
from lacore.program.kinematic import (
    ContactRows,
    DissipationGroup,
    FrozenContact,
    KinematicProgram,
    reaction_contact,
)
from lacore.program.regularization import Penalties
from lacore.reporting.status import Status
from lacore.solvers.backend import find_backend
from lacore_backends import clarabel_socp
from lacore_backends._conic_form import ConicForm, Pattern
from lacore_verification.conformance.soil_programs import SOIL
from tests.backends.hand_made import CONIC, LINEAR, check_answer, random_linear_program

# The default tolerance is 1e-9 on scaled residuals; numbers here are of order one to ten.
BAR = 1e-7


def group(rows, volumetric, weight, bound):
    rows = np.atleast_2d(rows)
    return DissipationGroup(
        name="body",
        rows=csr_matrix(rows, dtype=float),
        dim=rows.shape[0],
        weights=np.array([weight]),
        bound=np.array([bound]),
        volumetric=csr_matrix(np.atleast_2d(volumetric), dtype=float),
        volumetric_factor=1.0,
    )


def contact(normal, tangential, weights):
    """Rows (points, n); laws are given by what the test freezes."""
    normal, tangential = np.atleast_2d(normal), np.atleast_2d(tangential)
    zero = np.zeros(len(weights))
    return ContactRows(
        normal=csr_matrix(normal, dtype=float),
        tangential=csr_matrix(tangential, dtype=float),
        tangent_dim=1,
        weights=np.array(weights, dtype=float),
        coefficient=zero,
        limit=zero,
        dilatancy=zero,
        interface=zero.astype(int),
    )


def no_contact(n):
    return contact(np.zeros((0, n)), np.zeros((0, n)), [])


def program(groups, rows, reference, dead=None):
    reference = np.array(reference, dtype=float)
    dead = np.zeros(reference.size) if dead is None else np.array(dead, dtype=float)
    return KinematicProgram(tuple(groups), rows, reference, dead)


def frozen(bound=(), dilatancy=0.0, shift=0.0):
    bound = np.array(bound, dtype=float)
    return FrozenContact(bound, np.zeros(bound.size) + dilatancy, np.zeros(bound.size) + shift)


def prepared(stated, **options):
    backend = find_backend("clarabel")
    return backend.prepare(stated, backend.Options(**options))


def solve(stated, held=None, **options):
    return prepared(stated, **options).solve(held or frozen())


# One cone, by hand.


def test_stress_follows_the_strain_rate():
    """min 2 * 3 ||U||, (0.6, 0.8).U = 1: U = F0, alpha = 6, w s = alpha F0."""
    answer = solve(program([group(np.eye(2), [0, 0], 2.0, 3.0)], no_contact(2), [0.6, 0.8]))
    assert (answer.status, answer.native_status) == (Status.SOLVED, "Solved")
    assert answer.iterations > 0
    assert answer.solve_time > 0
    point = answer.point
    assert point.velocity == pytest.approx([0.6, 0.8], abs=BAR)
    assert point.load_factor == pytest.approx(6, abs=10 * BAR)
    assert point.stress[0][0] == pytest.approx([1.8, 2.4], abs=10 * BAR)


@pytest.mark.parametrize("sense", [1, -1])
def test_mean_stress_is_positive_in_tension(sense):
    """U = (1, 1) by theta = sense (u_0 - u_1) = 0; w s + w p theta = alpha F0."""
    stated = program([group(np.eye(2), [sense, -sense], 2.0, 3.0)], no_contact(2), [1.0, 0.0])
    point = solve(stated).point
    assert point.velocity == pytest.approx([1, 1], abs=BAR)
    assert point.load_factor == pytest.approx(6 * np.sqrt(2), abs=10 * BAR)
    assert point.stress[0][0] == pytest.approx([3 / np.sqrt(2)] * 2, abs=10 * BAR)
    assert point.mean_stress[0] == pytest.approx([sense * 3 / np.sqrt(2)], abs=10 * BAR)


# One contact point under a weight W = 5: unknowns (u_n, u_t), length 2.

W, LENGTH = 5.0, 2.0


def point_of_contact(reference=(0.0, 1.0), dead=(-W, 0.0)):
    return program([], contact([1, 0], [0, 1], [LENGTH]), reference, dead)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_frozen_friction(sense):
    """alpha = L g; compression t_n = W/L; t_t = g against the slip."""
    point = solve(point_of_contact((0.0, sense)), frozen([0.7])).point
    assert point.load_factor == pytest.approx(LENGTH * 0.7, abs=BAR)
    assert point.velocity == pytest.approx([0, sense], abs=BAR)
    assert point.normal_reaction == pytest.approx([W / LENGTH], abs=BAR)
    assert point.tangential_reaction[0] == pytest.approx([-sense * 0.7], abs=BAR)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_dilatancy(sense):
    """u_n = d |u_t|: alpha = W d, and t_t = d t_n against the slip."""
    point = solve(point_of_contact((0.0, sense)), frozen([0.0], dilatancy=0.4)).point
    assert point.load_factor == pytest.approx(W * 0.4, abs=BAR)
    assert point.velocity == pytest.approx([0.4, sense], abs=BAR)
    assert point.normal_reaction == pytest.approx([W / LENGTH], abs=BAR)
    assert point.tangential_reaction[0] == pytest.approx([-sense * 0.4 * W / LENGTH], abs=BAR)


@pytest.mark.parametrize(("dilatancy", "u_n"), [(0.0, -0.3), (0.4, 0.1)])
def test_shift(dilatancy, u_n):
    """u_n + 0.3 >= d |u_t|; the multiplier of F0.U = 1 does not count the shift (T10)."""
    held = frozen([0.0], dilatancy, shift=0.3)
    point = solve(point_of_contact(), held).point
    assert point.velocity == pytest.approx([u_n, 1], abs=BAR)
    assert point.load_factor == pytest.approx(W * dilatancy, abs=BAR)
    assert point.normal_reaction == pytest.approx([W / LENGTH], abs=BAR)


def test_stick():
    """Pulled up and along: held along, so only what lifts does power."""
    point = solve(point_of_contact((1.0, 3.0)), frozen([np.inf])).point
    assert point.velocity == pytest.approx([1, 0], abs=BAR)
    assert point.load_factor == pytest.approx(W, abs=BAR)
    assert point.tangential_reaction[0] == pytest.approx([-3 * W / LENGTH], abs=BAR)
    assert point.normal_reaction == pytest.approx([0], abs=BAR)


def test_opening():
    """Lifted: no reaction, alpha = W; friction of the same sense as nothing."""
    point = solve(point_of_contact((1.0, 0.0)), frozen([0.7])).point
    assert point.load_factor == pytest.approx(W, abs=BAR)
    assert point.normal_reaction == pytest.approx([0], abs=BAR)


def test_a_dead_load_that_drives_makes_the_load_factor_negative():
    point = solve(point_of_contact(dead=(-W, 3.0)), frozen([0.7])).point
    assert point.load_factor == pytest.approx(LENGTH * 0.7 - 3.0, abs=BAR)


# Cones of one row and of more rows.


@pytest.mark.parametrize("name", [*LINEAR, *CONIC])
def test_known_programs(name):
    """Both kinds of rows, with every dual and its sign."""
    known = (LINEAR | CONIC)[name]
    answer = solve(known.program, known.contact)
    assert answer.status is Status.SOLVED
    check_answer(known, answer.point, BAR)


def form(stated, held, penalty=None):
    return ConicForm(stated, held, Pattern.of(held), penalty)


@pytest.mark.parametrize("name", [*LINEAR, *CONIC])
def test_plane_blocks_and_frames_are_linear(name):
    """All cones of one row; those of dilatant points are half-spaces, no cones."""
    known = (LINEAR | CONIC)[name]
    built = form(known.program, known.contact)
    curved = [cone for cone in built.cones if isinstance(cone, clarabel.SecondOrderConeT)]
    assert built.linear == (name in LINEAR)
    if name in ("dilatancy", "shift"):
        assert not curved
    assert built.matrix.shape[0] == sum(cone.dim for cone in built.cones)


@pytest.mark.parametrize("penalty", [None, Penalties(1.0, 1.0, 1.0, 1.0)])
def test_rows_of_no_volume_are_not_there(penalty):
    """A hinge has no theta: no equality says 0 = 0, and no cone gets a row of zeros."""
    cones = [group([1.0, 0.0], [0.0, 0.0], 1.0, 2.0), group([0.0, 1.0], [1.0, -1.0], 1.0, 2.0)]
    built = form(program(cones, no_contact(2), [1.0, 1.0]), frozen(), penalty)
    rows = abs(built.matrix).sum(axis=1)
    assert built.cones[0].dim == 2  # F0.U = 1 and one theta
    assert np.all(rows > 0)
    assert [cone.dim for cone in built.cones[1:]] == ([2, 2] if penalty is None else [2, 3])


# Programs of random numbers.


def random_program(rng, points=4):
    n, cones = 12, 5
    body = DissipationGroup(
        name="body",
        rows=csr_matrix(rng.uniform(-1, 1, (2 * cones, n))),
        dim=2,
        weights=10 ** rng.uniform(-2, 0, cones),
        bound=rng.uniform(0.5, 2, cones),
        volumetric=csr_matrix(rng.uniform(-1, 1, (cones, n))),
        volumetric_factor=1.0,
    )
    rows = contact(
        rng.uniform(-1, 1, (points, n)),
        rng.uniform(-1, 1, (points, n)),
        rng.uniform(0.1, 1, points),
    )
    return program([body], rows, rng.uniform(-1, 1, n), 1e-3 * rng.uniform(-1, 1, n))


@given(seed=st.integers(0, 10**6))
def test_all_kinds_of_contact_in_one_program(seed):
    """Whatever the mixture, the answer satisfies every law, and equilibrium with its signs."""
    rng = np.random.default_rng(seed)
    stated = random_program(rng)
    bound = rng.choice([0.0, 0.3, np.inf], 4)
    dilatancy = np.where(bound == 0, rng.choice([0.0, 0.5], 4), 0.0)
    held = FrozenContact(bound, dilatancy, np.zeros(4))
    answer = solve(stated, held)
    assert answer.status is Status.SOLVED
    # The tolerance of 1e-9 on scaled rows, weights from 0.01: two digits of margin.
    certificate = certify(stated, answer.point, held)
    assert certificate.holds(1e-6), certificate


# Repeated solves.


@pytest.fixture
def built(monkeypatch):
    """How often a solver was built."""
    count = []

    build = clarabel.DefaultSolver

    def counted(*given):
        count.append(1)
        return build(*given)

    monkeypatch.setattr(clarabel, "DefaultSolver", counted)
    return count


def same(one, other):
    """The same numbers to what two solves of one strictly convex value agree to."""
    assert one.status is other.status
    assert one.point.load_factor == pytest.approx(other.point.load_factor, abs=BAR)
    assert one.point.velocity == pytest.approx(other.point.velocity, abs=1e-4)
    assert one.point.normal_reaction == pytest.approx(other.point.normal_reaction, abs=1e-4)


SEQUENCE = [
    frozen([0.3, 0.2, 0.1, 0.4]),
    frozen([0.1, 0.5, 0.6, 0.2]),  # costs only
    frozen([0.1, 0.5, 0.6, 0.2], shift=[0.1, 0.0, 0.2, 0.0]),  # and offsets
    frozen([0.0, 0.5, np.inf, 0.2]),  # other rows
    frozen([0.0] * 4, dilatancy=[0.3, 0.0, 0.2, 0.1]),
    frozen([0.0] * 4, dilatancy=[0.3, 0.0, 0.2, 0.1], shift=[0.3, 0.3, 0.0, 0.0]),
    frozen([0.0] * 4, dilatancy=[0.5, 0.0, 0.2, 0.1]),
    frozen([0.3, 0.2, 0.1, 0.4]),
]


@pytest.mark.parametrize("seed", range(3))
def test_repeated_solves_are_fresh_solves(seed):
    stated = random_program(np.random.default_rng(seed))
    solver = prepared(stated)
    for held in SEQUENCE:
        same(solver.solve(held), solve(stated, held))


def test_a_change_of_costs_builds_nothing(built):
    solver = prepared(random_program(np.random.default_rng(0)))
    for held in SEQUENCE[:3]:
        assert solver.solve(held).status is Status.SOLVED
    assert len(built) == 1
    solver.solve(SEQUENCE[3])
    assert len(built) == 2


@pytest.mark.parametrize("linear", [True, False])
def test_alternation_builds_two_forms(built, linear):
    """Bounds and shifts in turn (T12), of which every one answers like a fresh solver."""
    stated = (random_linear_program if linear else _random)(0)
    turns = [
        frozen(bound, dilatancy, shift)
        for size in (0.1, 0.2, 0.3)
        for bound, dilatancy, shift in (([size] * 4, 0.0, 0.0), ([0.0] * 4, 0.5, size))
    ]
    solver = prepared(stated)
    answers = [solver.solve(held) for held in turns]
    assert len(built) == 2
    solver.solve(frozen([np.inf] * 4))  # a third takes the place of the oldest
    solver.solve(turns[-1])
    assert len(built) == 3
    solver.solve(turns[0])
    assert len(built) == 4
    for held, answer in zip(turns, answers, strict=True):
        same(answer, solve(stated, held))


def _random(seed):
    return random_program(np.random.default_rng(seed))


def test_a_failed_solve_spoils_nothing():
    """Infeasible bounds in the middle of a loop, then sound ones again."""
    stated = point_of_contact(reference=(1.0, 0.0), dead=(-W, 3.0))
    solver = prepared(stated)
    first = solver.solve(frozen([2.0]))
    assert first.status is Status.SOLVED
    assert solver.solve(frozen([1.0])).status is Status.UNSAFE  # 2 g < 3
    same(solver.solve(frozen([2.0])), first)


# Statuses.


def test_infeasible_is_locked():
    """u_n >= 0 and F0.U = -u_n = 1."""
    answer = solve(point_of_contact((-1.0, 0.0)), frozen([0.5]))
    assert answer.status is Status.LOCKED
    assert answer.point is None


def test_locked_by_stick():
    assert solve(point_of_contact((0.0, 1.0)), frozen([np.inf])).status is Status.LOCKED


def test_locked_by_incompressibility():
    stated = program([group([1.0, 0.0], [0.0, 1.0], 1.0, 1.0)], no_contact(2), [0.0, 1.0])
    assert solve(stated).status is Status.LOCKED


def test_unbounded_is_unsafe():
    """A dead load of 3 along a frozen friction of L g = 1.4."""
    answer = solve(point_of_contact((1.0, 0.0), (-W, 3.0)), frozen([0.7]))
    assert answer.status is Status.UNSAFE
    assert answer.point is None


@pytest.mark.parametrize(
    ("options", "status"),
    [
        ({"max_iterations": 1}, Status.ITERATION_LIMIT),
        ({"time_limit": 1e-9}, Status.TIME_LIMIT),
    ],
)
def test_limits_leave_a_point(options, status):
    answer = solve(random_program(np.random.default_rng(0)), SEQUENCE[0], **options)
    assert answer.status is status
    assert np.all(np.isfinite(answer.point.velocity))


def test_every_native_status_has_a_meaning():
    native = {name for name in dir(clarabel.SolverStatus) if name[0].isupper()}
    assert len(native) > 8
    assert native == set(clarabel_socp.STATUS_MAP)


# The plug.


def test_registered():
    assert "clarabel" in la.backend_names()
    backend = find_backend("clarabel")
    assert backend.name == "clarabel"
    assert backend.unavailable() == ""
    assert not backend.capabilities.regularised
    assert backend.capabilities.max_unknowns is None
    assert backend.title
    assert backend.source


@pytest.mark.parametrize("name", ["tolerance", "max_iterations", "time_limit"])
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan])
def test_options_refuse(name, value):
    backend = find_backend("clarabel")
    with pytest.raises(la.InputError, match=f"clarabel.{name} = .*> 0"):
        backend.Options(**{name: value})


def test_tolerance_is_that_of_the_answer():
    """Tighter is closer, on a value known by hand."""
    stated = program([group(np.eye(2), [0, 0], 2.0, 3.0)], no_contact(2), [0.6, 0.8])
    errors = [
        abs(solve(stated, tolerance=tolerance).point.load_factor - 6) for tolerance in (1e-3, 1e-10)
    ]
    assert errors[1] < 1e-8
    assert errors[1] <= errors[0]


def test_weights_do_not_touch_the_stress():
    """Rows are multiplied by their weight, so that duals are stresses on any grading (T34)."""
    point = {
        weight: solve(
            program([group(np.eye(2), [1, -1], weight, 3.0)], no_contact(2), [1.0, 0.0])
        ).point
        for weight in (1e-4, 1.0)
    }
    assert point[1e-4].stress[0] == pytest.approx(point[1.0].stress[0], abs=1e-5)
    assert point[1e-4].load_factor * 1e4 == pytest.approx(point[1.0].load_factor, rel=1e-4)


def shared_out(stated, shares, dilation):
    """A program of one point of soil, as points that have shares of its weight."""
    (one,) = stated.groups
    many = np.zeros(len(shares), dtype=int)
    surfaces = replace(one.surfaces.at(many), dilation=np.full(many.size * one.volumes, dilation))
    points = replace(
        one,
        rows=csr_matrix(vstack([one.rows] * many.size)),
        volumetric=csr_matrix(vstack([one.volumetric] * many.size)),
        weights=one.weights[many] * shares,
        bound=one.bound[many],
        modulus=None if one.modulus is None else one.modulus[many],
        surfaces=surfaces,
    )
    return replace(stated, groups=(points,))


@pytest.mark.parametrize("dilation", [0.0, 0.1])
@pytest.mark.parametrize("known", SOIL, ids=lambda known: known.name)
def test_points_of_soil_may_be_of_any_size(known, dilation):
    """Rows of small ones are in units of their own: what answers mean is not touched by it."""
    held = known.contact
    whole = solve(shared_out(known.program, [1.0], dilation), held)
    parts = shared_out(known.program, [0.9, 0.09, 0.01 - 1e-6, 1e-6], dilation)
    answer = solve(parts, held)
    assert answer.status is whole.status is Status.SOLVED
    assert answer.point.load_factor == pytest.approx(whole.point.load_factor, abs=BAR)
    assert answer.point.velocity == pytest.approx(whole.point.velocity, abs=BAR)
    certificate = certify(parts, answer.point, held)
    assert certificate.equilibrium < BAR
    if known.program.groups[0].modulus is None:  # which raises strengths
        assert certificate.yield_violation < BAR


def step_of_two_blocks():
    """The first limit problem of the path of a block that is pressed on another one."""
    steel = la.VonMises(hardening=la.hardening.Linear(1.0, 1.0))
    bodies = {
        name: la.Body(la.meshes.rectangle((0, 1), y, 4, 2), steel, space="p2-gauss")
        for name, y in (("lower", (0, 0.5)), ("upper", (0.5, 1)))
    }
    problem = la.Problem(
        bodies,
        [la.RigidFooting("lower", "bottom", (0, 1), rough=False)],
        [*(la.Fix(name, "left", "x") for name in bodies), la.Fix("upper", "top", "xy")],
        [la.Interface(("lower", "top"), ("upper", "bottom"), 0.2)],
    )
    stage = staged(problem, ())
    return limit_problem(stage, Moment(stage.start, stage.start, 0.01, 0.5)).program


@pytest.mark.parametrize("place", [0, 4, 7, 8])
def test_short_contact_points_of_a_path_are_solved_as_accurately(place):
    """Where sides overlap by a thousandth of an edge."""
    stated = step_of_two_blocks()
    weights = stated.contact.weights.copy()
    weights[place] *= 1e-3
    short = replace(stated, contact=replace(stated.contact, weights=weights))
    held = reaction_contact(short.contact, np.full(weights.size, 2.0))
    assert certify(short, solve(short, held).point, held).worst[1] < 1e-8
