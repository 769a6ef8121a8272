"""The static program by IPOPT: the same limit loads from the other side, statuses with evidence."""

import re
from dataclasses import replace
from pathlib import Path

import casadi
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import csr_matrix

import lacore as la
from lacore.program.certificate import certify
from lacore.program.kinematic import (
    DissipationGroup,
    FrozenContact,
    associated_contact,
    dimensionless,
    reaction_contact,
)
from lacore.reporting.status import Status
from lacore.solvers.inner.preparing import preparer
from lacore_backends._ipopt import STATUS_MAP
from lacore_backends._static_program import LARGEST
from lacore_backends.clarabel_socp import Clarabel, ClarabelOptions
from lacore_backends.ipopt_nlp import Ipopt
from lacore_backends.ipopt_static import IpoptStatic, IpoptStaticOptions
from lacore_verification.catalogue.catalogue import find
from tests.backends.test_clarabel import (
    LENGTH,
    SEQUENCE,
    W,
    frozen,
    group,
    no_contact,
    point_of_contact,
    program,
    random_program,
)
from tests.backends.test_regularised import NAMED
from tests.backends.variants import VARIANTS, require_fit
from tests.lacore.models import deformable_block, punch

# IPOPT's 1e-10 on numbers of order one to ten, as for Clarabel.
BAR = 1e-8


def solve(stated, held=None, **options):
    return IpoptStatic().prepare(stated, IpoptStaticOptions(**options)).solve(held or frozen())


# By hand: load factor, velocity, reactions, each with its sign.


def test_one_cone():
    """min 2 * 3 ||U||, (0.6, 0.8).U = 1: U = F0, alpha = 6, s along U at its bound."""
    point = solve(program([group(np.eye(2), [0, 0], 2.0, 3.0)], no_contact(2), [0.6, 0.8])).point
    assert point.load_factor == pytest.approx(6, abs=BAR)
    assert point.velocity == pytest.approx([0.6, 0.8], abs=BAR)
    assert point.stress[0][0] == pytest.approx([1.8, 2.4], abs=BAR)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_hinge(sense):
    """A cone of one row is a box: alpha = w M |rate| for the rate 1/2 that (2).U = 1 needs."""
    hinge = group([[1.0]], [0.0], 2.0, 3.0)
    point = solve(program([hinge], no_contact(1), [2.0 * sense])).point
    assert point.load_factor == pytest.approx(3.0, abs=BAR)
    assert point.velocity == pytest.approx([sense / 2], abs=BAR)
    assert point.stress[0] == pytest.approx(np.array([[3.0 * sense]]), abs=BAR)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_mean_stress_holds_what_cannot_change_volume(sense):
    """U = (1, 1) by theta = sense (u_0 - u_1) = 0; w s + w p theta = alpha F0."""
    stated = program([group(np.eye(2), [sense, -sense], 2.0, 3.0)], no_contact(2), [1.0, 0.0])
    point = solve(stated).point
    assert point.velocity == pytest.approx([1, 1], abs=BAR)
    assert point.load_factor == pytest.approx(6 * np.sqrt(2), abs=BAR)
    assert point.mean_stress[0] == pytest.approx([sense * 3 / np.sqrt(2)], abs=BAR)


