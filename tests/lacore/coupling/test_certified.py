"""The coupling loops (T9-T13) on structures whose behaviour is known by hand.

1e-6 relative is the bar of the certificates. Rates are measured where the loops still contract,
far above round-off: they are exact for one sliding block, whose reaction is affine in its friction.
"""

from statistics import median

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore_verification.catalogue.catalogue import find
from tests.lacore.whole.test_random_walls import random_wall
from tests.rigid_problems import PROBLEMS, incline, wedge

BAR = 1e-6
PLAIN = {"damping": 1.0, "anderson": 0}


def rate(mu, slope):
    """lambda of the reaction iteration for a block pushed against an incline (C2c)."""
    return mu * np.tan(slope)


@given(mu=st.floats(0.1, 1.0), slope=st.floats(0.1, 0.75))
def test_block_pushed_against_an_incline(mu, slope):
    """C2c: tan(slope + phi), as long as that is an angle below a right one with room to spare."""
    if rate(mu, slope) > 0.9:  # the error of alpha is 1/(1 - lambda) times that of the gap (T15)
        return
    state = la.solve(incline(mu, slope))
    assert state.status is la.Status.SOLVED, state.message
    exact = np.tan(slope + np.arctan(mu))
    assert state.load_factor == pytest.approx(exact, rel=BAR / (1 - rate(mu, slope)))


@pytest.mark.parametrize(("mu", "slope"), [(0.5, 0.6), (0.3, 1.0), (0.8, 0.7)])
@pytest.mark.parametrize(
    ("coupling", "start", "expected"),
    [
        ("reaction", "zero", lambda x: x),
        ("shift", "associated", lambda x: x / (1 - x)),
    ],
)
def test_contraction_of_both_loops(mu, slope, coupling, start, expected):
    """T11, to the digits that are left of a rate after a dozen steps."""
    theory = expected(rate(mu, slope))
    given = {"coupling": coupling, "start": start, **PLAIN}
    if theory >= 1:
        assert la.solve(incline(mu, slope), **given).status is la.Status.NOT_CONVERGED
        return
    state = la.solve(incline(mu, slope), max_iterations=40, **given)
    assert state.contraction == pytest.approx(theory, rel=1e-3)


@pytest.mark.parametrize(("mu", "slope"), [(1.2, 0.8), (2.0, 0.6)])
def test_jam(mu, slope):
    """C2c beyond a right angle: no load moves the block, though the frictionless one is finite."""
    assert rate(mu, slope) > 1
    state = la.solve(incline(mu, slope))
    assert state.status is la.Status.JAM
    assert np.isnan(state.load_factor)
    low, high = state.bracket
    assert low == pytest.approx(np.tan(slope), rel=BAR)
    assert high == np.inf
    assert "lock itself" in state.message


@pytest.mark.parametrize("coupling", ["reaction", "shift", "certified"])
def test_every_loop_ends_in_the_same_certificate(coupling):
    """And none in a number without one."""
    for name in ("block-slide", "stack", "portal", "wedge", "wedge-extraction"):
        state = la.solve(PROBLEMS[name](), coupling=coupling)
        if state.status is la.Status.SOLVED:
            assert state.certificate.holds(BAR), name
            assert state.interval().low <= state.load_factor <= state.interval().high
        else:
            assert np.isnan(state.load_factor), name


@pytest.mark.parametrize("coupling", ["shift", "certified"])
def test_regularised_backends_run_the_reaction_loop_only(coupling):
    with pytest.raises(la.InputError, match="reaction"):
        la.solve(PROBLEMS["block-slide"](), backend="newton", coupling=coupling)


def test_anchor_where_the_associated_problem_is_locked():
    """C8b: a wedge pulled out of fixed walls comes out under its own weight."""
    walls = wedge(up=True)
    fixed = la.Problem(
        walls.bodies,
        walls.reference_loads,
        [la.Fix("blocks", ("base", "left", "right"))],
        dead_loads=walls.dead_loads,
    )
    weight = 1.0 * (1 + np.tan(0.2))  # height times mean width
    assert la.solve(fixed, coupling="associated").status is la.Status.LOCKED
    state = la.solve(fixed)
    assert state.load_factor == pytest.approx(weight, rel=BAR)


