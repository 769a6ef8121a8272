"""Nearest points, corners and edges of small polyhedra, for many points with one each.

At the nearest point of ``normals x <= bounds`` the residual is a sum of the normals of planes that
meet there, with non-negative shares. Planes and unknowns are few, so subsets are tried in turn for
all remaining points at once. The result is exact for any angles.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from lacore.numerics.arrays import Bools, Floats

_PARALLEL = 1e-7  # sine of the angle between planes below which they have no common edge
_SINGULAR = 1e-9  # determinant of unit normals below which planes do not meet in a point
_ON = 1e-9  # distance, by the sizes of the terms, of a point that lies on a plane
_ROUND_OFF = 4 * float(np.finfo(float).eps)  # by the sizes of the terms


@dataclass(frozen=True)
class Nearest:
    """Nearest points of polyhedra.

    Attributes:
        points: the points, shape (m, n).
        along: their derivatives by the given points, shape (m, n, n): the orthogonal projections
            onto their faces.
    """

    points: Floats
    along: Floats


def nearest(normals: Floats, bounds: Floats, points: Floats) -> Nearest:
    """Return the points of ``normals x <= bounds`` nearest to given ones.

    Args:
        normals: none of them 0, shape (m, k, n).
        bounds: shape (m, k).
        points: shape (m, n).
    """
    m, k, n = normals.shape
    sizes = np.linalg.norm(normals, axis=2)
    units, levels = normals / sizes[:, :, None], bounds / sizes
    over = np.einsum("mkn,mn->mk", units, points) - levels
    terms = np.linalg.norm(points, axis=1) + np.abs(levels).max(axis=1, initial=0.0)
    wrong = over.max(axis=1, initial=0.0)
    found, along = points.astype(np.float64), np.tile(np.eye(n), (m, 1, 1))
    for size in range(1, n + 1):
        for chosen in combinations(range(k), size):
            left = np.flatnonzero(wrong > _ROUND_OFF * terms)
            if not left.size:
                break
            base, root = np.linalg.qr(units[left][:, chosen].transpose(0, 2, 1))
            good = np.abs(np.diagonal(root, axis1=1, axis2=2)).min(axis=1) > _PARALLEL
            root = np.where(good[:, None, None], root, np.eye(size))
            move = np.linalg.solve(root.transpose(0, 2, 1), over[left][:, chosen, None])
            shares = np.linalg.solve(root, move)[:, :, 0]
            near = points[left] - (base @ move)[:, :, 0]
            beyond = np.einsum("mkn,mn->mk", units[left], near) - levels[left]
            residual = np.maximum(beyond.max(axis=1), (-shares).max(axis=1))
            better = good & (residual < wrong[left])
            those = left[better]
            found[those], wrong[those] = near[better], residual[better]
            along[those] = np.eye(n) - (base @ base.transpose(0, 2, 1))[better]
    return Nearest(found, along)


def corners(normals: Floats, bounds: Floats, felt: Bools) -> tuple[Floats, Bools]:
    """Return the points in which planes meet, and which are corners of ``normals x <= bounds``.

    Args:
        normals: shape (m, k, n).
        bounds: shape (m, k).
        felt: which coordinates of the normals may be nonzero, shape (n,).

    Returns:
        For each choice of planes: points of shape (m, v, n), and whether they are corners, (m, v).
    """
    places = np.flatnonzero(felt)
    seen = normals[:, :, felt]
    length = np.linalg.norm(seen, axis=2, keepdims=True)
    length[length == 0] = 1.0
    seen, bound = seen / length, bounds / length[:, :, 0]
    found, real = [], []
    for chosen in combinations(range(normals.shape[1]), places.size):
        matrix, right = seen[:, chosen], bound[:, chosen]
        good = np.abs(np.linalg.det(matrix)) > _SINGULAR
        matrix = np.where(good[:, None, None], matrix, np.eye(places.size))
        corner = np.linalg.solve(matrix, right[:, :, None])[:, :, 0]
        terms = np.einsum("mpl,ml->mp", np.abs(seen), np.abs(corner)) + np.abs(bound)
        inside = np.einsum("mpl,ml->mp", seen, corner) - bound <= _ON * terms
        found.append(corner)
        real.append(good & inside.all(axis=1))
    points = np.zeros((seen.shape[0], len(found), felt.size))
    points[:, :, places] = np.stack(found, axis=1)
    return points, np.stack(real, axis=1)


def far_edges(normals: Floats) -> Floats:
    """Return the directions of unbounded edges of ``normals x <= bounds``, or zeros.

    The largest of all coordinates except the first is 1. The shape is (m, e, n), with e at least 1:
    directions that are zero for all, or duplicates for all, are left out.
    """
    size = normals.shape[2]
    found = []
    for chosen in combinations(range(normals.shape[1]), size - 1):
        along = _across(normals[:, chosen])
        longest = np.abs(along[:, 1:]).max(axis=1, keepdims=True)
        along = along / np.where(longest > _SINGULAR, longest, np.inf)
        for direction in (along, -along):
            terms = np.einsum("mpl,ml->mp", np.abs(normals), np.abs(direction))
            out = np.einsum("mpl,ml->mp", normals, direction) <= _ON * terms
            found.append(np.where(out.all(axis=1)[:, None], direction, 0.0))
    others: list[Floats] = []
    for edge in found:
        if edge.any() and all(np.abs(edge - other).max() > _ON for other in others):
            others.append(edge)
    return np.stack(others or found[:1], axis=1)


def _across(rows: Floats) -> Floats:
    """Return the vector orthogonal to n - 1 rows, zero if they are dependent, shape (m, n)."""
    size = rows.shape[2]
    minors = [(-1) ** j * np.linalg.det(np.delete(rows, j, axis=2)) for j in range(size)]
    return np.stack(minors, axis=1)
