"""What supports leave free of rigid blocks in space."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from lacore.arrays import Floats, Ints, Sparse
from lacore.bodies.blocks.held import unheld
from lacore.conditions.loads import Fix

if TYPE_CHECKING:
    from lacore.bodies.blocks3d.block_assembly import BlockAssembly3D

_AXES = "xyz"


def free_motions(body: "BlockAssembly3D", supports: Iterable[Fix]) -> Sparse:
    """Basis of the motions of blocks that supports leave free, shape (6 blocks, free)."""
    held = np.zeros((len(body.names), 6, 6))
    for support in supports:
        places, face = body.corners_of(body.outline(support.where, "Fix.where"))
        blocks = body.faces.block[face]
        motion = motions(body, blocks, places)
        if support.components == "normal":
            directions = [np.einsum("ak,kad->kd", body.faces.normal[:, face], motion)]
        else:
            directions = [motion[:, _AXES.index(axis)] for axis in support.components]
        for direction in directions:
            np.add.at(held, blocks, direction[:, :, None] * direction[:, None, :])
    return unheld(held)


def lever(body: "BlockAssembly3D", blocks: Ints, points: Floats) -> Floats:
    """Place against the centroid, per radius, shape (3, k)."""
    return np.asarray((points - body.centroid[:, blocks]) / body.radius[blocks])


def motions(body: "BlockAssembly3D", blocks: Ints, points: Floats) -> Floats:
    """Velocity of points of blocks, (3, k), by their six unknowns each, shape (k, 3, 6)."""
    x, y, z = lever(body, blocks, points)
    rows = np.zeros((blocks.size, 3, 6))
    rows[:, (0, 1, 2), (0, 1, 2)] = 1.0
    for axis, (one, other) in enumerate(((z, y), (x, z), (y, x))):  # w x lever
        rows[:, axis, 3 + (axis + 1) % 3] = one
        rows[:, axis, 3 + (axis + 2) % 3] = -other
    return rows
