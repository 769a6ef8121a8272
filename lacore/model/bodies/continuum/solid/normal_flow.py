"""Velocities of tetrahedra whose normal parts are continuous by construction (T90).

At a vertex of a tetrahedron three of its faces meet, whose normal velocities determine the
velocity. At the middle of an edge two faces meet, and the component along the edge is free in each
tetrahedron. The unknowns are the normal velocities at the nodes of faces, and one along each edge
of each element: BDM1 and BDM2. The held normal velocity of a face is given by a number for each of
its nodes.

Source: Brezzi, Douglas & Marini 1985; Nedelec 1986.
"""

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.solid.faces import EDGES, SIDES, face_geometry
from lacore.numerics.arrays import Bools, Floats, Ints, Sparse

_FACES = np.array([(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)])  # vertices, as in scikit-fem
_OF_VERTEX = [np.flatnonzero((own == _FACES).any(axis=1)) for own in np.arange(4)]
_OF_EDGE = [np.intersect1d(_OF_VERTEX[a], _OF_VERTEX[b]) for a, b in EDGES.T]


def nodes_of_faces(dofs: BodyDofs) -> int:
    """Return the number of values that determine the normal velocity of a face."""
    return 3 if dofs.degree == 1 else 6


def flowing(dofs: BodyDofs, held: Bools, carried: Floats) -> tuple[Sparse, Sparse]:
    """Return the velocities of a body by its free unknowns, and by the speeds of footings.

    Args:
        dofs: unknowns of the body.
        held: faces whose normal velocity is not free, shape (facets,).
        carried: normal velocity at the nodes of held faces per speed of each footing, shape
            (facets, nodes of a face, f).

    Returns:
        Matrices of shape (count, free) and (count, f).
    """
    mesh, count = dofs.body.mesh, nodes_of_faces(dofs)
    whole = _by_normals(dofs)
    held_q = np.repeat(held, count)
    free = np.concatenate([~held_q, np.ones(whole.shape[1] - held_q.size, dtype=bool)])
    moved = csr_matrix(carried.reshape(held_q.size, -1) * held_q[:, None])
    by_normal = whole[:, : mesh.nfacets * count]
    return csr_matrix(whole[:, np.flatnonzero(free)]), csr_matrix(by_normal @ moved)


def normal_forces(dofs: BodyDofs, force: Floats, facets: Ints) -> Floats:
    """Return the forces across faces at the nodes there, shape (3, nodes), N.

    Args:
        dofs: unknowns of the body.
        force: unbalanced forces on its unknowns, including those between its elements, shape
            (count,).
        facets: boundary faces.
    """
    mesh, count = dofs.body.mesh, nodes_of_faces(dofs)
    across = (_by_normals(dofs).T @ force)[: mesh.nfacets * count].reshape(-1, count)[facets]
    _, normal = face_geometry(mesh, facets)
    total = np.zeros((3, dofs.nodes.shape[1]))
    nodes = dofs.facet_nodes(facets).T  # shape (faces, nodes of a face)
    for axis in range(3):
        np.add.at(total[axis], nodes, across * normal[axis][:, None])
    return total


def _by_normals(dofs: BodyDofs) -> Sparse:
    """Return the velocities by normal ones at nodes of faces, then by those along edges."""
    mesh, count = dofs.body.mesh, nodes_of_faces(dofs)
    every = np.arange(mesh.nelements)
    _, normal = face_geometry(mesh, np.arange(mesh.nfacets))
    parts = []

    def add(node: int, columns: Ints, rows: Floats) -> None:
        """Add the velocity at a node of all elements by three numbers; rows (elements, 3, 3)."""
        inverse = np.linalg.inv(rows)  # shape (elements, component, number)
        # shape (elements, component)
        unknown = dofs.dofs[:, dofs.element_nodes[node]].T - dofs.offset
        shape = inverse.shape
        parts.append(
            (
                inverse.ravel(),
                np.broadcast_to(unknown[:, :, None], shape).ravel(),
                np.broadcast_to(columns.T[:, None, :], shape).ravel(),
            )
        )

    def place(facets: Ints, vertex: Ints) -> Ints:
        return np.asarray(np.argmax(mesh.facets[:, facets] == vertex, axis=0))

    for vertex, faces in enumerate(_OF_VERTEX):
        facets = mesh.t2f[faces].astype(np.int64)  # shape (3, elements)
        columns = np.stack([own * count + place(own, mesh.t[vertex]) for own in facets])
        add(vertex, columns, normal[:, facets].transpose(2, 1, 0))
    if dofs.degree == 2:
        side = np.full((3, 3), -1)
        side[SIDES[0], SIDES[1]] = side[SIDES[1], SIDES[0]] = np.arange(3)
        for edge, faces in enumerate(_OF_EDGE):
            a, b = (mesh.t[end] for end in EDGES[:, edge])
            facets = mesh.t2f[faces].astype(np.int64)  # shape (2, elements)
            at = [own * count + 3 + side[place(own, a), place(own, b)] for own in facets]
            along = mesh.p[:, b] - mesh.p[:, a]
            along = along / np.linalg.norm(along, axis=0)
            at.append(mesh.nfacets * count + 6 * every + edge)
            # shape (3, xyz, elements)
            rows = np.stack([*normal[:, facets].transpose(1, 0, 2), along])
            add(4 + edge, np.stack(at), rows.transpose(2, 0, 1))
    values, rows, columns = (np.concatenate(own) for own in zip(*parts, strict=True))
    width = mesh.nfacets * count + (6 * mesh.nelements if dofs.degree == 2 else 0)
    basis = csr_matrix(coo_matrix((values, (rows, columns)), shape=(dofs.count, width)))
    basis.eliminate_zeros()
    return basis
