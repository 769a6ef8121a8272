"""Conditions of supports and rigid footings at the nodes of their part of the boundary."""

from typing import cast

import numpy as np

from lacore.model.conditions.elimination import NodeConditions, held, join
from lacore.model.conditions.footings import Footing, RigidFooting
from lacore.model.conditions.loads import Fix
from lacore.numerics.arrays import Floats, Ints


def support_conditions(support: Fix, nodes: Ints, outward: Floats) -> NodeConditions:
    """Return the conditions of a support.

    Args:
        support: support with its components.
        nodes: shape (c,).
        outward: unit outward normals there, shape (c, 2).
    """
    axes = [np.broadcast_to(axis, outward.shape) for axis in ([1.0, 0.0], [0.0, 1.0])]
    directions = {
        "x": axes[:1],
        "y": axes[1:],
        "xy": axes,
        "normal": [outward],
        "tangential": [np.stack([-outward[:, 1], outward[:, 0]], axis=1)],
    }[support.components]
    return join([held(nodes, direction) for direction in directions])


def footing_conditions(
    footing: Footing, nodes: Ints, outward: Floats, number: int
) -> NodeConditions:
    """Return the conditions of a footing with a number; arguments as in `support_conditions`."""
    rough = cast(RigidFooting, footing).rough  # Only three-dimensional bodies have twisting plates.
    motion = footing.motion(np.zeros(2))
    across = np.broadcast_to([-motion[1], motion[0]], outward.shape)
    carried = np.broadcast_to(motion, outward.shape) if rough else outward
    moved = NodeConditions(nodes, carried, np.full(nodes.size, number), carried @ motion)
    return join([moved, held(nodes, across)]) if rough else moved
