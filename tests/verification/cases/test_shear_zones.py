"""Coulomb loads of a body that shears along its floor: states below the closed form, and limits."""

import numpy as np
import pytest

import lacore as la
from lacore_verification.cases import deformable_block, shear_patch
from lacore_verification.cases.shared.shear_zones import least_friction

STATES = [
    pytest.param(mu, np.array(pressures), id=f"mu-{mu:g}")
    for mu, pressures in deformable_block.STATES.items()
]
LOADS = {0.5: 1.95, 0.75: 2.65, 0.9: 2.67}


@pytest.mark.parametrize(("mu", "pressures"), STATES)
def test_a_coulomb_state_lies_below_the_largest_load(mu, pressures):
    """A stress within yield has its tractions, by a strict lower bound of the continuum.

    It has friction mu t or, where that is more than k, shear k. This and rigid sliding satisfy the
    flow rule and Coulomb's law, so that the load is one of the interval.
    """
    load, reference = deformable_block.sliding_load(mu, pressures), deformable_block.reference(mu)
    assert load == pytest.approx(LOADS[mu])
    assert reference.low < load < reference.high - 0.04
    assert (mu * pressures > deformable_block.K).any()
    proven = la.lower_bound(deformable_block.admissible(mu, pressures))
    assert proven.status is la.Status.SOLVED
    assert 1 - 1e-7 <= proven.load_factor <= 1


def test_the_states_are_in_equilibrium():
    """Tractions that are not balanced carry no load at all."""
    mu, pressures = 0.75, np.array(deformable_block.STATES[0.75])
    unbalanced = la.lower_bound(deformable_block.admissible(mu, pressures[::-1]))
    assert unbalanced.load_factor == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize(("mu", "pressures"), STATES)
def test_no_pressure_of_a_state_is_above_the_limit_of_a_shear_zone(mu, pressures):
    limit = deformable_block.K * deformable_block.PRESSURE / least_friction(mu, 1.0)
    assert limit == pytest.approx(1 / mu + 2 * np.arctan(mu))
    assert pressures.max() < limit


@pytest.mark.parametrize("mu", [0.0, 0.05, 0.375, 0.75, 3.0])
def test_intervals_end_at_the_closed_forms(mu):
    block, patch = deformable_block.reference(mu), shear_patch.reference(mu, 1.6)
    assert block.high == block.associated == min(4 * mu, 3)
    assert patch.high == patch.associated == pytest.approx(min(1.6 * mu, 0.6))
    for one in (block, patch):
        assert one.low <= one.high
        assert not one.complete


@pytest.mark.parametrize(("mu", "largest"), [(0.5, 2.0), (0.75, 3.0), (0.9, 3.0)])
def test_associated_friction_carries_the_largest_load(mu, largest):
    state = la.solve(deformable_block.build(1, mu), coupling="associated", throw=True)
    assert state.load_factor == pytest.approx(largest, rel=1e-6)
