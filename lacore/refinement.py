"""Refinement of triangles: some of them, names and shapes kept."""

import numpy as np
from skfem import MeshTri

from lacore.arrays import Ints


def refined(mesh: MeshTri, elements: Ints) -> MeshTri:
    """The mesh with elements divided into four, and neighbours so that no node hangs.

    Neighbours are divided across their longest edge first (red-green-blue), so that angles stay
    above half of the smallest one. Named boundaries are carried over; named elements are not.

    Source: Carstensen, An adaptive mesh-refining algorithm allowing for an H1 stable L2
        projection, Constr. Approx. 20, 2004 (as in scikit-fem).
    """
    finer: MeshTri = MeshTri(mesh.p, mesh.t).refined(np.asarray(elements))
    if not mesh.boundaries:
        return finer
    first = mesh.p.shape[1]
    middles = {place: first + k for k, place in enumerate(map(tuple, finer.p[:, first:].T))}
    names = {}
    for name, facets in mesh.boundaries.items():
        ends = mesh.facets[:, np.asarray(facets, dtype=np.int64)]
        places = 0.5 * (mesh.p[:, ends[0]] + mesh.p[:, ends[1]])
        middle = np.array([middles.get(place, -1) for place in map(tuple, places.T)], dtype=int)
        cut = middle >= 0
        halves = [np.stack([end[cut], middle[cut]]) for end in ends]
        names[name] = facets_between(finer, np.concatenate([ends[:, ~cut], *halves], axis=1))
    return finer.with_boundaries(names)


def facets_between(mesh: MeshTri, ends: Ints) -> Ints:
    """Numbers of the facets between vertices, shape (2, n), ascending."""
    count = mesh.p.shape[1]
    known = _keys(mesh.facets, count)
    order = np.argsort(known)
    return np.sort(order[np.searchsorted(known, _keys(ends, count), sorter=order)])


def _keys(ends: Ints, count: int) -> Ints:
    low, high = np.sort(np.asarray(ends, dtype=np.int64), axis=0)
    return np.asarray(low * count + high)
