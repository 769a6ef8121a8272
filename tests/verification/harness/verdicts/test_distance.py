"""Distances of load factors from references that do not list all Coulomb loads."""

from math import isnan

import pytest

from lacore_verification.case import Reference, rigid
from lacore_verification.harness.verdicts.allowed import distance

LISTED = Reference(
    1.0, "f", "s", "interval of one mechanism", up_to=2.0, associated=2.5, complete=False
)


@pytest.mark.parametrize("value", [0.9, 2.25])
def test_another_coulomb_state_has_no_distance(value):
    assert isnan(distance(value, LISTED, rigid(0.0)))


@pytest.mark.parametrize(("value", "expected"), [(1.5, 0.0), (2.5 + 1e-9, 4e-10), (3.0, 0.2)])
def test_a_load_above_the_associated_one_has_its_distance_from_it(value, expected):
    assert distance(value, LISTED, rigid(0.0)) == pytest.approx(expected, abs=1e-12)
