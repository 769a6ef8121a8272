"""Meshes without any order: what holds on them does not hold by symmetry."""

from dataclasses import replace

import numpy as np
from skfem import MeshTri

from lacore.meshes.refinement import bisected

_PART = 3  # one in so many elements is divided
_MOVE = 0.25  # of the least height around a vertex: no element can turn over


def irregular(mesh: MeshTri, seed: int = 0) -> MeshTri:
    """Elements divided at random, inner vertices moved at random; boundaries stay."""
    rng = np.random.default_rng(seed)
    count = mesh.nelements
    finer, _ = bisected(mesh, np.sort(rng.permutation(count)[: -(-count // _PART)]))
    corner = finer.p[:, finer.t]
    edges = np.roll(corner, -1, axis=1) - corner
    twice = np.abs(edges[0, 0] * edges[1, 1] - edges[1, 0] * edges[0, 1])
    height = twice / np.sqrt((edges**2).sum(axis=0)).max(axis=0)
    least = np.full(finer.p.shape[1], np.inf)
    np.minimum.at(least, finer.t.ravel(), np.tile(height, 3))
    inner = finer.interior_nodes()
    turn = rng.uniform(0, 2 * np.pi, inner.size)
    size = _MOVE * least[inner] * np.sqrt(rng.uniform(0, 1, inner.size))
    points = finer.p.copy()
    points[:, inner] += size * np.stack([np.cos(turn), np.sin(turn)])
    moved: MeshTri = replace(finer, doflocs=points)
    return moved
