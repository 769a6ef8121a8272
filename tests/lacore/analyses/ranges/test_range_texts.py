"""What a range of load factors reports of what is proven, and of what is not."""

from dataclasses import replace
from math import inf, nan

import pytest

import lacore as la
from lacore.analyses.ranges.load_factors import RangeKind, about
from lacore.reporting.status import Scope, Status
from lacore_verification.report.problems.bounding import BOUNDING
from tests.lacore.coupling.test_injected_intervals import two_blocks


@pytest.fixture(scope="module")
def found():
    """Two blocks with friction: one load factor, 0.2."""
    return la.coulomb_range(two_blocks(0.3, 0.2), restarts=0)


def test_bounds_of_the_continuum_are_reported_where_a_mesh_is_another_problem(found):
    """Of blocks there is no mesh; bounds of soils are those of the discrete problem alone."""
    discrete = replace(found, scope=Scope.DISCRETE, continuum=(0.1, 0.9))
    text, line = "those of the continuum in [0.1, 0.9]", "continuum: every one lies in [0.1, 0.9]"
    soil = replace(discrete, kind=RangeKind.SOIL)
    for own, told in ((discrete, True), (found, False), (soil, False)):
        assert (text in own.facts().told["proven"]) == told
        assert (line in str(own)) == told
    assert "no bounds" in replace(found, bracket=(-inf, inf)).facts().told["proven"]


def test_residuals_are_those_of_the_states_that_there_are(found):
    both = found.facts().told["residual"]
    assert "of the lowest" in both
    assert "of the highest" in both
    none = replace(found, lowest=None, highest=None, status=Status.NOT_CERTIFIED, low=nan, high=nan)
    assert "residual" not in none.facts().told
    assert "by its certificate" not in str(none)
    without = replace(found, lowest=replace(found.lowest, certificate=None))
    assert "of the lowest" not in without.facts().told["residual"]
    assert str(without).count("by its certificate") == 1


def test_one_bound_is_a_bound(found):
    """A structure that does not stand without friction has none from below, and one from above."""
    half = replace(found, bracket=(-inf, 0.5))
    assert "[-inf, 0.5]" in str(half)
    assert "no bounds" not in str(half)
    assert "no bounds" in str(replace(half, bracket=(-inf, inf)))


def test_a_lower_bound_is_zero_only_as_far_as_round_off_goes(found):
    """1e-9 of the upper bound 0.5 is zero; a tenth of it is not, whatever the upper bound."""
    for below, shown in ((5e-10, "[0, 0.5]"), (-5e-10, "[0, 0.5]"), (0.05, "[0.05, 0.5]")):
        assert shown in str(replace(found, bracket=(below, 0.5)))
    assert "[5e-10, inf]" in str(replace(found, bracket=(5e-10, inf)))


def test_a_width_is_relative_to_the_mean(found):
    """2 and 6: 4 apart, around 4."""
    assert replace(found, low=2.0, high=6.0).width == 1.0


def test_bounds_move_to_certified_load_factors_by_round_off_alone():
    """1e-6 of the largest of all sizes, 8 here; what is further beyond contradicts the bound."""
    off = 4e-6
    assert about((2.0, 8.0), 2.0 - off, 8.0 + off) == (2.0 - off, 8.0 + off)
    assert about((2.0, 8.0), 2.0 - 4 * off, 8.0 + 4 * off) == (2.0, 8.0)
    assert about((2.0, 8.0), 3.0, 7.0) == (2.0, 8.0)
    assert about((-inf, 8.0), 3.0, inf) == (-inf, 8.0)


def test_an_end_is_proven_where_it_reaches_its_bound(found):
    low, high = found.low, found.high
    inside = str(replace(found, bracket=(low - 0.1, high + 0.1)))
    assert "not proven: a lower one may exist" in inside
    assert "not proven: a higher one may exist" in inside
    reached = str(replace(found, bracket=(low, high)))
    assert "none is lower, because it reaches its bound" in reached
    assert "none is higher, because it reaches its bound" in reached
    unbounded = str(replace(found, high=inf))
    assert "any higher one is carried" in unbounded


@pytest.mark.parametrize(
    ("below", "above", "sampled"),
    [(0, 0, ()), (0.1, 0, ("low",)), (0, 0.1, ("high",)), (0.1, 0.1, ("low", "high"))],
)
def test_a_range_is_called_a_sample_at_the_ends_that_reach_no_bound(found, below, above, sampled):
    """A search of many joints may miss load factors: only an end at its bound is the last one."""
    own = replace(found, bracket=(found.low - below, found.high + above))
    assert own.sampled == sampled
    for text in (own.facts().title, own.summary().splitlines()[0]):
        assert ("sample" in text) == bool(sampled)
        assert ("lower" in text, "higher" in text) == ("low" in sampled, "high" in sampled)
    document, table_title = BOUNDING["range"].document, BOUNDING["range"].table_title
    assert document(own, None)["sampled"] == list(sampled)
    assert ("Sample" in table_title(own)) == bool(sampled)


def test_a_range_without_states_is_no_sample(found):
    """Nor is one end of a mechanism that carries any load factor: nothing lies beyond infinity."""
    assert replace(found, lowest=None, highest=None, low=nan, high=nan).sampled == ()
    unbounded = replace(found, high=inf, bracket=(found.low, inf))
    assert unbounded.sampled == ()


def test_a_free_motion_is_not_searched():
    """The smooth block slides under any load: there is no state to search from."""
    free = la.coulomb_range(two_blocks(la.SMOOTH, 0.3), restarts=0)
    assert free.status is Status.FREE
    assert free.states.empty
    assert free.lowest is None
