"""Contact points: rows of normal and tangential velocity on the segments of interfaces (T28).

They stand at the Bernstein control values of the velocity jump on each segment, so that
``u_n >= 0`` holds along all of it and frozen friction dissipation is over-estimated: for a
quadratic jump the ends and ``2 u_mid - (u_start + u_end)/2``, weights L/3 each; for the linear
jump between rigid blocks the ends, weights L/2; a node of a frame is one point of weight 1 m, so
that its tractions are forces. Two bodies meet on the common refinement of their
edges, so that neither side is preferred. Control values that two segments share are one point.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.arrays import Bools, Floats, Ints, Sparse
from lacore.bodies.any_body import Dofs
from lacore.bodies.blocks.dofs import RigidDofs
from lacore.contact.controls import Controls, controls
from lacore.contact.interfaces import Interface
from lacore.contact.obstacles import Obstacle
from lacore.contact.segments import Segments
from lacore.errors import InputError
from lacore.program import ContactRows
from lacore.showing import Compact

_UNATTAINABLE = 100.0  # times the shear strength: control values may exceed it, not by this
_SAME_NORMAL = 9  # digits to which the normals of two edges count as one
_SAME_PLACE = 1e-9  # of the extent of the contact
_ROUND_OFF = 1e-13  # of an entry of order one


@dataclass(frozen=True, repr=False)
class ContactPoints(Compact):
    """Geometry of contact points, for results and pictures.

    Attributes:
        position, normal: shape (m, 2); `normal` from the master into the slave.
        moving: what moves continuously there of the slave and of the master, see
            `BodyDofs.moving`; an obstacle is -1, shape (m, 2).
        names: of the interfaces and joints that `ContactRows.interface` counts.
        gap: along a path, distances from the obstacle where the step begins, m, shape (m,); None:
            all touch.
        obstacles: the planes of a path, by `ContactRows.interface`; elsewhere none.
    """

    position: Floats
    normal: Floats
    moving: Ints
    names: tuple[str, ...]
    gap: Floats | None = None
    obstacles: tuple[Obstacle, ...] = ()

    def kept(self, mask: Bools | Ints) -> "ContactPoints":
        """Those of a mask of shape (m,), or of numbers, in their order."""
        arrays = (self.position[mask], self.normal[mask], self.moving[mask])
        gap = None if self.gap is None else self.gap[mask]
        return ContactPoints(*arrays, self.names, gap, self.obstacles)


@dataclass(frozen=True, repr=False)
class Laws(Compact):
    """Friction of segments or points, (k,) each: see `lacore.materials.friction.FrictionTerms`."""

    coefficient: Floats
    limit: Floats
    dilatancy: Floats
    tension: Floats

    def at(self, points: Ints) -> "Laws":
        """Those of some segments or points, by numbers."""
        own = (self.coefficient, self.limit, self.dilatancy, self.tension)
        return Laws(*(values[points] for values in own))


@dataclass(frozen=True, repr=False)
class Station(Compact):
    """Contact points of one interface, or of all joints of an assembly.

    Attributes:
        position, normal, moving: see `ContactPoints`.
        weights, interface: see `ContactRows`.
        laws: friction.
        x, y: rows of the velocity of the slave against the master, shape (m, n).
    """

    position: Floats
    normal: Floats
    moving: Ints
    weights: Floats
    interface: Ints
    laws: Laws
    x: Sparse
    y: Sparse


def contact_rows(
    interfaces: Sequence[Interface],
    segments: Sequence[Segments],
    bodies: Mapping[str, Dofs],
    jointed: Mapping[str, RigidDofs],
    n: int,
) -> tuple[ContactRows, ContactPoints]:
    """Contact rows of all interfaces and joints for n unknowns, and where they stand.

    Args:
        interfaces: of a problem, with the friction that counts.
        segments: of each, see `Problem.segments`.
        bodies: unknowns of all.
        jointed: of those bodies that have joints of their own.
        n: unknowns.
    """
    stations = [
        interface_station(interface, own, index, bodies, n)
        for index, (interface, own) in enumerate(zip(interfaces, segments, strict=True))
        if not interface.bonded
    ]
    return joined(stations, interfaces, jointed, n)


def joined(
    stations: Sequence[Station],
    interfaces: Sequence[Interface],
    jointed: Mapping[str, RigidDofs],
    n: int,
) -> tuple[ContactRows, ContactPoints]:
    """Rows of the stations of interfaces and, numbered after them, of all joints of blocks."""
    stations, names = list(stations), [interface.name for interface in interfaces]
    for name, dofs in jointed.items():
        if dofs.body.joints.slave.size:
            stations.append(_joints(dofs, len(names), n))
            names += [f"{name}: {joint}" for joint in dofs.body.joint_names]
    normal = np.concatenate([np.zeros((0, 2)), *(part.normal for part in stations)])
    x, y = (
        vstack([csr_matrix((0, n)), *(getattr(part, axis) for part in stations)], format="csr")
        for axis in ("x", "y")
    )

    def along(direction: Floats) -> Sparse:
        rows = csr_matrix(x.multiply(direction[:, :1]) + y.multiply(direction[:, 1:]))
        rows.data[np.abs(rows.data) < _ROUND_OFF] = 0.0
        rows.eliminate_zeros()
        return rows

    def every(values: Sequence[Floats]) -> Floats:
        return np.concatenate([np.zeros(0), *values])

    numbers = [np.zeros(0, dtype=np.int64), *(part.interface for part in stations)]
    tension = every([part.laws.tension for part in stations])
    rows = ContactRows(
        normal=along(normal),
        tangential=along(np.stack([-normal[:, 1], normal[:, 0]], axis=1)),
        tangent_dim=1,
        weights=every([part.weights for part in stations]),
        coefficient=every([part.laws.coefficient for part in stations]),
        limit=every([part.laws.limit for part in stations]),
        dilatancy=every([part.laws.dilatancy for part in stations]),
        interface=np.concatenate(numbers),
        tension=tension if tension.any() else None,
    )
    position = np.concatenate([np.zeros((0, 2)), *(part.position for part in stations)])
    none = np.zeros((0, 2), dtype=np.int64)
    moving = np.concatenate([none, *(part.moving for part in stations)])
    return rows, ContactPoints(position, normal, moving, tuple(names))


def interface_station(
    interface: Interface, segments: Segments, index: int, bodies: Mapping[str, Dofs], n: int
) -> Station:
    """Contact points of the interface with a number, on its segments."""
    meeting = zip(interface.sides, segments.edges, strict=False)
    sides = [(bodies[name], bodies[name].parts(edges)) for (name, _), edges in meeting]
    count = segments.slave.size
    laws = laws_of(interface, min(dofs.strength for dofs, _ in sides), count)
    return _stations(segments, np.full(count, index), laws, sides, n)


def laws_of(interface: Interface, strength: float, count: int) -> Laws:
    """Those of an interface at `count` places, between bodies that carry a shear `strength`, Pa."""
    law, most = interface.law.terms(), _UNATTAINABLE * strength
    if law.tension > most:
        raise InputError(
            "Interface.friction",
            interface.law,
            f"a tension of {law.tension:.4g} Pa, beside a shear strength of {strength:.4g} Pa in"
            " the bodies: nothing would ever open",
            f"give at most {most:.4g} Pa; lacore.BOND neither opens nor slips",
        )
    # Stick, where it is far beyond any shear stress that the bodies can carry.
    sticks = law.limit > most
    terms = (
        0.0 if sticks else law.coefficient,
        inf if sticks else law.limit,
        0.0 if sticks else law.dilatancy,
        law.tension,
    )
    return Laws(*(np.full(count, value) for value in terms))


def _joints(dofs: RigidDofs, first: int, n: int) -> Station:
    joints = dofs.body.joints
    nothing = np.full(joints.slave.size, -1)
    segments = Segments(nothing, nothing, joints.start, joints.end, joints.normal)
    laws = Laws(joints.coefficient, joints.limit, joints.dilatancy, joints.tension)
    number = first + np.arange(joints.slave.size)
    sides = [(dofs, joints.slave), (dofs, joints.master)]
    return _stations(segments, number, laws, sides, n)


def _stations(
    segments: Segments,
    interface: Ints,
    laws: Laws,
    sides: Sequence[tuple[Dofs, Ints]],
    n: int,
) -> Station:
    """Control values of the jump on segments; sides: slave and master, and which parts of them."""
    stands = controls(segments, sides)
    values = jump_rows(stands, sides, n)
    count, copies = interface.size, len(stands)
    position = np.concatenate([stand.place for stand in stands], axis=1)
    normal = np.concatenate([stand.normal for stand in stands], axis=1)
    weights = np.concatenate([stand.weight for stand in stands])
    moving = moving_sides(sides, count)
    size = float(np.ptp(position, axis=1).max(initial=0.0)) or 1.0  # any, for a single place
    key = np.column_stack(
        [
            np.tile(interface, copies),
            np.repeat(np.arange(copies) // 2, count),
            np.tile(moving, (copies, 1)),
            np.round(position.T / (_SAME_PLACE * size)),
            np.round(normal.T, _SAME_NORMAL),
        ]
    )
    key = key + 0.0  # no minus zero
    _, first, point = np.unique(key, axis=0, return_index=True, return_inverse=True)
    at = first % count if count else first
    return Station(
        position=position[:, first].T,
        normal=normal[:, first].T,
        moving=moving[at],
        weights=np.bincount(point.ravel(), weights).astype(np.float64),
        interface=interface[at],
        laws=laws.at(at),
        x=csr_matrix(vstack([rows[0] for rows in values], format="csr")[first]),
        y=csr_matrix(vstack([rows[1] for rows in values], format="csr")[first]),
    )


def jump_rows(
    stands: Sequence[Controls], sides: Sequence[tuple[Dofs, Ints]], n: int
) -> list[Sequence[Sparse]]:
    """Rows of u_x and u_y of the slave against the master, of each of `controls`, (k, n) each."""

    def jump(points: Floats) -> Sequence[Sparse]:
        own, *others = (dofs.velocity_rows(parts, points, n) for dofs, parts in sides)
        for other in others:
            own = (csr_matrix(own[0] - other[0]), csr_matrix(own[1] - other[1]))
        return own

    values = [jump(stand.place) for stand in stands]
    if len(stands) > 2:
        values[2] = [m * 2.0 - (a + b) * 0.5 for a, b, m in zip(*values, strict=True)]
    return values


def moving_sides(sides: Sequence[tuple[Dofs, Ints]], count: int) -> Ints:
    """What moves continuously on both sides of segments, shape (count, 2); an obstacle is -1."""
    moving = np.full((count, 2), -1, dtype=np.int64)
    for column, (dofs, parts) in enumerate(sides):
        moving[:, column] = dofs.moving(parts)
    return moving
