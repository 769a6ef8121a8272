"""Faces of tetrahedra: their corners, and their selection by a predicate."""

from collections.abc import Callable

import numpy as np
from skfem import MeshTet

from lacore.model.conditions.where import asked
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.errors import InputError
from lacore.reporting.text import Quantity, text

_LATTICE = np.array([(i, j, 8 - i - j) for i in range(9) for j in range(9 - i)]) / 8
# Barycentric coordinates at which a predicate is evaluated: inside of a face, so that `<` and `<=`
# with an edge select the same, and close to its edges, so that one that ends just past these is
# detected.
_SAMPLES = _LATTICE + 1e-3 * (1 / 3 - _LATTICE)


def face_corners(mesh: MeshTet, facets: Ints) -> Floats:
    """Return the corners of faces, shape (3, 3, n): coordinates, corners, faces; m."""
    return np.asarray(mesh.p[:, mesh.facets[:, facets]])


def selected_faces(mesh: MeshTet, where: Callable[[Floats], Bools], field: str) -> Ints:
    """Return the boundary faces on which a predicate on coordinates (3, n) holds everywhere.

    Raises:
        InputError: the predicate fails, does not return one bool per point, or ends inside a face.
    """
    boundary = mesh.boundary_facets().astype(np.int64)
    corner = face_corners(mesh, boundary)
    samples = np.einsum("xaf,sa->xfs", corner, _SAMPLES)
    # Clip to the box of the face, so that `x[2] == 0.7` holds on a face at 0.7.
    low, high = corner.min(axis=1)[:, :, None], corner.max(axis=1)[:, :, None]
    inside = asked(where, np.clip(samples, low, high).reshape(3, -1), field)
    inside = inside.reshape(boundary.size, -1)
    whole = inside.all(axis=1)
    cut = np.flatnonzero(inside.any(axis=1) & ~whole)
    if cut.size:
        raise InputError(
            field,
            None,
            text(
                "it ends inside the face around {}",
                Quantity(tuple(corner[:, :, cut[0]].mean(axis=1)), "m", ".6g"),
            ),
            "let faces of the mesh end where it ends",
        )
    return np.asarray(boundary[whole])
