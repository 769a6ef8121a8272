"""Intervals of load factors of one mechanism (T14b a): closed forms, proofs, noise, no end."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.sparse import csr_matrix

import lacore as la
from lacore.coupling.interval import EndStatus, load_factor_interval
from lacore.limit.conversion import point_in_program
from lacore.model.bodies.blocks.bonds import random_bond
from lacore.program.certificate import certify
from lacore.program.kinematic import (
    ContactRows,
    KinematicProgram,
    associated_contact,
    dimensionless,
    reaction_contact,
)
from lacore.program.state import ProgramState
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution
from tests.frame_problems import pushed, pushed_exact
from tests.lacore.block_programs import between_walls, plug, rough_stop, sliding_block, wall
from tests.lacore.models import deformable_block
from tests.rigid_problems import PROBLEMS
from tests.shares import one_in

BACKENDS = ("clarabel", "highs")


def at_work(name):
    backend = la.find_backend(name)
    options = backend.Options()
    return lambda program: backend.prepare(program, options)


def coulomb_state(program, name):
    """A certified state by plain alternation (T12), from unit reactions."""
    mechanisms, reactions = (at_work(name)(program) for _ in range(2))
    rows, t_n = program.contact, np.ones(program.contact.count)
    for _ in range(30):
        velocity = mechanisms.solve(reaction_contact(rows, t_n)).point.velocity
        slip = np.linalg.norm(rows.slip(velocity), axis=1)
        frozen = replace(associated_contact(rows), shift=rows.coefficient * slip)
        point = replace(reactions.solve(frozen).point, velocity=velocity)
        if certify(program, point).holds(1e-6):
            return point
        t_n = (t_n + 2 * point.normal_reaction) / 3
    raise AssertionError("no certified state to begin with")


def interval_of(program, name):
    point = coulomb_state(program, name)
    return point, load_factor_interval(program, point, at_work(name))


def assert_certified(program, end):
    """The end is a Coulomb state of its own load factor."""
    assert end.certificate == certify(program, end.point)
    assert end.certificate.holds(1e-6)
    if np.isfinite(end.load_factor):
        assert end.point.load_factor == pytest.approx(end.load_factor, rel=0, abs=0)


# Closed forms. Linear programs of forces of order 1, solved to 1e-10: ends good to 1e-8.


def rough_stop_ends(mu_floor, mu_joint, mu_wall, lower, upper):
    """CLOSED_FORMS C5b."""
    pressed = [upper / (1 + s * mu_joint * mu_wall) for s in (1, -1)]
    return [mu_joint * n + mu_floor * (lower + n) for n in pressed]


@pytest.mark.parametrize("backend", BACKENDS)
def test_rough_stop_has_the_interval_of_c5b(backend):
    program = rough_stop()
    point, interval = interval_of(program, backend)
    assert [interval.low, interval.high] == pytest.approx([1.2 + 1 / 15, 1.6], abs=1e-8)
    assert interval.exact
    assert interval.low - 1e-8 <= point.load_factor <= interval.high + 1e-8
    assert_certified(program, interval.lower)
    assert_certified(program, interval.upper)


@pytest.mark.parametrize("seed", range(20))
def test_rough_stop_of_random_friction_and_weights(seed):
    rng = np.random.default_rng(seed)
    given = dict(
        zip(("mu_floor", "mu_joint", "mu_wall"), rng.uniform(0.1, 0.7, 3), strict=True),
        **dict(zip(("lower", "upper"), rng.uniform(0.5, 3, 2), strict=True)),
    )
    _, interval = interval_of(rough_stop(**given), "clarabel")
    assert [interval.low, interval.high] == pytest.approx(rough_stop_ends(**given), abs=1e-7)
    assert interval.exact


@pytest.mark.parametrize("backend", BACKENDS)
def test_plug_has_the_interval_of_c7(backend):
    """Any clamping force: from none, alpha = -W, to that at which the side blocks slide."""
    program = plug()
    _, interval = interval_of(program, backend)
    assert [interval.low, interval.high] == pytest.approx([-1, 0], abs=1e-8)
    assert interval.exact  # at the upper end load factor and dead power are 0: no 0/0 in its proof
    assert_certified(program, interval.lower)
    assert_certified(program, interval.upper)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_single_block_leaves_no_choice(backend):
    _, interval = interval_of(sliding_block(), backend)
    assert [interval.low, interval.high] == pytest.approx([0.3, 0.3], abs=1e-9)
    assert interval.exact


@pytest.mark.parametrize("backend", BACKENDS)
def test_wedging_between_walls_has_no_upper_end(backend):
    """REFERENCES block-between-walls: [W, inf), proven by a state far along a ray."""
    program = between_walls()
    _, interval = interval_of(program, backend)
    assert interval.low == pytest.approx(1, abs=1e-8)
    assert interval.high == np.inf
    assert interval.upper.status is EndStatus.UNBOUNDED
    assert interval.exact
    assert interval.upper.point.load_factor > 100
    assert_certified(program, interval.upper)
    assert "inf (unbounded)" in str(interval)


def test_pressed_down_between_walls_there_is_none_either():
    """From alpha = -W, where nothing wedges."""
    program = between_walls()
    _, interval = interval_of(replace(program, reference_load=-program.reference_load), "clarabel")
    assert interval.low == pytest.approx(-1, abs=1e-8)
    assert interval.upper.status is EndStatus.UNBOUNDED


# Against a linear program of forces, written down without any of the code under test.


def ends_by_forces(program, velocity):
    """Smallest and largest alpha of ``H^T t + alpha F0 + Fd = 0`` within the law at a velocity.

    Variables (t_n, t_t, alpha); at rest is what is slower than 1e-6 of the fastest.
    """
    rows, m = program.contact, program.contact.count
    rest = 1e-6 * np.abs(velocity).max()
    u_n, u_t = rows.normal @ velocity, rows.tangential @ velocity
    forces = [rows.normal.toarray().T * rows.weights, rows.tangential.toarray().T * rows.weights]
    one, none, mu = np.eye(m), np.zeros((m, m)), np.diag(rows.coefficient)
    opened, slipped = u_n > rest, np.abs(u_t) > rest
    equal = np.vstack(
        [
            np.hstack([one, none])[opened],
            np.hstack([none, one])[opened],
            np.hstack([mu * np.sign(u_t), one])[slipped & ~opened],
        ]
    )
    cone = np.vstack([np.hstack([-mu, one]), np.hstack([-mu, -one])])
    ends = []
    for sign in (1, -1):
        found = linprog(
            np.r_[np.zeros(2 * m), sign],
            A_ub=np.pad(cone, ((0, 0), (0, 1))),
            b_ub=np.zeros(2 * m),
            A_eq=np.vstack(
                [
                    np.column_stack([*forces, program.reference_load]),
                    np.pad(equal, ((0, 0), (0, 1))),
                ]
            ),
            b_eq=np.r_[-program.dead_load, np.zeros(len(equal))],
            bounds=[(0, None)] * m + [(None, None)] * (m + 1),
        )
        assert found.status == 0
        ends.append(sign * found.fun)
    return ends


@pytest.mark.parametrize("mu", [0.4, 0.65, 0.8])
@pytest.mark.parametrize("backend", BACKENDS)
def test_a_wall_against_a_program_of_forces(backend, mu):
    program = wall(mu=mu)
    point, interval = interval_of(program, backend)
    expected = ends_by_forces(program, point.velocity)
    assert [interval.low, interval.high] == pytest.approx(expected, abs=1e-8)
    assert interval.exact
    assert_certified(program, interval.lower)
    assert_certified(program, interval.upper)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("seed", one_in(2, [0, 1, 2, 118, 239]))
def test_random_walls_against_a_program_of_forces(seed, backend):
    """118: slow motions that are none of noise; 239: noise that meets large reactions."""
    rng = np.random.default_rng(seed)
    wide, courses, openings = (int(rng.integers(*ends)) for ends in ((4, 9), (4, 10), (0, 2)))
    body = la.masonry.running_bond(
        random_bond(rng, wide, courses, openings), float(rng.uniform(0.2, 1.0))
    )
    problem = la.Problem(
        {"wall": body},
        [la.BodyForce("wall", (1, 0))],
        [la.Fix("wall", "base")],
        dead_loads=[la.BodyForce("wall", (0, -1))],
    )
    state = la.solve(problem, backend=backend)
    assert state.status is Status.SOLVED
    d = state.discretisation
    program = dimensionless(d.program, d.natural)
    expected = ends_by_forces(program, point_in_program(d, state.point).velocity)
    interval = state.interval()
    found = np.array([interval.low, interval.high]) / program.scales.load_factor
    assert found == pytest.approx(expected, abs=1e-7)
    assert interval.exact


@pytest.mark.parametrize("name", PROBLEMS)
def test_the_interval_of_a_solved_problem_holds_its_load(name):
    state = la.solve(PROBLEMS[name]())
    interval = state.interval()
    assert interval.exact
    assert interval.low <= state.load_factor <= interval.high


@pytest.mark.parametrize(("mu", "p"), [(0.25, 1.0), (0.35, 1.5), (0.9, 1.5), (0.9, 0.3)])
@pytest.mark.parametrize("backend", BACKENDS)
def test_a_frame_has_one_load(backend, mu, p):
    """C11: sliding, hinges and both; moments have slack 1e-8 where hinges turn."""
    interval = la.solve(pushed(mu, p), backend=backend).interval()
    assert [interval.low, interval.high] == pytest.approx([pushed_exact(mu, p)] * 2, abs=1e-6)
    assert interval.exact


# Noise and thresholds.


@pytest.mark.parametrize("size", [1e-9, 1e-8, 1e-7])
def test_noise_in_the_velocity_changes_nothing(size):
    program, rng = rough_stop(), np.random.default_rng(0)
    point = coulomb_state(program, "clarabel")
    noise = size * np.abs(point.velocity).max() * rng.uniform(-1, 1, program.n)
    noise -= program.reference_load * (program.reference_load @ noise)  # F0.u = 1 stays: |F0| = 1
    noisy = replace(point, velocity=point.velocity + noise)
    interval = load_factor_interval(program, noisy, at_work("clarabel"))
    assert [interval.low, interval.high] == pytest.approx([1.2 + 1 / 15, 1.6], abs=1e-8)


def geared(ratio, mu=0.5):
    """A light point that slips with the load, and one that slips `ratio` times as fast, heavier.

    Unknowns: the slip of the first, the two openings; ``alpha = mu (1 + ratio weight)``.
    """
    weight = 1 / ratio
    return KinematicProgram(
        groups=(),
        contact=ContactRows(
            normal=csr_matrix([[0.0, 1, 0], [0, 0, 1]]),
            tangential=csr_matrix([[1.0, 0, 0], [ratio, 0, 0]]),
            tangent_dim=1,
            weights=np.ones(2),
            coefficient=np.full(2, mu),
            limit=np.zeros(2),
            dilatancy=np.zeros(2),
            interface=np.zeros(2, dtype=int),
        ),
        reference_load=np.array([1.0, 0, 0]),
        dead_load=np.array([0, -1.0, -weight]),
    )


@pytest.mark.parametrize("ratio", [0.5, 5e-4, 5e-6])
def test_slow_slip_that_matters_is_not_taken_for_rest(ratio):
    """At rest the heavy point could carry the other way round, down to alpha = 0: refuted."""
    _, interval = interval_of(geared(ratio), "highs")
    assert [interval.low, interval.high] == pytest.approx([1, 1], abs=1e-9)
    assert interval.exact


def test_a_state_that_is_none_has_no_interval():
    program = rough_stop()
    point = coulomb_state(program, "clarabel")
    wrong = replace(point, load_factor=1.01 * point.load_factor)
    interval = load_factor_interval(program, wrong, at_work("clarabel"))
    assert interval.lower.status is interval.upper.status is EndStatus.NOT_CERTIFIED
    assert np.isnan([interval.low, interval.high]).all()
    assert not interval.exact


class Useless:
    """A solver that never answers."""

    def solve(self, contact):
        return InnerSolution(Status.FAILED, "useless", 0, 0.0, None)

    def close(self):
        pass


def test_an_end_whose_program_fails_is_the_found_one_and_says_so():
    program = rough_stop()
    point = coulomb_state(program, "clarabel")
    interval = load_factor_interval(program, point, lambda _: Useless())
    assert interval.lower.status is interval.upper.status is EndStatus.FOUND
    assert interval.low == interval.high == point.load_factor
    assert not interval.exact
    assert_certified(program, interval.lower)


class Liar(Useless):
    """A solver that calls every program locked."""

    def solve(self, contact):
        return InnerSolution(Status.LOCKED, "liar", 0, 0.0, None)


def test_no_end_is_not_believed_without_a_ray():
    program = rough_stop()
    point = coulomb_state(program, "clarabel")
    interval = load_factor_interval(program, point, lambda _: Liar())
    assert interval.upper.status is EndStatus.FOUND


# Bodies that yield, and laws that are not of Coulomb.


@pytest.mark.parametrize("mu", [0.5, 0.9])
@pytest.mark.parametrize("n", [1, 3])
def test_a_deformable_block_has_one_load(n, mu):
    """CLOSED_FORMS C14, sliding and crushing: the stress has slack 1e-8 where it flows."""
    problem = la.discretise(deformable_block(mu, n=n))
    program = dimensionless(problem.program, problem.natural)
    _, interval = interval_of(program, "clarabel")
    ends = np.array([interval.low, interval.high]) * program.scales.load_factor
    assert ends == pytest.approx([min(4 * mu, 3)] * 2, abs=1e-6)
    assert interval.exact


def test_without_coulomb_friction_nothing_is_solved():
    problem = la.discretise(deformable_block(la.Tresca(0.3)))
    program = dimensionless(problem.program, problem.natural)
    point = coulomb_state(program, "clarabel")
    interval = load_factor_interval(program, point, lambda _: Useless())
    assert interval.low == interval.high == point.load_factor
    assert interval.exact


def mixed(limit):
    """A block slides with Coulomb friction while a point with a limit is lifted off.

    Unknowns: the slip, the opening of the Coulomb point, lift and slip of the other one.
    """
    return KinematicProgram(
        groups=(),
        contact=ContactRows(
            normal=csr_matrix([[0.0, 1, 0, 0], [0, 0, 1, 0]]),
            tangential=csr_matrix([[1.0, 0, 0, 0], [0, 0, 0, 1]]),
            tangent_dim=1,
            weights=np.ones(2),
            coefficient=np.array([0.5, 0]),
            limit=np.array([0, limit]),
            dilatancy=np.zeros(2),
            interface=np.zeros(2, dtype=int),
        ),
        reference_load=np.array([1.0, 0, 0, 0]),
        dead_load=np.array([0, -2.0, 0, 0.3]),
    )


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("limit", [0.4, np.inf])
def test_a_lifted_point_keeps_its_tangential_bound(backend, limit):
    """The other point carries 0.3 within its limit, but no pressure, though it is lifted."""
    program = mixed(limit)
    point = ProgramState(
        velocity=np.array([1.0, 0, 1, 0]),
        load_factor=1.0,
        stress=(),
        mean_stress=(),
        normal_reaction=np.array([2.0, 0]),
        tangential_reaction=np.array([[-1.0], [-0.3]]),
    )
    interval = load_factor_interval(program, point, at_work(backend))
    assert [interval.low, interval.high] == pytest.approx([1, 1], abs=1e-8)
    assert interval.exact
    assert_certified(program, interval.upper)
    assert interval.upper.point.tangential_reaction[1] == pytest.approx(-0.3, abs=1e-8)


@pytest.mark.parametrize("weight", [1.0, 2.0])
@pytest.mark.parametrize("lifted", [False, True])
def test_slip_at_a_limit_and_with_friction(weight, lifted):
    """``||t_t|| <= mu t_n + limit``, sliding: ``0.5 * 2 + 0.4 w`` whatever the reactions.

    A point that lifts off has its limit alone, and no dead load to hold.
    """
    program, pressed = mixed(0.4), 0.0 if lifted else 2.0
    rows = replace(program.contact, limit=np.array([0.4, 0.4]), weights=np.full(2, weight))
    program = replace(program, contact=rows, dead_load=np.array([0, -pressed, 0, 0.3]))
    exact = 0.5 * pressed + 0.4 * weight
    point = ProgramState(
        velocity=np.array([1.0, lifted, 0, 0]),
        load_factor=exact,
        stress=(),
        mean_stress=(),
        normal_reaction=np.array([pressed, 0]) / weight,
        tangential_reaction=np.array([[-exact], [-0.3]]) / weight,
    )
    interval = load_factor_interval(program, point, at_work("highs"))
    assert [interval.low, interval.high] == pytest.approx([exact, exact], abs=1e-8)
    assert interval.exact


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_bound_on_friction_opens_an_interval_too(backend):
    """A block is pulled from under another, which leans on a stop that carries at most T.

    The stop bears -T <= V <= T of the upper weight, so N = W2 - V, and
    alpha = mu2 N + mu1 (W1 + N).
    """
    mu1, mu2, w1, w2, limit = 0.4, 0.3, 2.0, 1.0, 0.5
    blocks = {
        "floor": [(-3, -1), (3, -1), (3, 0), (-3, 0)],
        "lower": [(-1, 0), (1, 0), (1, 0.25), (-1, 0.25)],
        "upper": [(-1, 0.25), (1, 0.25), (1, 0.5), (-1, 0.5)],
        "stop": [(1, 0.3), (2, 0.3), (2, 0.4), (1, 0.4)],
    }
    joints = {("lower", "upper"): mu2, ("upper", "stop"): la.Tresca(limit)}
    problem = la.Problem(
        bodies={"blocks": la.BlockAssembly(blocks, friction=mu1, joint_friction=joints)},
        supports=[la.Fix("blocks", "floor"), la.Fix("blocks", "stop")],
        reference_loads=[la.PointForce("blocks", "lower", (1, 0))],
        dead_loads=[
            la.PointForce("blocks", "lower", (0, -w1)),
            la.PointForce("blocks", "upper", (0, -w2)),
        ],
    )
    most = limit * 0.1  # along the side of the stop
    interval = la.solve(problem, backend=backend, throw=True).interval()
    ends = [mu2 * n + mu1 * (w1 + n) for n in (w2 - most, w2 + most)]
    # Each end has a certificate at 1e-6 of the power, alpha and no less.
    assert (interval.low, interval.high) == pytest.approx(tuple(ends), rel=1e-6)


# Outward: an interval is no narrower than what is proven.


@pytest.mark.parametrize("name", one_in(2, PROBLEMS))
@pytest.mark.parametrize("backend", BACKENDS)
def test_the_load_factor_of_a_state_lies_in_its_interval(name, backend):
    state = la.solve(PROBLEMS[name](), backend=backend)
    if state.status is la.Status.SOLVED:
        interval = state.interval()
        assert interval.low <= state.load_factor <= interval.high
        for end in (interval.lower, interval.upper):
            assert state.certify(point=end.point).holds(1e-6)


@pytest.mark.parametrize("off", [-3e-7, 3e-7])
def test_a_state_beside_its_interval_by_its_residuals_widens_it(off):
    """Certified to 1e-6, it proves its own load factor; of a single block there is no other."""
    program = sliding_block()
    point = coulomb_state(program, "clarabel")
    beside = replace(point, load_factor=point.load_factor + off * abs(point.load_factor))
    assert certify(program, beside).holds(1e-6)
    interval = load_factor_interval(program, beside, at_work("clarabel"))
    assert interval.low <= beside.load_factor <= interval.high
    other = interval.low if off > 0 else interval.high
    assert other == pytest.approx(0.3, abs=1e-9)
    assert_certified(program, interval.lower)
    assert_certified(program, interval.upper)


def test_what_a_dual_solution_leaves_open_belongs_to_the_interval():
    """A velocity that is a little off bounds a little further out: the end is where it bounds."""
    program = rough_stop()
    point = coulomb_state(program, "clarabel")

    class Rough:
        """A solver whose static value is too low by 1e-7."""

        def __init__(self, inner):
            self.inner = inner

        def solve(self, contact):
            answer = self.inner.solve(contact)
            lower = answer.point.load_factor - 1e-7
            return replace(answer, point=replace(answer.point, load_factor=lower))

        def close(self):
            self.inner.close()

    interval = load_factor_interval(program, point, lambda p: Rough(at_work("clarabel")(p)))
    assert interval.exact
    assert [interval.low, interval.high] == pytest.approx([1.2 + 1 / 15, 1.6], abs=1e-8)
