"""Smallest and largest force of a support, and the state in which it moves."""

import numpy as np
import pytest

import lacore as la
from lacore.reporting.errors import InputError
from lacore.reporting.status import Role, Status


def flat_arch(friction, half=2.0, depth=1.0):
    """Two blocks of weight 1 side by side between fixed blocks."""
    edges = (-1.0, 0.0, half, 2 * half, 2 * half + 1.0)
    blocks = {
        name: la.masonry.rectangle(start, end, 0.0, depth)
        for name, start, end in zip(("left", "a", "b", "right"), edges[:-1], edges[1:], strict=True)
    }
    return la.Problem(
        bodies={"arch": la.BlockAssembly(blocks, friction=friction)},
        supports=[la.Fix("arch", ("left", "right"))],
        dead_loads=[la.PointForce("arch", name, (0, -1)) for name in ("a", "b")],
        reference_loads=[la.PointForce("arch", "a", (1, 0))],
    )


@pytest.mark.parametrize(("friction", "half"), [(2.0, 2.0), (0.8, 2.0), (0.4, 3.0), (1.0, 6.0)])
def test_the_smallest_thrust_of_a_flat_arch(friction, half):
    """The line of thrust rises over the depth, ``H h = W a/2``, and joints carry ``W <= mu H``.

    Nothing bounds the thrust from above, because vertical joints carry any force across them.
    """
    found = la.thrust(flat_arch(friction, half), "arch", "right", (-1, 0))
    assert found.least == pytest.approx(max(half / 2, 1 / friction), rel=1e-6)
    assert found.most == np.inf
    assert found.pushing.status is Status.LOCKED


def test_a_spreading_support_hinges_the_flat_arch():
    """The crown sinks by half the span per depth of spreading: hinges at top and bottom."""
    problem = la.support_motion(flat_arch(2.0), "arch", "right", (1, 0))
    state = la.solve(problem)
    assert state.load_factor == pytest.approx(-1, rel=1e-6)
    assert state.carried.role is Role.CAPACITY
    motion = state.velocity["arch"]
    assert motion[:, 3] == pytest.approx([1, 0, 0], abs=1e-6)  # the support, without rotation
    assert motion[2, 1] == pytest.approx(-motion[2, 2], rel=1e-5)
    assert abs(motion[2, 1]) == pytest.approx(1 / 2, rel=1e-5)  # opens by 1 over the depth, twice


def arch():
    return la.Problem(
        bodies={"arch": la.masonry.arch(9, 1, 0.2, friction=0.9)},
        supports=[la.Fix("arch", "left"), la.Fix("arch", "right")],
        dead_loads=[la.BodyForce("arch", (0, -1))],
        reference_loads=[la.BodyForce("arch", (1, 0))],
    )


def test_both_supports_of_an_arch_have_the_same_thrusts():
    """Only the supports push horizontally."""
    one = la.thrust(arch(), "arch", "right", (-1, 0))
    other = la.thrust(arch(), "arch", "left", (1, 0))
    assert 0 < one.least < one.most < np.inf
    assert [one.least, one.most] == pytest.approx([other.least, other.most], rel=1e-6)
    reversed_sign = la.thrust(arch(), "arch", "right", (1, 0))
    assert [one.least, one.most] == pytest.approx(
        [-reversed_sign.most, -reversed_sign.least], rel=1e-6
    )


@pytest.mark.parametrize(
    ("block", "direction", "field"),
    [("5", (1, 0), "block"), ("right", (1, 1), "direction"), ("right", (0, 0), "direction")],
)
def test_what_is_no_support_or_no_axis_is_rejected(block, direction, field):
    with pytest.raises(InputError) as error:
        la.thrust(arch(), "arch", block, direction)
    assert error.value.field == field
