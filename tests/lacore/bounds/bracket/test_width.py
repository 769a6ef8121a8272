"""Width of a bracket."""

from math import inf, nan

import pytest

from lacore.bounds.bracket.bracket import width


@pytest.mark.parametrize(
    ("lower", "upper", "expected"),
    [(1.0, 3.0, 1.0), (9.0, 11.0, 0.2), (-3.0, -1.0, 1.0), (3.0, 1.0, -1.0), (2.0, 2.0, 0.0)],
)
def test_it_is_relative_to_the_mean(lower, upper, expected):
    """In any unit, and for loads of either sign; bounds that cross have a negative width."""
    assert width(lower, upper) == pytest.approx(expected)
    assert width(1e6 * lower, 1e6 * upper) == pytest.approx(expected)


@pytest.mark.parametrize(("lower", "upper"), [(-inf, 1.0), (1.0, inf), (nan, 1.0), (-1.0, 1.0)])
def test_without_a_bound_or_a_mean_it_is_infinite(lower, upper):
    assert width(lower, upper) == inf
