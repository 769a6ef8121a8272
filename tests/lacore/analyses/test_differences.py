"""Derivatives by differences: exact for parabolas, and kinks are seen."""

import numpy as np
import pytest

from lacore.analyses.differences import by_differences
from lacore.analyses.parameters import Parameter

AT = 2.0


def derivatives(load_factor):
    """By differences, of a load factor that is a function of one number, at `AT`."""
    parameter = Parameter("number", "own", AT, AT, at=lambda _, value: value)
    return by_differences(parameter, None, load_factor(AT), load_factor)


def test_a_parabola_has_its_derivative():
    found = derivatives(lambda x: 3 - x + 5 * x**2)
    assert found["unique"]
    # Round-off of load factors near 21, divided by steps of 3e-3.
    assert found["left"] == pytest.approx(19, abs=1e-10)
    assert found["right"] == pytest.approx(19, abs=1e-10)


def test_a_kink_has_two_derivatives():
    found = derivatives(lambda x: 1 + 3 * max(x - AT, 0.0) - 2 * min(x - AT, 0.0))
    assert not found["unique"]
    assert found["left"] == pytest.approx(-2, abs=1e-10)
    assert found["right"] == pytest.approx(3, abs=1e-10)


def test_a_load_factor_that_is_missing_at_a_neighbouring_value_is_named():
    found = derivatives(lambda x: x if x <= AT else np.nan)
    assert np.isnan([found["left"], found["right"]]).all()
    assert not found["unique"]
    assert "not certified" in found["why"]
