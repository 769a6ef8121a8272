"""Contact points: rows of normal and tangential velocity on the segments of interfaces (T28).

They are at the Bernstein control values of the velocity jump on each segment, so that ``u_n >= 0``
holds along all of it and frozen friction dissipation is over-estimated: for a quadratic jump the
ends and ``2 u_mid - (u_start + u_end)/2``, with weights L/3 each; for the linear jump between rigid
blocks the ends, with weights L/2. A node of a frame is one point of weight 1 m, so that its
tractions are forces. Polygons between three-dimensional blocks have points at their corners, with
weights of A divided by their number (T71); faces of tetrahedra at three corners or six control
values, A/3 or A/6 each (T93). Two bodies meet on the common refinement of their edges, so that
neither side is preferred. Control values that two segments share are one point.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import singledispatch

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.model.bodies.any_body import Dofs
from lacore.model.bodies.blocks.dofs import RigidDofs
from lacore.model.bodies.blocks.rigid_blocks import RigidBlocks
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.jumps import control_values
from lacore.model.bodies.continuum.solid.faces import face_geometry
from lacore.model.contact.controls import Controls, controls
from lacore.model.contact.faces import Faces
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.laws import Laws, laws_of
from lacore.model.contact.obstacles import Obstacle
from lacore.model.contact.patches import Patches
from lacore.model.contact.segments import Segments
from lacore.model.contact.touching import Touching, of_joints
from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.numerics.interleaving import interleaved
from lacore.program.kinematic import ContactRows
from lacore.reporting.showing import Compact

_SAME_NORMAL = 9  # digits to which the normals of two edges are compared
_SAME_PLACE = 1e-9  # by the extent of the contact
_ROUND_OFF = 1e-13  # by an entry of order one


@dataclass(frozen=True, repr=False)
class ContactPoints(Compact):
    """Geometry of contact points, for results and pictures.

    Attributes:
        position, normal: shape (m, d); `normal` from the master into the slave.
        moving: numbers of the continuously moving parts of the slave and of the master, see
            `BodyDofs.moving`; an obstacle is -1, shape (m, 2).
        names: names of the interfaces and joints, numbered by `ContactRows.interface`.
        gap: along a path, distances from the obstacle at the beginning of the step, m, shape (m,);
            None: all touch.
        obstacles: obstacles of a path, the first of `names`; else empty.
        met: along a path, the slave of each of `names`, and its master if that is a body.
    """

    position: Floats
    normal: Floats
    moving: Ints
    names: tuple[str, ...]
    gap: Floats | None = None
    obstacles: tuple[Obstacle, ...] = ()
    met: tuple[tuple[str, ...], ...] = ()

    def kept(self, mask: Bools | Ints) -> "ContactPoints":
        """Return the points of a mask of shape (m,), or of numbers, in their order."""
        arrays = (self.position[mask], self.normal[mask], self.moving[mask])
        gap = None if self.gap is None else self.gap[mask]
        return ContactPoints(*arrays, self.names, gap, self.obstacles, self.met)


@dataclass(frozen=True, repr=False)
class Station(Compact):
    """Contact points of one interface, or of all joints of an assembly.

    Attributes:
        position, normal, moving: see `ContactPoints`.
        weights, interface: see `ContactRows`.
        laws: friction laws.
        axes: rows of the velocity of the slave against the master along x, y (and z), each of
            shape (m, n).
    """

    position: Floats
    normal: Floats
    moving: Ints
    weights: Floats
    interface: Ints
    laws: Laws
    axes: tuple[Sparse, ...]


def contact_rows(
    interfaces: Sequence[Interface],
    segments: Sequence[Touching],
    bodies: Mapping[str, Dofs],
    jointed: Mapping[str, RigidDofs[RigidBlocks]],
    n: int,
    dimension: int = 2,
) -> tuple[ContactRows, ContactPoints]:
    """Return the contact rows of all interfaces and joints for n unknowns, and their points.

    Args:
        interfaces: interfaces of a problem, with their effective friction.
        segments: segments of each, see `Problem.segments`.
        bodies: unknowns of all bodies.
        jointed: unknowns of the bodies with joints.
        n: number of unknowns.
        dimension: dimension of the problem.
    """
    stations = [
        interface_station(interface, own, index, bodies, n)
        for index, (interface, own) in enumerate(zip(interfaces, segments, strict=True))
        if not interface.bonded
    ]
    return joined(stations, interfaces, jointed, n, dimension)


def joined(
    stations: Sequence[Station],
    interfaces: Sequence[Interface],
    jointed: Mapping[str, RigidDofs[RigidBlocks]],
    n: int,
    dimension: int = 2,
) -> tuple[ContactRows, ContactPoints]:
    """Return the rows of the stations of interfaces and, numbered after them, of all joints."""
    stations, names = _with_joints(stations, interfaces, jointed, n)
    none = np.zeros((0, dimension))
    normal = np.concatenate([none, *(part.normal for part in stations)])
    axes = [
        vstack([csr_matrix((0, n)), *(part.axes[axis] for part in stations)], format="csr")
        for axis in range(dimension)
    ]

    def every(values: Sequence[Floats]) -> Floats:
        return np.concatenate([np.zeros(0), *values])

    numbers = [np.zeros(0, dtype=np.int64), *(part.interface for part in stations)]
    tension = every([part.laws.tension for part in stations])
    first, *second = (_along(axis, axes) for axis in tangents(normal))
    rows = ContactRows(
        normal=_along(normal, axes),
        tangential=interleaved(first, 1, second[0], 1) if second else first,
        tangent_dim=1 + len(second),
        weights=every([part.weights for part in stations]),
        coefficient=every([part.laws.coefficient for part in stations]),
        limit=every([part.laws.limit for part in stations]),
        dilatancy=every([part.laws.dilatancy for part in stations]),
        interface=np.concatenate(numbers),
        tension=tension if tension.any() else None,
    )
    position = np.concatenate([none, *(part.position for part in stations)])
    nothing = np.zeros((0, 2), dtype=np.int64)
    moving = np.concatenate([nothing, *(part.moving for part in stations)])
    return rows, ContactPoints(position, normal, moving, tuple(names))


def _with_joints(
    stations: Sequence[Station],
    interfaces: Sequence[Interface],
    jointed: Mapping[str, RigidDofs[RigidBlocks]],
    n: int,
) -> tuple[list[Station], list[str]]:
    """Return the stations of interfaces and joints, and the names of both."""
    every, names = list(stations), [interface.name for interface in interfaces]
    for name, dofs in jointed.items():
        if dofs.body.joints.count:
            every.append(_joints(dofs, len(names), n))
            names += [f"{name}: {joint}" for joint in dofs.body.joint_names]
    return every, names


def _along(direction: Floats, axes: Sequence[Sparse]) -> Sparse:
    """Return the rows of the velocity along a direction at each point, (m, d)."""
    parts = [own.multiply(part[:, None]) for own, part in zip(axes, direction.T, strict=True)]
    rows = csr_matrix(sum(parts[1:], parts[0]))
    rows.data[np.abs(rows.data) < _ROUND_OFF] = 0.0
    rows.eliminate_zeros()
    return rows


def tangents(normal: Floats) -> tuple[Floats, ...]:
    """Return unit vectors orthogonal to normals (m, d), (m, d) each: one in the plane, else two.

    In the plane it is the normal rotated by +90 degrees; in three dimensions one of them is also
    normal to an axis.
    """
    if normal.shape[1] == 2:
        return (np.stack([-normal[:, 1], normal[:, 0]], axis=1),)
    axis = np.eye(3)[np.argmin(np.abs(normal), axis=1)]  # the axis that is least along the normal
    first = np.cross(axis, normal)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return first, np.cross(normal, first)


def interface_station(
    interface: Interface, segments: Touching, index: int, bodies: Mapping[str, Dofs], n: int
) -> Station:
    """Contact points of the interface with a number, on its segments or patches."""
    meeting = zip(interface.sides, segments.edges, strict=False)
    sides = [(bodies[name], bodies[name].parts(edges)) for (name, _), edges in meeting]
    count = segments.slave.size
    laws = laws_of(interface, min(dofs.strength for dofs, _ in sides), count)
    return _stations(segments, np.full(count, index), laws, sides, n)


def _joints(dofs: RigidDofs[RigidBlocks], first: int, n: int) -> Station:
    joints = dofs.body.joints
    laws = Laws(*dofs.body.joint_terms)
    number, where = first + np.arange(joints.count), of_joints(joints)
    sides = [(dofs, joints.slave), (dofs, joints.master)]
    if crushed := dofs.crushed(n):
        assert isinstance(where, Patches)
        return _at_points(where, number, laws, sides, n, crushed)
    return _stations(where, number, laws, sides, n)


@singledispatch
def _stations(
    segments: Touching,
    interface: Ints,
    laws: Laws,
    sides: Sequence[tuple[Dofs, Ints]],
    n: int,
) -> Station:
    """Return the contact points on segments or patches.

    Args:
        segments: k segments, or patches.
        interface, laws: interface and law of each.
        sides: unknowns and parts of slave and master.
        n: number of unknowns.
    """
    raise TypeError(f"nothing touches along {type(segments).__name__}")


@_stations.register(Segments)
def _on_segments(
    segments: Segments, interface: Ints, laws: Laws, sides: Sequence[tuple[Dofs, Ints]], n: int
) -> Station:
    return _standing(controls(segments, sides), interface, laws, sides, n)


@_stations.register(Patches)
def _on_patches(
    patches: Patches, interface: Ints, laws: Laws, sides: Sequence[tuple[Dofs, Ints]], n: int
) -> Station:
    return _at_points(patches, interface, laws, sides, n)


def _at_points(
    patches: Patches,
    interface: Ints,
    laws: Laws,
    sides: Sequence[tuple[Dofs, Ints]],
    n: int,
    crushed: Sequence[Sparse] = (),
) -> Station:
    """Return `_stations`, with the contribution of crushing to the jumps, (m, n) for each axis."""
    own = patches.patch
    stands = [Controls(patches.point, patches.normal[:, own], patches.weight)]
    corners = [(dofs, parts[own]) for dofs, parts in sides]
    return _standing(stands, interface[own], laws.at(own), corners, n, crushed)


@_stations.register(Faces)
def _on_faces(
    faces: Faces, interface: Ints, laws: Laws, sides: Sequence[tuple[Dofs, Ints]], n: int
) -> Station:
    (dofs, _) = sides[0]
    assert isinstance(dofs, BodyDofs)
    nodes = dofs.facet_nodes(faces.slave)  # shape (copies, faces): vertices, then middles of edges
    copies = len(nodes)
    owner = np.repeat(np.arange(faces.slave.size), copies)
    area, _ = face_geometry(dofs.body.mesh, faces.slave)
    places = dofs.nodes[:, nodes.T.ravel()]
    stand = Controls(places, faces.normal[:, owner], area[owner] / copies)
    kind = np.tile(np.arange(copies) // 3, faces.slave.size)
    axes = control_values(dofs, faces.slave, 0, n)
    moving = moving_sides(sides, faces.slave.size)
    return _merged(stand, owner, kind, moving, interface, laws, axes)


def _standing(
    stands: Sequence[Controls],
    interface: Ints,
    laws: Laws,
    sides: Sequence[tuple[Dofs, Ints]],
    n: int,
    crushed: Sequence[Sparse] = (),
) -> Station:
    """Return the control values of the jump; sides: unknowns and parts of slave and master."""
    values = jump_rows(stands, sides, n)
    if crushed:  # single points of three-dimensional blocks
        values = [[csr_matrix(a + b) for a, b in zip(values[0], crushed, strict=True)]]
    count, copies = interface.size, len(stands)
    kind = np.arange(count) if crushed else np.repeat(np.arange(copies) // 2, count)
    every = Controls(
        np.concatenate([stand.place for stand in stands], axis=1),
        np.concatenate([stand.normal for stand in stands], axis=1),
        np.concatenate([stand.weight for stand in stands]),
    )
    owner = np.tile(np.arange(count), copies)
    axes = [vstack(rows, format="csr") for rows in zip(*values, strict=True)]
    return _merged(every, owner, kind, moving_sides(sides, count), interface, laws, axes)


def _merged(
    stand: Controls,
    owner: Ints,
    kind: Ints,
    moving: Ints,
    interface: Ints,
    laws: Laws,
    axes: Sequence[Sparse],
) -> Station:
    """Return one point for control values that several segments or faces share.

    Args:
        stand: k control values.
        owner: segment or face of each, shape (k,).
        kind: values of different kinds are never merged, shape (k,).
        moving, interface, laws: values of segments or faces.
        axes: rows of the control values of u_x, u_y (and u_z), (k, n) each.
    """
    # any size will do for a single place
    size = float(np.ptp(stand.place, axis=1).max(initial=0.0)) or 1.0
    key = np.column_stack(
        [
            interface[owner],
            kind,
            moving[owner],
            np.round(stand.place.T / (_SAME_PLACE * size)),
            np.round(stand.normal.T, _SAME_NORMAL),
        ]
    )
    _, first, point = np.unique(key, axis=0, return_index=True, return_inverse=True)
    at = owner[first]
    return Station(
        position=stand.place[:, first].T,
        normal=stand.normal[:, first].T,
        moving=moving[at],
        weights=np.bincount(point.ravel(), stand.weight).astype(np.float64),
        interface=interface[at],
        laws=laws.at(at),
        axes=tuple(csr_matrix(csr_matrix(rows)[first]) for rows in axes),
    )


def jump_rows(
    stands: Sequence[Controls], sides: Sequence[tuple[Dofs, Ints]], n: int
) -> list[Sequence[Sparse]]:
    """Return rows of u_x, u_y, ... of the slave against the master, of each of `controls`.

    The shape is (k, n) each.
    """

    def jump(points: Floats) -> Sequence[Sparse]:
        own, *others = (dofs.velocity_rows(parts, points, n) for dofs, parts in sides)
        for other in others:
            own = tuple(csr_matrix(a - b) for a, b in zip(own, other, strict=True))
        return own

    values = [jump(stand.place) for stand in stands]
    if len(stands) > 2:
        values[2] = [m * 2.0 - (a + b) * 0.5 for a, b, m in zip(*values, strict=True)]
    return values


def moving_sides(sides: Sequence[tuple[Dofs, Ints]], count: int) -> Ints:
    """Return the continuously moving parts on both sides of segments, (count, 2); obstacles: -1."""
    moving = np.full((count, 2), -1, dtype=np.int64)
    for column, (dofs, parts) in enumerate(sides):
        moving[:, column] = dofs.moving(parts)
    return moving
