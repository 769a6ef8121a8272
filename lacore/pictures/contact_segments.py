"""Contact by segments, for pictures: mean tractions and velocities, and both sides."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from lacore.assembly.discretisation import Discretisation
from lacore.limit.state import LimitState
from lacore.model.bodies.any_body import Dofs
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks.dofs import RigidDofs
from lacore.model.contact.controls import controls, segment_curves
from lacore.model.contact.obstacles import Obstacle
from lacore.model.contact.rows import moving_sides
from lacore.model.contact.segments import Segments
from lacore.numerics.arrays import Floats, Ints

_MOVES = 1e-3  # by the largest velocity: visible slip or opening
_SAME = 1e-6  # by the extent of all contact, and by unit normals


@dataclass(frozen=True)
class SegmentedContact:
    """One interface, or all joints of an assembly, on its k straight segments.

    Attributes:
        name: name of the interface, or of the assembly.
        segments: the segments; the edges of joints are -1.
        sides: unknowns of slave and master with the parts for `Dofs.velocity_rows`; obstacles are
            not included.
        t_n, t_t: mean tractions on the slave, Pa, shape (k,); `t_t` along `tangent`.
        u_n, u_t: mean relative velocities of the slave, m/s, shape (k,).
        kind: ``stick``, ``slip`` or ``open``, shape (k,); along a path edges that are partly away
            are open.
    """

    name: str
    segments: Segments
    sides: tuple[tuple[Dofs, Ints], ...]
    t_n: Floats
    t_t: Floats
    u_n: Floats
    u_t: Floats
    kind: np.ndarray

    @property
    def tangent(self) -> Floats:
        """The normals turned by +90 degrees, shape (2, k)."""
        return np.stack([-self.segments.normal[1], self.segments.normal[0]])

    @property
    def length(self) -> float:
        """Length of all segments, m."""
        along = self.segments.end - self.segments.start
        return float(np.linalg.norm(along, axis=0).sum())

    @property
    def deforms(self) -> bool:
        """Whether a side is a continuum that touches along edges."""
        return not self.pointwise and any(dofs.body.deforms for dofs, _ in self.sides)

    @property
    def pointwise(self) -> bool:
        """Whether a side is the nodes of a frame."""
        return any(dofs.body.pointwise for dofs, _ in self.sides)

    @property
    def coarse_edges(self) -> Ints:
        """Edge of each segment, on the continuum with fewer edges there.

        Tractions oscillate between the segments of two meshes; their means over an edge do not.
        """
        edges = (self.segments.slave, self.segments.master)
        meshed = [
            own for own, (dofs, _) in zip(edges, self.sides, strict=False) if dofs.body.deforms
        ]
        return min(meshed or edges[:1], key=lambda own: np.unique(own).size)

    def moved(self, state: LimitState, stretch: float, along: Floats) -> list[Floats]:
        """Return the points at shares `along` of the segments, displaced with each side.

        The shape is (k, points, 2). An obstacle does not move. `stretch` is in s.
        """
        curves = segment_curves(self.segments, self.sides)
        points = np.stack([curves.at(share) for share in along], axis=2)
        flat = points.reshape(2, -1)
        result = []
        for dofs, parts in self.sides:
            velocity = _velocity(state, dofs, np.repeat(parts, along.size), flat)
            result.append((flat + stretch * velocity).reshape(points.shape).transpose(1, 2, 0))
        if len(result) == 1:
            result.append(points.transpose(1, 2, 0))
        return result


def segmented_contacts(
    state: LimitState, fastest: float
) -> tuple[list[SegmentedContact], list[SegmentedContact]]:
    """Return interfaces, in their order, and joints, one entry per assembly with joints.

    Args:
        state: a state with a point.
        fastest: largest velocity, m/s, the scale for visible slip and opening.
    """
    d = state.discretisation
    dofs: dict[str, Dofs] = {**d.continua, **d.assemblies, **d.frames}
    interfaces = [
        _approaching(state, index, obstacle, fastest)
        for index, obstacle in enumerate(d.points.obstacles)
    ]
    joints = []
    for index, interface in enumerate(d.problem.interfaces):
        if interface.bonded:
            continue
        segments = d.problem.segments[index]
        meeting = zip(interface.sides, segments.edges, strict=False)
        sides = [(dofs[name], dofs[name].parts(edges)) for (name, _), edges in meeting]
        number = np.full(segments.slave.size, index)
        rows = _control_points(d, segments, sides, number)
        interfaces.append(_read(state, interface.name, segments, sides, rows, fastest))
    first = len(d.problem.interfaces)
    for name, rigid in d.assemblies.items():
        own = rigid.body.joints
        if not own.count:
            continue
        edges = np.full(own.count, -1)
        segments = Segments(edges, edges, own.start, own.end, own.normal)
        sides = [(rigid, own.slave), (rigid, own.master)]
        number = first + np.arange(own.count)
        rows = _control_points(d, segments, sides, number)
        joints.append(_read(state, name, segments, sides, rows, fastest))
        first += own.count
    return interfaces, joints


@dataclass(frozen=True)
class RigidSide:
    """Contact points of one interface, or of all joints of an assembly, that act on rigid blocks.

    Attributes:
        side: 0 where the blocks are slaves, 1 where they are masters.
        dofs: unknowns of the assembly.
        points, blocks: contact points, and the block of `dofs` at each, shape (k,).
    """

    side: int
    dofs: RigidDofs[BlockAssembly]
    points: Ints
    blocks: Ints


def rigid_sides(d: Discretisation) -> Iterator[RigidSide]:
    """Yield the sides of contact points that are rigid blocks."""
    rows, first = d.full.contact, len(d.problem.interfaces)
    for name, dofs in d.assemblies.items():
        joints = dofs.body.joints
        own = (rows.interface >= first) & (rows.interface < first + joints.count)
        points = np.flatnonzero(own)
        for side, blocks in enumerate((joints.slave, joints.master)):
            yield RigidSide(side, dofs, points, blocks[rows.interface[points] - first])
        first += joints.count
        for index, interface in enumerate(d.problem.interfaces):
            for side, (touching, _) in enumerate(interface.sides):
                if touching != name:
                    continue
                points = np.flatnonzero(rows.interface == index)
                columns = rows.normal[points][:, dofs.offset : dofs.offset + dofs.count]
                # A normal velocity depends on u_x or u_y of its block, and on no other block.
                blocks = columns.indices[columns.indptr[:-1]].astype(np.int64) // 3
                yield RigidSide(side, dofs, points, blocks)


def _read(
    state: LimitState,
    name: str,
    segments: Segments,
    sides: Sequence[tuple[Dofs, Ints]],
    rows: Ints,
    fastest: float,
) -> SegmentedContact:
    """Return the means over the contact points of segments, `rows` of shape (copies, k)."""
    table, found = state.reactions, rows >= 0
    count = np.maximum(found.sum(axis=0), 1)

    def total(column: str) -> Floats:
        # The last one is for segments without a point.
        values = np.append(table[column].to_numpy(), 0.0)
        return np.asarray(values[rows].sum(axis=0))

    # A point held by supports is not a contact point: it is at rest, and its reaction unknown.
    u_n, u_t = total("u_n") / len(rows), total("u_t") / len(rows)
    lead = np.append(state.discretisation.full.contact.lead, 0.0)
    parting = u_n + lead[rows].mean(axis=0)
    rest = _MOVES * fastest
    return SegmentedContact(
        name=name,
        segments=segments,
        sides=tuple(sides),
        t_n=total("t_n") / count,
        t_t=total("t_t") / count,
        u_n=u_n,
        u_t=u_t,
        kind=np.select([parting > rest, np.abs(u_t) > rest], ["open", "slip"], "stick"),
    )


def _approaching(
    state: LimitState, index: int, obstacle: Obstacle, fastest: float
) -> SegmentedContact:
    """Return contact along a path: edges with a point that touches the plane within the step.

    The segments are the edges projected onto the plane; one that is still upright has no length.
    """
    d, table = state.discretisation, state.reactions
    dofs, facets = d.continua[obstacle.body], obstacle.facets
    curves = dofs.curves(facets)
    values = [curves.start, curves.end, 2 * curves.middle - (curves.start + curves.end) / 2]

    def key(place: Floats, number: Ints) -> Floats:
        return np.column_stack([place / obstacle.size, number])

    tree = cKDTree(key(d.points.position, d.full.contact.interface))
    number = np.full(facets.size, index)
    wanted = np.stack([key(place.T, number) for place in values])
    _, rows = tree.query(wanted, distance_upper_bound=_SAME)
    rows = np.where(rows < len(table), rows, -1)
    shut = np.append((table["state"] != "open").to_numpy(), False)
    near = shut[rows].any(axis=0)
    facets, rows = facets[near], rows[:, near]
    face = obstacle.shape
    start, end = (
        ends[:, near] - face.normal(ends[:, near]) * face.distance(ends[:, near])
        for ends in (curves.start, curves.end)
    )
    normal = face.normal((start + end) / 2)
    segments = Segments(facets, np.full(facets.size, -1), start, end, normal)
    return _read(state, obstacle.name, segments, [(dofs, facets)], rows, fastest)


def _control_points(
    d: Discretisation,
    segments: Segments,
    sides: Sequence[tuple[Dofs, Ints]],
    number: Ints,
) -> Ints:
    """Return the contact points of segments, (copies, k): ends, and middles of quadratic jumps.

    A node of a frame is one point. The value is -1 if a support holds the point. The mean over the
    copies is that of the field (T28).
    """
    start, end = segments.start, segments.end
    size = float(np.ptp(np.concatenate([start, end], axis=1), axis=1).max()) or 1.0
    moving = moving_sides(sides, number.size)

    def key(place: Floats, normal: Floats, number: Ints, moving: Ints) -> Floats:
        return np.column_stack([place.T / size, normal.T, number, moving])

    points, rows = d.points, d.full.contact
    tree = cKDTree(key(points.position.T, points.normal.T, rows.interface, points.moving))
    stands = controls(segments, sides)
    wanted = [key(stand.place, stand.normal, number, moving) for stand in stands]
    _, found = tree.query(np.stack(wanted), distance_upper_bound=_SAME)
    return np.where(found < rows.count, found, -1)


def _velocity(state: LimitState, dofs: Dofs, parts: Ints, points: Floats) -> Floats:
    """Return the velocity of parts of a body at points of shape (2, k), m/s, shape (2, k)."""
    u = state.point.velocity if state.point is not None else np.zeros(0)
    return np.stack([rows @ u for rows in dofs.velocity_rows(parts, points, u.size)])