@pytest.mark.parametrize(
    ("reference", "held", "load_factor", "velocity", "t_n", "t_t"),
    [
        pytest.param((0, 1), frozen([0.7]), LENGTH * 0.7, [0, 1], W / LENGTH, -0.7, id="friction"),
        pytest.param((0, -1), frozen([0.7]), LENGTH * 0.7, [0, -1], W / LENGTH, 0.7, id="back"),
        pytest.param(
            (0, 1),
            frozen([0.0], 0.4),
            W * 0.4,
            [0.4, 1],
            W / LENGTH,
            -0.4 * W / LENGTH,
            id="dilates",
        ),
        pytest.param((0, 1), frozen([0.0], 0.0, 0.3), 0, [-0.3, 1], W / LENGTH, 0, id="shifted"),
        pytest.param(
            (0, 1),
            frozen([0.0], 0.4, 0.3),
            W * 0.4,
            [0.1, 1],
            W / LENGTH,
            -0.4 * W / LENGTH,
            id="shifted and dilates",
        ),
        pytest.param((1, 3), frozen([np.inf]), W, [1, 0], 0, -3 * W / LENGTH, id="sticks"),
        pytest.param((1, 0), frozen([0.7]), W, [1, 0], 0, 0, id="opens"),
    ],
)
def test_a_point_of_contact(reference, held, load_factor, velocity, t_n, t_t):
    """Values of test_clarabel.py; what opens without a reaction leaves friction undetermined."""
    point = solve(point_of_contact([float(f) for f in reference]), held).point
    assert point.load_factor == pytest.approx(load_factor, abs=BAR)
    assert point.velocity == pytest.approx(velocity, abs=BAR)
    assert point.normal_reaction == pytest.approx([t_n], abs=BAR)
    assert point.tangential_reaction[0] == pytest.approx([t_t], abs=BAR)


# Against the cone solver.


def both(stated, held):
    """The answers of this backend and of Clarabel, which is asked as `lacore.solve` asks it."""
    prepare = preparer(Clarabel(), ClarabelOptions())
    return solve(stated, held), prepare(stated).solve(held)


def leak(program, mean_stress, velocity):
    """Power of mean stresses on the divergence of a velocity, signs dropped; that of a soil that
    its flow rule does not allow.
    """
    return sum(
        float(group.weights @ np.abs(p * (group.volumetric @ velocity)))
        if group.surfaces is None
        else group.taken(velocity, p)
        for group, p in zip(program.groups, mean_stress, strict=True)
    )


@pytest.mark.parametrize("mesh", ["coarse", pytest.param("medium", marks=pytest.mark.slow)])
@pytest.mark.parametrize(("case", "variant"), VARIANTS)
def test_certified_and_equal_to_clarabel(case, variant, mesh):
    """Every residual; the gap is mu = 1e-11 per barrier term, over a power of 0.1 at least.

    A medium mesh has 3000 cones and points with two terms each: 6e-7, below the bar of 1e-6.
    """
    require_fit(variant, "ipopt-static")
    d = la.discretise(case.problem(variant, mesh))
    stated = dimensionless(d.program, d.natural)
    gap = 1e-11 * 2 * sum(group.weights.size for group in stated.groups)
    held = associated_contact(stated.contact)
    for _ in range(2):
        answer, exact = both(stated, held)
        assert answer.status is Status.SOLVED
        certificate = certify(stated, answer.point, held)
        assert certificate.holds(1e-6), certificate
        # Clarabel leaves 1e-10 on scaled residuals, of its value where that is above 1, two digits
        # of margin; and a divergence theta, by which its value may be off by sum w |p theta|:
        # duality, as for any constraint let go.
        size = max(1.0, abs(exact.point.load_factor))
        off = gap + 1e-8 * size + leak(stated, answer.point.mean_stress, exact.point.velocity)
        assert answer.point.load_factor == pytest.approx(exact.point.load_factor, abs=off)
        assert off < 1e-6
        held = reaction_contact(stated.contact, exact.point.normal_reaction)


def test_through_the_loop():
    """The reaction iteration on multipliers of this backend ends where it does on Clarabel's.

    Each is certified to 1e-6; sliding is the one mechanism, alpha = mu p b/h by hand (C14).
    """
    state = la.solve(deformable_block(0.3), "ipopt-static", throw=True)
    assert state.load_factor == pytest.approx(0.3 * 4, rel=1e-5)
    assert state.rigor is la.Rigor.DISCRETE
    assert la.solve(punch(rough=True), "ipopt-static", throw=True).rigor is la.Rigor.UPPER


@pytest.mark.slow
def test_undetermined_reactions_settle():
    """A rigid sliding block leaves its reactions free: the central path must choose the same ones.

    Stopped off the path they scatter by 1e-4 from solve to solve, and the loop never ends.
    """
    case, (variant, *_) = find("deformable-block:sliding")
    state = la.solve(case.problem(variant, "medium"), "ipopt-static", max_iterations=15)
    assert state.status is Status.SOLVED


