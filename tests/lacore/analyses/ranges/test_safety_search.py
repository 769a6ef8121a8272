"""The search for a factor of safety, on load factors that are known as functions of the factor."""

from math import inf, log, nan

import numpy as np
import pytest

from lacore.analyses.ranges.safety import _clear, _end, _next

TOLERANCE = 1e-3
LOADS = {
    "cohesion": lambda factor: 3.7 / factor,
    "as given": lambda factor: 1.0 / factor,
    "unsafe": lambda factor: 0.2 / factor,
    "friction": lambda factor: 2.0 - factor**2,
    "steep": lambda factor: (5.0 / factor) ** 12,
    "locked": lambda factor: inf if factor < 1.9 else 2.3 / factor,
    "no load": lambda factor: 1.4 / factor if factor < 1.4 else 0.0,
}
EXACT = {
    "cohesion": 3.7,
    "as given": 1.0,
    "unsafe": 0.2,
    "friction": 1.0,
    "steep": 5.0,
    "locked": 2.3,
    "no load": 1.4,
}


def searched(load, stands, start=1.0, strongest=(0.0, inf)):
    """The end, and the rows of the search."""
    rows = []
    low, high = strongest

    def weakened(factor):
        return factor if low <= factor <= high else None

    def load_factor(weaker, factor):
        assert weaker == factor
        return load(factor)

    return _end("end", stands, weakened, load_factor, start, TOLERANCE, rows), rows


@pytest.mark.parametrize("stands", [True, False])
@pytest.mark.parametrize("name", LOADS)
@pytest.mark.parametrize("start", [0.3, 1.0, 20.0])
def test_an_end_is_found_to_the_tolerance_and_on_its_side(name, stands, start):
    found, rows = searched(LOADS[name], stands, start)
    exact = EXACT[name]
    if stands:
        assert exact / (1 + TOLERANCE) <= found <= exact * (1 + 1e-12)
    else:
        assert exact * (1 - 1e-12) <= found <= exact * (1 + TOLERANCE)
    assert len(rows) <= 25
    assert rows[0]["factor"] == start
    for row in rows:
        assert row["proves"] == (row["load_factor"] >= 1 if stands else row["load_factor"] < 1)


@pytest.mark.parametrize("stands", [True, False])
def test_a_bound_that_fails_says_nothing_of_either_side(stands):
    """Around 1.9, and nowhere near the end 3.7: it is passed by. Around the end: it is left out."""

    def gap(middle, width):
        return lambda factor: nan if abs(factor / middle - 1) < width else 3.7 / factor

    found, _ = searched(gap(1.9, 0.05), stands)
    assert found == pytest.approx(3.7, rel=1.1 * TOLERANCE)
    found, rows = searched(gap(3.7, 0.05), stands)
    assert found < 3.7 * 0.951 if stands else found > 3.7 * 1.049
    assert not any(row["proves"] for row in rows if np.isnan(row["load_factor"]))
    found, _ = searched(lambda factor: nan, stands)
    assert np.isnan(found)


def test_what_cannot_be_as_weak_ends_the_search():
    """A criterion that exists up to a factor of 2 only stands at about that."""
    found, _ = searched(LOADS["cohesion"], True, strongest=(0.0, 2.0))
    assert 2 / (1 + 2 * TOLERANCE) <= found <= 2
    found, _ = searched(LOADS["unsafe"], False, strongest=(0.5, inf))
    assert 0.5 <= found <= 0.5 * (1 + 2 * TOLERANCE)


@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (-2.0, 3.0)])
def test_the_next_factor_is_where_a_power_law_crosses_one(low, high):
    """Load factors of e^1 and e^-3 at both ends: a quarter of the way, in logarithms."""
    found = _next(low, high, (low, 1.0), (high, -3.0), nan)
    assert found == pytest.approx(low + (high - low) / 4)
    # Next to an end it keeps a distance, and without a load factor it takes the middle.
    for one, other in (((low, 1e-9), (high, -3.0)), ((low, 1.0), (high, -1e-9))):
        found = _next(low, high, one, other, nan)
        assert low < found < high
        assert min(found - low, high - found) > 0.01 * (high - low)
    middle = (low + high) / 2
    assert _next(low, high, (low, inf), (high, -3.0), nan) == middle
    assert _next(low, high, (low, 1.0), (high, -inf), nan) == middle
    assert _next(low, high, (low, -3.0), (high, 1.0), nan) == middle


def test_with_one_side_it_goes_as_far_as_the_load_factor_says():
    for reach in (0.5, -0.5):
        side = (1.0, inf) if reach > 0 else (-inf, 1.0)
        assert _next(*side, (0.0, inf), (inf, -inf), reach) == pytest.approx(1 + reach)
    for reach, step in ((inf, 1), (-inf, -1), (1e9, 1), (-1e9, -1)):
        side = (1.0, inf) if step > 0 else (-inf, 1.0)
        found = _next(*side, (0.0, inf), (inf, -inf), reach) - 1
        assert log(1.5) < step * found < log(1e4)
    assert _next(1.0, inf, (0.0, inf), (inf, -inf), 0.0) == pytest.approx(1.001)
    assert _next(-inf, 1.0, (0.0, inf), (inf, -inf), 0.0) == pytest.approx(0.999)


def test_around_what_failed_the_widest_gap_is_halved():
    assert _clear(0.5, 0.0, 1.0, [], True, 1e-3) == 0.5
    assert _clear(0.5, 0.0, 1.0, [0.6], True, 1e-3) == 0.5
    assert _clear(0.6, 0.0, 1.0, [0.6], True, 1e-3) == pytest.approx(0.3)
    assert _clear(0.4, 0.0, 1.0, [0.4], True, 1e-3) == pytest.approx(0.7)
    # Of two that are as wide the one on the side of the end that is proven.
    assert _clear(0.5, 0.0, 1.0, [0.5], True, 1e-3) == pytest.approx(0.25)
    assert _clear(0.5, 0.0, 1.0, [0.5], False, 1e-3) == pytest.approx(0.75)
    assert _clear(0.5, 0.499, 0.501, [0.5], True, 1e-3) is None
    assert _clear(0.5, -inf, 0.6, [0.5], True, 1e-3) < 0.5
    assert _clear(0.5, 0.4, inf, [0.5], False, 1e-3) > 0.5
