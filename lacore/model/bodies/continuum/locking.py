"""Test whether continuous linear velocities can flow without a change of volume (T24).

A linear velocity has one ``theta`` per triangle, and a mesh has twice as many triangles as
vertices: as many conditions as unknowns. Only where four triangles fill a quadrilateral around the
crossing of its diagonals, one of their four conditions follows from the others (Nagtegaal, Parks &
Rice 1974).
"""

import numpy as np
from skfem.mesh import MeshTri1

from lacore.numerics.arrays import Bools, Floats, Ints

_STRAIGHT = 1e-9  # sine of the angle between the two halves of a diagonal: far above round-off


def crossed_quadrilaterals(mesh: MeshTri1) -> bool:
    """Return whether all triangles are quarters of quadrilaterals, cut along both diagonals."""
    t = mesh.t.astype(np.int64)
    centre = _crossings(mesh)[t]
    return bool(np.all(centre.sum(axis=0) == 1))


def _crossings(mesh: MeshTri1) -> Bools:
    """Return the vertices where two straight lines cross and nothing else meets.

    The shape is (vertices,).
    """
    vertices = mesh.p.shape[1]
    ends = mesh.facets.astype(np.int64)
    own, other = np.concatenate([ends[0], ends[1]]), np.concatenate([ends[1], ends[0]])
    crossing = np.bincount(own, minlength=vertices) == 4
    crossing[mesh.boundary_nodes()] = False
    order = np.argsort(own, kind="stable")
    four: Ints = other[order][crossing[own[order]]].reshape(-1, 4)
    at = np.flatnonzero(crossing)
    away = mesh.p[:, four] - mesh.p[:, at, None]
    away = away / np.linalg.norm(away, axis=0)
    crossing[at] = np.logical_or.reduce(
        [
            _opposite(away[..., 0], away[..., i]) & _opposite(away[..., j], away[..., k])
            for i, j, k in ((1, 2, 3), (2, 1, 3), (3, 1, 2))
        ]
    )
    return np.asarray(crossing)


def _opposite(a: Floats, b: Floats) -> Bools:
    """Return whether unit vectors of shape (2, k) point in opposite directions."""
    sine = np.abs(a[0] * b[1] - a[1] * b[0])
    return np.asarray((sine < _STRAIGHT) & (np.sum(a * b, axis=0) < 0))
