"""Rigid motions of blocks, in the plane and in three dimensions, and those that supports allow."""

from collections.abc import Iterable

import numpy as np
from scipy.sparse import block_diag, csr_matrix

from lacore.model.bodies.blocks.rigid_blocks import RigidBlocks
from lacore.model.conditions.loads import Fix
from lacore.numerics.arrays import Floats, Ints, Sparse

_HELD = 1e-12  # squared, by the largest held direction; far above round-off
_ROUND_OFF = 1e-14  # by a unit vector
_AXES = "xyz"
_ROTATIONS = {2: ((0, 1),), 3: ((1, 2), (2, 0), (0, 1))}
"""By dimension, for each rotation, the axis that turns and the axis into which it turns."""


def motion_count(dimension: int) -> int:
    """Return the number of unknowns of a rigid block.

    Velocities of the centroid, then rotations.
    """
    return dimension + len(_ROTATIONS[dimension])


def motions(body: RigidBlocks, blocks: Ints, points: Floats) -> Floats:
    """Return the velocities of points of blocks per unknown of the blocks, (k, d, u).

    The unknowns of a block are the velocity of its centroid and its radius times its rates of
    rotation, so that all are velocities (T70).

    Args:
        body: the assembly.
        blocks: the block of each point, (k,).
        points: (d, k), m.
    """
    lever = (points - body.centroid[:, blocks]) / body.radius[blocks]
    d = len(lever)
    rows = np.zeros((blocks.size, d, motion_count(d)))
    rows[:, range(d), range(d)] = 1.0
    for rotation, (one, other) in enumerate(_ROTATIONS[d], start=d):
        rows[:, one, rotation], rows[:, other, rotation] = -lever[other], lever[one]
    return rows


def free_motions(body: RigidBlocks, supports: Iterable[Fix]) -> Sparse:
    """Return a basis of the motions of blocks that supports allow, shape (u blocks, free)."""
    u = motion_count(body.dimension)
    held = np.zeros((len(body.names), u, u))
    for support in supports:
        points, normal, blocks = body.rims(body.outline(support.where, "Fix.where"))
        motion = motions(body, blocks, points)
        if support.components in ("normal", "tangential"):
            along = normal if support.components == "normal" else np.stack([-normal[1], normal[0]])
            directions = [np.einsum("ak,kau->ku", along, motion)]
        else:
            directions = [motion[:, _AXES.index(axis)] for axis in support.components]
        for direction in directions:
            np.add.at(held, blocks, direction[:, :, None] * direction[:, None, :])
    return _complement(held)


def moving_blocks(body: RigidBlocks, supports: Iterable[Fix]) -> Ints:
    """Return the numbers of the blocks that supports do not hold completely."""
    free = np.diff(free_motions(body, supports).indptr).reshape(len(body.names), -1)
    return np.flatnonzero(free.any(axis=1))


def _complement(held: Floats) -> Sparse:
    """Return a basis of the motions orthogonal to held directions, shape (u blocks, free).

    Args:
        held: sums of the outer products of held directions with themselves, shape (blocks, u, u).
    """
    values, vectors = np.linalg.eigh(held)
    is_free = values <= _HELD * np.maximum(values.max(axis=1, keepdims=True), 1.0)
    untouched = is_free.all(axis=1)
    vectors[untouched] = np.eye(held.shape[1])
    vectors[np.abs(vectors) < _ROUND_OFF] = 0.0
    free = [axes[:, kept] for axes, kept in zip(vectors, is_free, strict=True)]
    # From scipy 1.20 on, block_diag of arrays alone returns a different kind of matrix, and warns.
    return csr_matrix(block_diag([csr_matrix((0, 0)), *free], format="csr"))
