"""What supports leave free of rigid blocks."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import block_diag, csr_matrix

from lacore.arrays import Floats, Ints, Sparse
from lacore.conditions.loads import Fix

if TYPE_CHECKING:
    from lacore.bodies.blocks.block_assembly import BlockAssembly

_HELD = 1e-12  # squared: of the largest direction that supports hold; far above round-off
_ROUND_OFF = 1e-14  # of a unit vector
_AXES = {"x": (True, False), "y": (False, True), "xy": (True, True)}


def free_motions(body: "BlockAssembly", supports: Iterable[Fix]) -> Sparse:
    """Basis of the motions of blocks that supports leave free, shape (3 blocks, free)."""
    held = np.zeros((len(body.names), 3, 3))
    for support in supports:
        edges = body.outline(support.where, "Fix.where")
        for end in (body.edges.start, body.edges.end):
            _hold(body, held, edges, end[:, edges], support.components)
    return unheld(held)


def unheld(held: Floats) -> Sparse:
    """Basis of the motions of blocks along no direction that is held, shape (blocks k, free).

    Args:
        held: sums of the products of held directions with themselves, shape (blocks, k, k).
    """
    values, vectors = np.linalg.eigh(held)
    is_free = values <= _HELD * np.maximum(values.max(axis=1, keepdims=True), 1.0)
    untouched = is_free.all(axis=1)
    vectors[untouched] = np.eye(held.shape[1])
    vectors[np.abs(vectors) < _ROUND_OFF] = 0.0
    free = [axes[:, kept] for axes, kept in zip(vectors, is_free, strict=True)]
    # Of arrays alone scipy is to make another kind of matrix from 1.20 on, and warns.
    return csr_matrix(block_diag([csr_matrix((0, 0)), *free], format="csr"))


def lever(body: "BlockAssembly", blocks: Ints, points: Floats) -> Floats:
    """Place against the centroid, per radius, shape (2, k)."""
    return np.asarray((points - body.centroid[:, blocks]) / body.radius[blocks])


def _hold(
    body: "BlockAssembly", held: Floats, edges: Ints, points: Floats, components: str
) -> None:
    """Add the directions that a support holds at points of edges to their Gram matrices."""
    blocks = body.edges.block[edges]
    x, y = lever(body, blocks, points)
    one, zero = np.ones(edges.size), np.zeros(edges.size)
    axes = np.stack([np.stack([one, zero, -y], axis=1), np.stack([zero, one, x], axis=1)])
    if components in _AXES:
        directions = axes[np.array(_AXES[components])]
    else:
        normal = body.edges.normal[:, edges]
        along = normal if components == "normal" else np.stack([-normal[1], normal[0]])
        directions = np.einsum("ak,akd->kd", along, axes)[None]
    for direction in directions:
        np.add.at(held, blocks, direction[:, :, None] * direction[:, None, :])