@given(seed=st.integers(0, 10**6))
def test_all_kinds_of_contact_in_one_program(seed):
    """Whatever the mixture, the answer satisfies every law, and equilibrium with its signs."""
    rng = np.random.default_rng(seed)
    stated = random_program(rng)
    bound = rng.choice([0.0, 0.3, np.inf], 4)
    held = FrozenContact(bound, np.where(bound == 0, rng.choice([0.0, 0.5], 4), 0.0), np.zeros(4))
    answer, exact = both(stated, held)
    assert answer.status is exact.status
    if answer.status is not Status.LOCKED:  # some stick in too many ways
        certificate = certify(stated, answer.point, held)
        assert certificate.holds(1e-6), certificate


@pytest.mark.parametrize("seed", range(5))
def test_slip_in_two_directions(seed):
    """Discs of friction and fans of dilatancy, round ones: their own rows of the program."""
    rng = np.random.default_rng(seed)
    stated = random_program(rng)
    points = replace(
        stated.contact, tangential=csr_matrix(rng.uniform(-1, 1, (8, stated.n))), tangent_dim=2
    )
    stated = replace(stated, contact=points)
    held = FrozenContact(
        np.array([0.0, 0.3, np.inf, 0.2]), np.array([0.5, 0.0, 0.0, 0.4]), np.zeros(4)
    )
    answer, exact = both(stated, held)
    assert certify(stated, answer.point, held).holds(1e-6)
    assert answer.point.load_factor == pytest.approx(exact.point.load_factor, abs=BAR)


def test_repeated_solves_are_fresh_solves():
    """No start from the answer before: the same numbers, whatever came before."""
    stated = random_program(np.random.default_rng(0))
    solver = IpoptStatic().prepare(stated, IpoptStaticOptions())
    for held in SEQUENCE:
        one, other = solver.solve(held), solve(stated, held)
        assert one.status is other.status is Status.SOLVED
        assert np.array_equal(one.point.velocity, other.point.velocity)


def test_empty_groups():
    empty = DissipationGroup(
        "nothing", csr_matrix((0, 2)), 2, np.zeros(0), np.zeros(0), csr_matrix((0, 2)), 1.0
    )
    answer = solve(program([empty, group(np.eye(2), [0, 0], 2.0, 3.0)], no_contact(2), [0.6, 0.8]))
    assert answer.point.load_factor == pytest.approx(6.0, abs=BAR)
    assert [stress.shape for stress in answer.point.stress] == [(0, 2), (1, 2)]


def test_an_unknown_that_no_force_acts_on():
    """Its balance is a row without an entry; it moves or not, and alpha is that of the others."""
    stated = program([group(np.eye(2, 3), [0, 0, 0], 2.0, 3.0)], no_contact(3), [0.6, 0.8, 0.0])
    assert solve(stated).point.load_factor == pytest.approx(6.0, abs=BAR)


# Statuses.


@pytest.mark.parametrize(("problem", "status"), NAMED)
def test_what_has_no_limit_load_has_a_name(problem, status):
    assert la.solve(problem, "ipopt-static").status is status


@pytest.mark.parametrize(
    ("stated", "held"),
    [
        pytest.param(point_of_contact((-1.0, 0.0)), frozen([0.5]), id="obstacle"),
        pytest.param(point_of_contact((0.0, 1.0)), frozen([np.inf]), id="stick"),
        pytest.param(
            program([group([1.0, 0.0], [0.0, 1.0], 1.0, 1.0)], no_contact(2), [0.0, 1.0]),
            frozen(),
            id="volume",
        ),
    ],
)
def test_locked(stated, held):
    answer = solve(stated, held)
    assert answer.status is Status.LOCKED
    assert answer.point is None