def test_pushed_into_fixed_walls_it_is_locked():
    walls = wedge()
    fixed = la.Problem(
        walls.bodies,
        walls.reference_loads,
        [la.Fix("blocks", ("base", "left", "right"))],
        dead_loads=walls.dead_loads,
    )
    state = la.solve(fixed)
    assert state.status is la.Status.LOCKED
    assert state.load_factor == np.inf


def test_not_certified_carries_its_bracket():
    """Four steps are not enough for this wall: no value, but what bounds every value."""
    problem, _ = random_wall(10)
    state = la.solve(problem, max_iterations=4)
    assert state.status is la.Status.NOT_CERTIFIED
    assert np.isnan(state.load_factor)
    low, high = state.bracket
    certified = la.solve(problem).load_factor
    associated = la.solve(problem, coupling="associated").load_factor
    assert low <= certified <= high
    assert high == pytest.approx(associated, rel=10 * BAR)  # widened by what is not proven of it


@pytest.mark.parametrize("name", PROBLEMS)
def test_bracket_of_all_couplings(name):
    """T14: frictionless <= Coulomb <= associated <= stick."""
    values = []
    for coupling in ("frictionless", "certified", "associated", "stick"):
        state = la.solve(PROBLEMS[name](), coupling=coupling)
        low_end = -np.inf if coupling == "frictionless" else np.inf
        solved = state.status is la.Status.SOLVED
        values.append(state.load_factor if solved else low_end)
    size = max(abs(v) for v in values if np.isfinite(v))
    assert np.all(np.diff(np.clip(values, -9, 9)) >= -BAR * size), values


@pytest.mark.parametrize("case_id", ["deformable-block", "platens-coulomb"])
def test_certified_needs_no_more_solves_than_reaction(case_id):
    case, variants = find(case_id)
    solves = {"certified": [], "reaction": []}
    for variant in variants:
        d = la.discretise(case.problem(variant, "coarse"))
        for coupling, counts in solves.items():
            state = la.solve(d, coupling=coupling, throw=True)
            counts.append(state.outer_iterations)
    assert median(solves["certified"]) <= median(solves["reaction"])


@pytest.mark.parametrize("mesh", ["coarse", "medium"])
def test_certified_converges_for_much_friction(mesh):
    """The deformable block at mu = 0.9 is crushed."""
    case, (variant,) = find("deformable-block:crushing")
    state = la.solve(case.problem(variant, mesh), throw=True)
    assert state.load_factor == pytest.approx(3.0, rel=BAR)


def test_certified_needs_few_solves_where_the_loop_of_the_paper_needs_hundreds():
    """Near jamming: lambda^100 = 5e-4 at lambda = 0.927."""
    mu, slope = 0.9, 0.8
    published = la.solve(incline(mu, slope), coupling="reaction", start="zero", **PLAIN)
    assert published.status is la.Status.NOT_CONVERGED
    assert published.contraction == pytest.approx(rate(mu, slope), rel=1e-3)
    state = la.solve(incline(mu, slope))
    assert state.status is la.Status.SOLVED
    assert state.outer_iterations <= 5


@given(scale=st.floats(-6, 6))
def test_loads_scale(scale):
    """Weights in other units: a load of the same mechanism, which carries a range of them."""
    factor = 10.0**scale
    plain = PROBLEMS["wall-2"]()
    heavy = la.Problem(
        plain.bodies,
        [la.BodyForce("blocks", (factor, 0))],
        plain.supports,
        dead_loads=[la.BodyForce("blocks", (0, -factor))],
    )
    one, other = la.solve(plain), la.solve(heavy)
    low, high = one.interval().low, one.interval().high
    assert low - BAR <= other.load_factor <= high + BAR
    assert other.interval().low == pytest.approx(low, rel=BAR)
