"""The error of a load factor covers its residual times the power of loads and dissipation."""

from dataclasses import replace

import pytest

import lacore as la
from lacore.analyses.proven_values import error
from tests.lacore.shown import wall


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_a_residual_counts_times_all_powers(share):
    """At ``F0.u = 1`` the load factor is the dissipation less the power of the dead loads."""
    state = la.solve(wall(), coupling="associated")
    velocity, program = state.point.velocity, state.discretisation.full
    dead = float(program.dead_load @ velocity)
    assert abs(dead) > 0.1
    found = error(replace(state, load_factor=share * state.load_factor))
    powers = abs(share * state.load_factor + dead) + abs(dead) + abs(share * state.load_factor)
    assert found >= (1 - 1e-12) * state.certificate.worst[1] * powers > 0
