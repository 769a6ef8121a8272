"""Tractions on faces of equilibrium tetrahedra that touch obstacles (T93)."""

from collections.abc import Mapping, Sequence

import numpy as np

from lacore.bodies.continuum.solid.faces import face_geometry
from lacore.bounds.equilibrium import EquilibriumDofs
from lacore.bounds.static_contact import selected
from lacore.contact.faces import Faces
from lacore.contact.interfaces import Interface
from lacore.contact.laws import laws_of
from lacore.contact.rows import ContactPoints, Station, joined
from lacore.contact.touching import Touching
from lacore.meshes.solid.faces import face_corners
from lacore.program import ContactRows


def face_tractions(
    interfaces: Sequence[Interface],
    touching: Sequence[Touching],
    bodies: Mapping[str, EquilibriumDofs],
    n: int,
) -> tuple[ContactRows, ContactPoints]:
    """Tractions at the corners of faces: linear between, they obey the convex law there too."""
    stations = []
    for index, (interface, own) in enumerate(zip(interfaces, touching, strict=True)):
        assert isinstance(own, Faces)
        stations.append(_station(interface, own, index, bodies[interface.slave[0]], n))
    return joined(stations, interfaces, {}, n, dimension=3)


def _station(
    interface: Interface, faces: Faces, index: int, dofs: EquilibriumDofs, n: int
) -> Station:
    """Three points a face, the first corners of all first."""
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
