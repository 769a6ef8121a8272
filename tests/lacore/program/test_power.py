"""Powers of states in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from lacore.program.power import kinematic_load_factor, kinematic_power, largest_power
from tests.lacore.planted import pushed_weight, wrong_state

SLIDES = np.array([0.5, 0.0])  # at a unit power of the load
FORCE = 1.0 + 0.5 * 8.0  # of the spring, and of friction under the weight


@pytest.mark.parametrize("closing", [0.0, 0.3])
def test_a_weight_that_sinks_onto_its_support_needs_the_force_of_one_that_slides(closing):
    """Along a distance that closes, reactions do the work that the weight gives back."""
    program = pushed_weight()
    contact = replace(program.contact, closing=np.full(2, closing))
    state = replace(
        wrong_state(),
        velocity=SLIDES - [0.0, closing],
        normal_reaction=np.full(2, 2.0),
    )
    sinking = replace(program, contact=contact)
    assert kinematic_load_factor(sinking, state, None) == pytest.approx(FORCE / 2.0)
    power = FORCE * 0.5 + 8.0 * closing
    assert kinematic_power(sinking, state) == pytest.approx(power)


def test_the_largest_power_is_that_of_all_strengths_at_the_largest_speed():
    assert largest_power(pushed_weight(), np.array([0.5, -2.0])) == pytest.approx((8 + 1) * 2.0)
