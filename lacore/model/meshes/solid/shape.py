"""Volumes and shapes of tetrahedra."""

import numpy as np
from skfem import MeshTet

from lacore.numerics.arrays import Floats

ENDS = np.array([(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]).T
"""Ends of the edges of a tetrahedron, as scikit-fem numbers them, shape (2, 6)."""


def signed_volumes(mesh: MeshTet) -> Floats:
    """Return the volumes of tetrahedra, (elements,), m^3, with the sign of their orientation."""
    a, b, c, d = mesh.p[:, mesh.t].transpose(1, 2, 0)
    return np.asarray(np.sum(np.cross(b - a, c - a) * (d - a), axis=1) / 6)


def shapes(mesh: MeshTet) -> Floats:
    """Return the shape of tetrahedra, (elements,): 1 for a regular one, 0 without volume.

    It is ``6 sqrt(2) volume / l^3``, with l the root of the mean of squared edges.

    Source: Parthasarathy, Graichen & Hathaway, A comparison of tetrahedron quality measures, Finite
        Elem. Anal. Des. 15, 1994.
    """
    edges = mesh.p[:, mesh.t[ENDS[0]]] - mesh.p[:, mesh.t[ENDS[1]]]
    length = np.sqrt(np.sum(edges**2, axis=0).mean(axis=0))
    volume = np.abs(signed_volumes(mesh))
    return np.asarray(6 * np.sqrt(2) * volume / np.where(length > 0, length, 1.0) ** 3)
