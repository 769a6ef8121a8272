"""Nearest points of small polyhedra, of each of many its own.

At the nearest point of ``normals x <= bounds`` what is left is a sum of the normals of planes that
meet there, each with a share >= 0. Planes and unknowns are few, so that subsets are tried in turn,
of all points at once that have not found theirs: the answer is exact, whatever the angles.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from lacore.arrays import Floats

_PARALLEL = 1e-7  # sine of the angle between planes below which they have no edge in common
_ROUND_OFF = 4 * float(np.finfo(float).eps)  # of the sizes of the terms


@dataclass(frozen=True)
class Nearest:
    """Nearest points of polyhedra.

    Attributes:
        points: themselves, shape (m, n).
        along: their derivatives by the points given, shape (m, n, n): the orthogonal projections
            onto the faces that they are on.
    """

    points: Floats
    along: Floats


def nearest(normals: Floats, bounds: Floats, points: Floats) -> Nearest:
    """The points of ``normals x <= bounds`` nearest to given ones.

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
