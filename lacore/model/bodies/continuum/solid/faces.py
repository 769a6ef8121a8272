"""Faces of tetrahedra: their nodes and their geometry."""

import numpy as np
from skfem import MeshTet

from lacore.model.meshes.solid.faces import face_corners
from lacore.numerics.arrays import Floats, Ints

SIDES = np.array([(0, 1), (1, 2), (0, 2)]).T
"""Ends of the edges of a face, in the order in which nodes follow its vertices, shape (2, 3)."""
EDGES = np.array([(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]).T
"""Ends of the edges of a tetrahedron as scikit-fem numbers them, shape (2, 6)."""
_EDGE = np.full((4, 4), -1)
_EDGE[EDGES[0], EDGES[1]] = _EDGE[EDGES[1], EDGES[0]] = np.arange(6)


def face_geometry(mesh: MeshTet, facets: Ints) -> tuple[Floats, Floats]:
    """Return the areas of faces, (n,), m^2, and unit normals out of their first element, (3, n)."""
    a, b, c = face_corners(mesh, facets).transpose(1, 2, 0)
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    middle = mesh.p[:, mesh.t[:, mesh.f2t[0, facets]]].mean(axis=1).T
    outward = np.sign(np.sum(normal * (a - middle), axis=1)) / length
    return length / 2, np.asarray((normal * outward[:, None]).T)


def face_vertices(mesh: MeshTet, facets: Ints, elements: Ints) -> Ints:
    """Return which vertices of their elements are the corners of faces, 0 to 3, shape (3, n)."""
    own = mesh.t[:, elements]
    return np.stack([np.argmax(own == corner, axis=0) for corner in mesh.facets[:, facets]])


def face_nodes(
    mesh: MeshTet, element_nodes: Ints, degree: int, facets: Ints, side: int = 0
) -> Ints:
    """Return the nodes on faces in one of their elements, shape (3 or 6, n).

    Those at the vertices come first, in the order of ``mesh.facets``, then those at the midpoints
    of `SIDES`.
    """
    element = mesh.f2t[side, facets]
    at = face_vertices(mesh, facets, element)
    if degree == 2:
        at = np.concatenate([at, 4 + _EDGE[at[SIDES[0]], at[SIDES[1]]]])
    return np.asarray(element_nodes[at, element])
