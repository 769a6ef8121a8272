"""Arches just above their minimum thickness, where hardly any reactions are possible."""

from math import radians

import numpy as np
import pytest

import lacore as la

MU = 0.5
PUSH = {"reference_loads": (1.0, 0.0), "dead_loads": (0.0, -1.0)}


def arch(voussoirs, thickness, embrace):
    """An arch under its weight, with a part of the weight as a horizontal force."""
    stones = la.masonry.arch(voussoirs, 1 - thickness / 2, thickness, friction=MU, embrace=embrace)
    own = tuple(str(number + 1) for number in range(voussoirs))
    loads = {kind: [la.BodyForce("arch", force, own)] for kind, force in PUSH.items()}
    return la.Problem({"arch": stones}, supports=[la.Fix("arch", ("left", "right"))], **loads)


def certified(voussoirs, embrace, share):
    """Whether the load factor at a share of the minimum thickness is certified, and its size."""
    angle = radians(embrace)
    least = la.limit_thickness(lambda t: arch(voussoirs, t, angle), (0.005, 0.3), tolerance=1e-6)
    state = la.solve(arch(voussoirs, share * least.value, angle))
    return state.status is la.Status.SOLVED and 0 < state.load_factor < 0.02


@pytest.mark.parametrize(
    ("voussoirs", "embrace", "share"), [(10, 155, 1.001), (22, 128, 1.0007), (29, 161, 1.004)]
)
def test_an_arch_just_above_its_minimum_thickness(voussoirs, embrace, share):
    assert certified(voussoirs, embrace, share)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(20))
def test_other_arches_just_above_their_minimum_thickness(number):
    rng = np.random.default_rng([51, number])
    assert certified(int(rng.integers(7, 61)), rng.uniform(120, 180), rng.uniform(1.0005, 1.02))
