"""Faces of tetrahedra: nodes on them, where they lie, which ones a predicate selects."""

from collections.abc import Callable

import numpy as np
from skfem import MeshTet

from lacore.arrays import Bools, Floats, Ints
from lacore.conditions.where import asked
from lacore.errors import InputError
from lacore.showing import placed

SIDES = np.array([(0, 1), (1, 2), (0, 2)]).T
"""Ends of the edges of a face, in the order in which nodes follow its vertices, shape (2, 3)."""
EDGES = np.array([(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]).T
"""Ends of the edges of a tetrahedron as scikit-fem numbers them, shape (2, 6)."""
_EDGE = np.full((4, 4), -1)
_EDGE[EDGES[0], EDGES[1]] = _EDGE[EDGES[1], EDGES[0]] = np.arange(6)
_LATTICE = np.array([(i, j, 8 - i - j) for i in range(9) for j in range(9 - i)]) / 8
# Barycentric coordinates at which a predicate is asked: inside of a face, so that `<` and `<=` with
# an edge select the same, and close to its edges, so that one that ends just past these is seen.
_SAMPLES = _LATTICE + 1e-3 * (1 / 3 - _LATTICE)


def face_corners(mesh: MeshTet, facets: Ints) -> Floats:
    """Corners of faces, shape (3, 3, n): coordinates, corners, faces; m."""
    return np.asarray(mesh.p[:, mesh.facets[:, facets]])


def face_geometry(mesh: MeshTet, facets: Ints) -> tuple[Floats, Floats]:
    """Areas of faces, (n,), m^2, and unit normals out of their first element, (3, n)."""
    a, b, c = face_corners(mesh, facets).transpose(1, 2, 0)
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    middle = mesh.p[:, mesh.t[:, mesh.f2t[0, facets]]].mean(axis=1).T
    outward = np.sign(np.sum(normal * (a - middle), axis=1)) / length
    return length / 2, np.asarray((normal * outward[:, None]).T)


def face_vertices(mesh: MeshTet, facets: Ints, elements: Ints) -> Ints:
    """Which vertices of their elements the corners of faces are, 0 to 3, shape (3, n)."""
    own = mesh.t[:, elements]
    return np.stack([np.argmax(own == corner, axis=0) for corner in mesh.facets[:, facets]])


def face_nodes(
    mesh: MeshTet, element_nodes: Ints, degree: int, facets: Ints, side: int = 0
) -> Ints:
    """Nodes on faces as one of their elements has them, shape (3 or 6, n).

    Those at the vertices in the order of ``mesh.facets``, then those at the midpoints of `SIDES`.
    """
    element = mesh.f2t[side, facets]
    at = face_vertices(mesh, facets, element)
    if degree == 2:
        at = np.concatenate([at, 4 + _EDGE[at[SIDES[0]], at[SIDES[1]]]])
    return np.asarray(element_nodes[at, element])


def selected_faces(mesh: MeshTet, where: Callable[[Floats], Bools], field: str) -> Ints:
    """Boundary faces that satisfy a predicate on coordinates (3, n) all over.

    Raises:
        InputError: the predicate fails, does not return one bool a point, or ends inside a face.
    """
    boundary = mesh.boundary_facets().astype(np.int64)
    corner = face_corners(mesh, boundary)
    samples = np.einsum("xaf,sa->xfs", corner, _SAMPLES)
    # Without round-off, so that `x[2] == 0.7` holds on a face at 0.7.
    low, high = corner.min(axis=1)[:, :, None], corner.max(axis=1)[:, :, None]
    inside = asked(where, np.clip(samples, low, high).reshape(3, -1), field)
    inside = inside.reshape(boundary.size, -1)
    whole = inside.all(axis=1)
    cut = np.flatnonzero(inside.any(axis=1) & ~whole)
    if cut.size:
        raise InputError(
            field,
            None,
            f"it ends inside the face around {placed(corner[:, :, cut[0]].mean(axis=1))}",
            "let faces of the mesh end where it ends",
        )
    return np.asarray(boundary[whole])
