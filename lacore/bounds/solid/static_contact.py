"""Tractions and conditions on faces of equilibrium tetrahedra: contact (T93), supports (T91)."""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.sparse import block_diag, csr_matrix, eye_array, hstack, vstack

from lacore.bounds.equilibrium import EquilibriumDofs
from lacore.bounds.static_contact import selected
from lacore.model.bodies.continuum.solid.faces import face_geometry
from lacore.model.bodies.continuum.solid.held_nodes import flowing_between_nodes
from lacore.model.bodies.continuum.solid.holding import face_conditions, moved_along, speed_names
from lacore.model.conditions.footings import Footing
from lacore.model.conditions.loads import Fix
from lacore.model.contact.faces import Faces
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.laws import laws_of
from lacore.model.contact.rows import ContactPoints, Station, joined
from lacore.model.contact.touching import Touching
from lacore.model.meshes.solid.faces import face_corners
from lacore.numerics.arrays import Ints, Sparse
from lacore.program.kinematic import ContactRows


def face_tractions(
    interfaces: Sequence[Interface],
    touching: Sequence[Touching],
    bodies: Mapping[str, EquilibriumDofs],
    n: int,
) -> tuple[ContactRows, ContactPoints]:
    """Return the tractions at the corners of faces.

    They are linear between the corners, so the convex law holds there as well.
    """
    stations = []
    for index, (interface, own) in enumerate(zip(interfaces, touching, strict=True)):
        assert isinstance(own, Faces)
        stations.append(_station(interface, own, index, bodies[interface.slave[0]], n))
    return joined(stations, interfaces, {}, n, dimension=3)


def _station(
    interface: Interface, faces: Faces, index: int, dofs: EquilibriumDofs, n: int
) -> Station:
    """Return three points per face, the first corners of all faces first."""
    area, _ = face_geometry(dofs.body.mesh, faces.slave)
    nodes = dofs.facet_nodes(faces.slave).ravel()
    return Station(
        position=face_corners(dofs.body.mesh, faces.slave).reshape(3, -1).T,
        normal=np.tile(faces.normal.T, (3, 1)),
        moving=np.stack([nodes, np.full_like(nodes, -1)], axis=1),
        weights=np.tile(area / 3, 3),
        interface=np.full(nodes.size, index),
        laws=laws_of(interface, dofs.strength, nodes.size),
        axes=selected(nodes, n, 3),
    )


def static_free_basis(
    bodies: Mapping[str, EquilibriumDofs],
    supports: Sequence[Fix],
    footings: Sequence[Footing],
) -> Sparse:
    """Return all multipliers and speeds of footings from the free ones, shape (n, free).

    Speeds are last. A multiplier of tractions that are linear on a face follows its support by the
    weights of these: at corner a of a face ``(V_a + sum V)/4`` of the velocities V at its corners
    (T91).

    Raises:
        InputError: a footing that its supports, or another footing, keep from moving.
    """
    free, driven = [], []
    names = speed_names(footings)
    for name, dofs in bodies.items():
        asked = face_conditions(dofs.body, supports, footings, name)
        nodes = dofs.facet_nodes(asked.nodes) - dofs.first_node
        corner = face_corners(dofs.body.mesh, asked.nodes)
        # The same weights give the motion at each corner of a face for linear motions.
        own = [
            moved_along(asked.directions, asked.footing, corner[:, end], footings)
            for end in range(3)
        ]
        wanted = np.concatenate([(one + sum(own)) / 4 for one in own])
        directions = np.tile(asked.directions, (3, 1))
        node_dofs: Ints = np.arange(dofs.count).reshape(-1, 3).T
        parts = flowing_between_nodes(nodes.ravel(), directions, wanted, node_dofs, names)
        free.append(parts[0])
        driven.append(parts[1])
    first = hstack([block_diag(free, format="csr"), vstack(driven)], format="csr")
    count = len(names)
    speeds = hstack([csr_matrix((count, first.shape[1] - count)), eye_array(count, format="csr")])
    return csr_matrix(vstack([first, speeds], format="csr"))
