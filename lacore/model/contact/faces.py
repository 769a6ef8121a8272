"""Contact of tetrahedra with obstacles on whole faces, without unknowns."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.boundaries import boundary_facets
from lacore.model.bodies.continuum.solid.faces import face_geometry
from lacore.model.contact.interfaces import Interface
from lacore.model.meshes.solid.faces import face_corners
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact
from lacore.reporting.text import Quantity, text

_FACING = 1e-9  # round-off of unit normals


@dataclass(frozen=True, eq=False, repr=False)
class Faces(Compact):
    """Faces of a body that touch an obstacle.

    Attributes:
        slave: boundary faces, shape (k,).
        normal: unit vectors from the obstacle into the body, shape (3, k).
    """

    slave: Ints
    normal: Floats

    @property
    def edges(self) -> tuple[Ints, Ints]:
        """Edges of slave and master, as `Interface.sides`: an obstacle has -1."""
        return self.slave, np.full(self.slave.size, -1)


def obstacle_faces(interface: Interface, bodies: Mapping[str, Body], field: str) -> Faces:
    """Return the faces of an interface with an obstacle.

    Raises:
        InputError: an interface of two bodies, or faces that are not on the plane of the obstacle.
    """
    (name, where), *second = interface.sides
    if second:
        raise InputError(
            field,
            interface.name,
            "bodies of tetrahedra touch rigid obstacles, and no other body yet",
            "put a lacore.RigidObstacle in place of the stronger one, or mesh both as one body of"
            " two regions",
        )
    body = bodies[name]
    facets = boundary_facets(body.mesh, where, f"{field}.slave")
    _, outward = face_geometry(body.mesh, facets)
    plane = interface.face
    if plane is not None:
        corner = face_corners(body.mesh, facets)
        gap = plane.distance(corner.reshape(3, -1)).reshape(3, -1)
        end, worst = np.unravel_index(int(np.argmax(np.abs(gap))), gap.shape)
        if abs(gap[end, worst]) > body.allowed:
            raise InputError(
                field,
                interface.name,
                text(
                    "a corner of a face at {} is {} off the plane of its obstacle",
                    Quantity(tuple(corner[:, end, worst]), "m", ".6g"),
                    Quantity(gap[end, worst], "m", ".3g"),
                ),
                "move the plane, or name the faces that lie on it",
            )
        towards = np.sum(plane.normal(corner.mean(axis=1)) * outward, axis=0)
        if np.any(towards > -1 + _FACING):
            raise InputError(
                field,
                interface.name,
                "the body is behind the plane of its obstacle",
                "turn its normal, which points out of the obstacle towards the body",
            )
    return Faces(np.asarray(facets), -outward)