def test_strong_is_not_locked():
    """A load factor above half of what counts as unbounded, carried by a finite strength."""
    strength = 0.7 * LARGEST
    stated = program([group(np.eye(2), [0, 0], 1.0, strength)], no_contact(2), [0.6, 0.8])
    answer = solve(stated)
    assert answer.status is Status.SOLVED
    assert answer.point.load_factor == pytest.approx(strength, rel=1e-9)


def test_unsafe_on_friction():
    """A dead load of 3 along a frozen friction of L g = 1.4."""
    answer = solve(point_of_contact((1.0, 0.0), (-W, 3.0)), frozen([0.7]))
    assert answer.status is Status.UNSAFE
    assert answer.point is None


def test_barely_safe_is_not_unsafe():
    """The same with L g just above and just below 3: nothing is claimed of the one."""
    stated = point_of_contact((1.0, 0.0), (-W, 3.0))
    assert solve(stated, frozen([1.5 * (1 + 1e-4)])).status is Status.SOLVED
    assert solve(stated, frozen([1.5 * (1 - 1e-4)])).status is Status.UNSAFE


@pytest.mark.parametrize(
    ("options", "status"),
    [
        ({"max_iterations": 3}, Status.ITERATION_LIMIT),
        ({"time_limit": 1e-9}, Status.TIME_LIMIT),
    ],
)
def test_limits_leave_a_point(options, status):
    answer = solve(random_program(np.random.default_rng(0)), SEQUENCE[0], **options)
    assert answer.status is status
    assert np.all(np.isfinite(answer.point.velocity))


@pytest.mark.parametrize("name", ["tolerance", "max_iterations", "time_limit"])
def test_options_refuse(name):
    with pytest.raises(la.InputError, match=f"ipopt-static.{name}"):
        IpoptStaticOptions(**{name: 0})


def test_every_native_status_has_a_meaning():
    """Against the header of IPOPT that comes with CasADi: it names its statuses nowhere else."""
    header = Path(casadi.__file__).parent / "include/coin-or/IpReturnCodes_inc.h"
    if not header.exists():
        pytest.skip("this CasADi came without the headers of IPOPT")
    enum = re.search(r"enum ApplicationReturnStatus\s*\{(.*?)\};", header.read_text(), re.DOTALL)
    assert set(re.findall(r"(\w+)\s*=\s*-?\d+", enum[1])) == set(STATUS_MAP)
    assert Ipopt.statuses is IpoptStatic.statuses is STATUS_MAP


@pytest.mark.parametrize(
    "native",
    [
        "Solved_To_Acceptable_Level",
        "Search_Direction_Becomes_Too_Small",
        "Restoration_Failed",
        "Error_In_Step_Computation",
        "Maximum_Iterations_Exceeded",
        "Maximum_WallTime_Exceeded",
    ],
)
def test_what_ends_early_keeps_its_point(native):
    """The residuals judge it, not IPOPT."""
    assert STATUS_MAP[native].has_point
    assert STATUS_MAP[native] is not Status.SOLVED


@pytest.mark.parametrize("dilation", [None, 0])
def test_soil_that_stalls_has_a_name_and_no_number(dilation):
    """The corner of a footing on sand is an apex; of associated flow and of frozen flow alike.

    Too few iterations for a footing; the load that it is at is wrong.
    """
    soil = la.MohrCoulomb(1.0, 30, dilation_angle=dilation)
    mesh = la.meshes.rectangle((0, 4), (-2, 0), 4, 2)
    problem = la.Problem(
        {"soil": la.Body(mesh, soil)},
        [la.RigidFooting("soil", lambda x: (x[1] == 0) & (x[0] <= 1), (0, -1), rough=False)],
        supports=[
            *(la.Fix("soil", side) for side in ("bottom", "right")),
            la.Fix("soil", "left", "x"),
        ],
    )
    state = la.solve(problem, "ipopt-static", options={"max_iterations": 50})
    assert state.status is la.Status.ITERATION_LIMIT
    assert np.isnan(state.load_factor)
    assert state.rigor is la.Rigor.NOT_CERTIFIED
    assert "take 'clarabel'" in state.message
    assert not state.certificate.holds(1e-3)
