"""Irregular meshes, so that results on them do not depend on symmetry."""

from dataclasses import replace
from itertools import combinations

import numpy as np
from skfem import MeshTet, MeshTri

from lacore.model.meshes.refinement import bisected
from lacore.model.meshes.solid.bisection import bisected_tetrahedra
from lacore.numerics.arrays import Floats

_PART = 3  # One in so many elements is divided.
_MOVE = 0.25  # Relative to the least height around a vertex, so that no element is inverted.
_DIVIDED = {2: bisected, 3: bisected_tetrahedra}


def irregular(mesh: MeshTri | MeshTet, seed: int = 0) -> MeshTri | MeshTet:
    """Return a mesh with elements divided and inner vertices moved at random; boundaries stay."""
    rng = np.random.default_rng(seed)
    count, d = mesh.nelements, mesh.p.shape[0]
    finer, _ = _DIVIDED[d](mesh, np.sort(rng.permutation(count)[: -(-count // _PART)]))
    least = np.full(finer.p.shape[1], np.inf)
    np.minimum.at(least, finer.t.ravel(), np.tile(_heights(finer.p[:, finer.t]), d + 1))
    inner = finer.interior_nodes()
    away = rng.normal(size=(d, inner.size))
    size = _MOVE * least[inner] * rng.uniform(0, 1, inner.size) ** (1 / d)
    points = finer.p.copy()
    points[:, inner] += size * away / np.linalg.norm(away, axis=0)
    moved: MeshTri | MeshTet = replace(finer, doflocs=points)
    return moved


def _heights(corner: Floats) -> Floats:
    """Return the least heights of simplices with corners (d, d + 1, n), m, shape (n,)."""
    d = corner.shape[0]
    volume = np.abs(np.linalg.det(np.moveaxis(corner[:, 1:] - corner[:, :1], 2, 0)))
    facets = []
    for own in combinations(range(d + 1), d):
        side = np.moveaxis(corner[:, own[1:]] - corner[:, own[:1]], 2, 0)
        facets.append(np.sqrt(np.linalg.det(side.transpose(0, 2, 1) @ side)))
    return np.asarray(volume / np.max(facets, axis=0))
