"""The search for low and high Coulomb loads (T14b): what it finds, and what it says of that."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import lacore as la
from lacore.coupling import interval, search
from lacore.coupling.interval import EndStatus
from lacore.limit.conversion import point_in_program, point_in_si
from lacore.program.certificate import certify
from lacore.program.kinematic import dimensionless
from lacore.reporting.status import Status
from tests.lacore.coupling.claims.test_claims import on_incline
from tests.lacore.models import deformable_block
from tests.rigid_problems import DOWN, block_slide, box, problem, wall, wedge_extraction

# REFERENCES: the lowest certified load factors known before, to the digits that are listed.
LOWEST = {
    ("wall-1", 0.65): 0.638982,
    ("wall-2", 0.65): 0.557416,
    ("wall-3", 0.65): 0.355817,
    ("wall-1", 1.0): 0.612571,
    ("wall-2", 1.0): 0.577007,
    ("wall-3", 1.0): 0.355817,
}
LISTED = 1e-5


def assert_certified(state):
    """A Coulomb state of its load factor, judged anew in the units of the program."""
    d = state.discretisation
    program = dimensionless(d.program, d.natural)
    assert certify(program, point_in_program(d, state.point)).holds(1e-6)
    assert state.certificate.holds(1e-6)
    assert state.point.load_factor == pytest.approx(state.load_factor, rel=0, abs=0)


@pytest.mark.parametrize(
    ("name", "mu"),
    [
        pytest.param(*case, marks=[] if case == ("wall-1", 0.65) else [pytest.mark.slow])
        for case in LOWEST
    ],
)
def test_walls_as_low_as_listed_or_lower(name, mu):
    found = la.coulomb_range(wall(name, mu), restarts=8 if mu > 0.9 else 0)
    assert found.low <= LOWEST[name, mu] + LISTED
    assert found.bracket[0] <= found.low <= found.high <= found.bracket[1]
    assert_certified(found.lowest)
    assert_certified(found.highest)
    assert not found.lowest_proven


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "low", "high"), [("wall-2", 0.557416, 0.577201), ("wall-3", 0.355817, 0.379385)]
)
def test_the_lowest_mechanism_of_a_wall_carries_the_listed_interval(name, low, high):
    interval = la.coulomb_range(wall(name), restarts=2).lowest.interval
    assert [interval.low, interval.high] == pytest.approx([low, high], abs=1e-6)


def test_the_highest_load_of_wall_1_is_the_associated_one():
    found = la.coulomb_range(wall("wall-1"), restarts=0)
    assert [found.low, found.high] == pytest.approx([0.638982, 0.642859], abs=1e-6)
    assert found.bracket == pytest.approx((0, 0.642859), abs=1e-6)
    assert found.highest_proven
    text = str(found)
    assert "every one lies in" in text
    assert "not proven: a lower one may exist" in text
    assert "proven: none is higher, because it reaches its bound" in text
    assert "not proven: a higher one may exist" not in text


def test_the_same_seed_finds_the_same_and_rows_come_as_they_are_found():
    rows = []
    first = la.coulomb_range(wedge_extraction(), seed=3, restarts=1, on_progress=rows.append)
    again = la.coulomb_range(wedge_extraction(), seed=3, restarts=1)
    pd.testing.assert_frame_equal(first.states, again.states, check_exact=True)
    pd.testing.assert_frame_equal(first.states, pd.DataFrame(rows))
    other = la.coulomb_range(wedge_extraction(), seed=4, restarts=1)
    assert not first.states.equals(other.states)


def test_a_search_without_time_keeps_what_it_has_found():
    """The state of the first solve, which is certified, and nothing of what was never looked at."""
    found = la.coulomb_range(wall("wall-1"), time_limit=1e-9)
    assert found.status is Status.SOLVED
    assert "time limit of 1e-09 s, in restart 0 of 8" in found.stopped
    assert "stopped by its time limit" in found.facts().title
    assert found.stopped in str(found)
    assert found.states["origin"].tolist() == ["certified"]
    assert_certified(found.lowest)
    assert_certified(found.highest)
    assert found.bracket[0] <= found.low <= found.high <= found.bracket[1]
    whole = la.coulomb_range(wall("wall-1"), restarts=0)
    assert not whole.stopped
    assert whole.low <= found.low <= found.high <= whole.high


@pytest.mark.parametrize("name", ["wall-1", pytest.param("wall-2", marks=pytest.mark.slow)])
def test_every_state_is_within_the_bracket_and_carries_an_interval(name):
    found = la.coulomb_range(wall(name), restarts=1)
    states = found.states
    assert (states.low <= states.high + 1e-8).all()
    assert (states.low >= found.bracket[0] - 1e-8).all()
    assert (states.high <= found.bracket[1] + 1e-8).all()
    assert (states.residual <= 1e-6).all()
    assert found.low == pytest.approx(states.low.min(), abs=1e-6)
    assert found.high == pytest.approx(states.high.max(), abs=1e-6)
    solved = la.solve(wall(name))
    assert found.low <= solved.load_factor <= found.high
    assert states.solves.is_monotonic_increasing


def test_a_unique_load_is_recognised_as_such():
    """C1: associated and Coulomb load agree; the wedge of C8: they do not, Coulomb is unique."""
    sliding = la.coulomb_range(block_slide(), restarts=1)
    assert [sliding.low, sliding.high] == pytest.approx([0.6, 0.6], abs=1e-6)
    assert sliding.highest_proven
    wedge = la.coulomb_range(wedge_extraction(), restarts=2)
    assert wedge.low == pytest.approx(wedge.high, rel=1e-6)
    assert not wedge.highest_proven


@pytest.mark.slow
def test_a_body_that_yields():
    """C14, sliding: one mechanism, one load."""
    found = la.coulomb_range(deformable_block(0.5), restarts=0)
    assert [found.low, found.high] == pytest.approx([2, 2], abs=1e-5)


def test_without_coulomb_friction_there_is_nothing_to_search():
    found = la.coulomb_range(deformable_block(la.Tresca(0.3)))
    assert len(found.states) == 1
    assert found.lowest_proven
    assert found.highest_proven


# Problems without a limit state, and ends that are none.


def between_walls():
    """Walls that are one block, so that they stand by themselves."""
    frame = np.array([(-2, -1), (2, -1), (2, 2), (0.5, 2), (0.5, -0.5), (-0.5, -0.5), (-0.5, 2)])
    frame = np.vstack([frame, [(-2, 2)]])
    return problem(
        {"frame": frame, "block": box(-0.5, 0.5, 0.0, 1.0)},
        [la.PointForce("blocks", "block", (0, 1))],
        0.5,
        fixed=("frame",),
    )


def test_a_block_between_walls_has_no_highest_load():
    found = la.coulomb_range(between_walls(), restarts=1)
    assert found.low == pytest.approx(1, abs=1e-6)
    assert found.high == np.inf
    assert found.bracket[1] == np.inf
    assert found.highest.point.load_factor > 10
    assert found.highest.certificate.holds(1e-6)
    assert "proven: any higher one is carried" in str(found)
    assert "that none is higher" not in str(found)


def test_a_locked_problem_says_so():
    pressed = problem(
        {"base": box(-1, 3, -1, 0), "block": box(0, 2, 0, 1)},
        [la.PointForce("blocks", "block", DOWN)],
        0.5,
    )
    found = la.coulomb_range(pressed)
    assert found.status is Status.LOCKED
    assert found.low == found.high == np.inf
    assert found.lowest is None
    assert found.states.empty
    assert "locked" in str(found)
    assert found.ray.proves
    assert "out of balance" in repr(found)
    assert la.coulomb_range(between_walls(), restarts=0).ray is None


def test_what_a_solver_calls_locked_is_no_bound():
    """An adhesion of 1 N on a slope of 1e-9 carries 1e9, which interior points call infinite."""
    found = la.coulomb_range(on_incline(1e-9, la.Tresca(1.0)), "clarabel", restarts=0)
    assert found.status is Status.NOT_CERTIFIED
    assert found.bracket[0] < 1e9
    assert not found.lowest_proven


def test_a_state_that_does_not_hold_again_is_no_end(monkeypatch):
    """Where the mechanism of a state is not certified the search has found none, and no NaN."""
    nothing = interval.End(EndStatus.NOT_CERTIFIED, np.nan, None, None)
    monkeypatch.setattr(
        search, "load_factor_interval", lambda *_: interval.Interval(nothing, nothing)
    )
    found = la.coulomb_range(block_slide(), restarts=0)
    assert found.status is Status.NOT_CERTIFIED
    assert found.states.empty
    assert np.isnan(found.low)


def test_an_unproven_bound_proves_nothing():
    found = la.coulomb_range(block_slide(), restarts=0)
    unknown = replace(found, bracket=(-np.inf, np.inf))
    assert not unknown.lowest_proven
    assert not unknown.highest_proven


@pytest.mark.parametrize(
    ("given", "field"),
    [
        ({"seed": -1}, "seed"),
        ({"restarts": 0.5}, "restarts"),
        ({"time_limit": 0.0}, "time_limit"),
    ],
)
def test_bad_input_is_refused(given, field):
    with pytest.raises(la.InputError, match=field):
        la.coulomb_range(wall("wall-1"), **given)


def test_a_regularised_backend_proves_no_range():
    with pytest.raises(la.CapabilityError, match="regularised and cannot prove"):
        la.coulomb_range(wall("wall-1"), backend="newton")


# `state.interval()`, in SI units.


@pytest.mark.parametrize("backend", ["clarabel", "highs"])
def test_a_state_knows_its_interval(backend):
    state = la.solve(wall("wall-1"), backend=backend)
    interval = state.interval()
    assert [interval.low, interval.high] == pytest.approx([0.638982, 0.642859], abs=1e-6)
    assert interval.low <= state.load_factor <= interval.high
    assert interval.exact


def rough_stop(length=1.0, weight=1.0):
    """CLOSED_FORMS C5b; the stop does not touch the lower block, or it could press on it."""
    blocks = {
        "base": box(-4, 4, -1, 0),
        "stop": box(1, 2, 1.2, 2),
        "lower": box(-2, 2, 0, 1),
        "upper": box(-1, 1, 1, 2),
    }
    body = la.BlockAssembly(
        {name: length * outline for name, outline in blocks.items()},
        0.3,
        {("lower", "upper"): 0.5, ("stop", "upper"): 0.4},
    )
    density = weight / (2 * length**2)
    return la.Problem(
        {"blocks": body},
        [la.PointForce("blocks", "lower", (weight, 0))],
        [la.Fix("blocks", ("base", "stop"))],
        dead_loads=[la.BodyForce("blocks", (0, -density), name) for name in ("lower", "upper")],
    )


def test_an_interval_is_in_the_units_of_the_problem():
    """Loads in other units leave alpha, their ratio; tractions follow load per length."""
    plain = la.solve(rough_stop()).interval()
    assert [plain.low, plain.high] == pytest.approx([1.2 + 1 / 15, 1.6], rel=1e-6)
    other = la.solve(rough_stop(length=1e3, weight=10.0)).interval()
    assert [other.low, other.high] == pytest.approx([plain.low, plain.high], rel=1e-6)
    for end, scaled in ((plain.lower, other.lower), (plain.upper, other.upper)):
        # Interior points of the same program but for round-off: far closer than the factor 0.01.
        largest = end.point.normal_reaction.max()
        assert scaled.point.normal_reaction.max() == pytest.approx(0.01 * largest, rel=1e-2)
        assert scaled.point.velocity == pytest.approx(end.point.velocity / 10, abs=1e-6)


def test_a_state_of_another_law_has_no_interval():
    state = la.solve(wedge_extraction(), coupling="associated")
    interval = state.interval()
    assert interval.lower.status is EndStatus.NOT_CERTIFIED
    assert np.isnan(interval.low)


def test_conversion_is_undone_by_its_inverse():
    state = la.solve(deformable_block(0.5))
    there = point_in_program(state.discretisation, state.point)
    back = point_in_si(state.discretisation, there)
    assert back.velocity == pytest.approx(state.point.velocity, abs=1e-12)
    assert back.normal_reaction == pytest.approx(state.point.normal_reaction, rel=1e-12)
    assert back.stress[0] == pytest.approx(state.point.stress[0], rel=1e-12)
    assert back.load_factor == pytest.approx(state.load_factor, rel=1e-12)
