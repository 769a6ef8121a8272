"""Contact of tools along a path: control values of bodies, and corners of tools on their edges.

Normals are those of the tool where the step is solved, distances those where it begins, so that
``gap + dt (u - v).n >= 0`` is of second order for tools that turn and for curved faces, and exact
for flat faces that do not turn (T28).
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse import csr_matrix

from lacore.assembly.unknowns import Unknowns
from lacore.model.bodies.any_body import PlaneBody
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks.dofs import RigidDofs
from lacore.model.bodies.blocks.rigid_blocks import RigidBlocks
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.conditions.loads import Load, PointForce
from lacore.model.contact.laws import Laws
from lacore.model.contact.obstacles import Obstacle, Plane, Shape
from lacore.numerics.arrays import Bools, Floats
from lacore.paths.configuration import Configuration
from lacore.paths.contact.approach import obstacle_station
from lacore.paths.contact.outlines import Outline, outline
from lacore.paths.contact.pairs import Side
from lacore.paths.contact.stations import Station
from lacore.paths.tools.carrier import PART, corners_of, inner_corners

_INSIDE = 0.02  # of an edge: a vertex of it that is closer to a corner is in contact with it
_SAME = 1 - 1e-9  # cosine between normals of one line
_DEEP = 0.1  # of the body size: what is deeper has another part of the body in between


def face_stations(
    obstacles: tuple[Sequence[Obstacle], Sequence[Obstacle]],
    bodies: tuple[Mapping[str, PlaneBody], Mapping[str, PlaneBody]],
    unknowns: Unknowns,
    begin: Configuration,
) -> tuple[list[Station], list[Station]]:
    """Return contact with rigid faces, of control values of bodies and of corners.

    Args:
        obstacles: Faces at the start of the step, and where it is solved.
        bodies: Deformable bodies at these configurations.
        unknowns: Unknowns of the problem where it is solved.
        begin: Configuration at the start of the step.
    """
    faces: list[Station] = []
    corners: list[Station] = []
    n = unknowns.n
    for first, now in zip(*obstacles, strict=True):
        dofs = unknowns.continua[first.body]
        tool = None if first.carrier is None else unknowns.blocks[first.carrier]
        station = obstacle_station(first, dofs, n, begin)
        if tool is not None:
            station = carried_station(first, station, now.shape, tool, n)
        if corners_of(first.shape).size:
            side = Side.of(first.body, bodies[1][first.body], first.where, "Tool.touches")
            sides = (outline(side, bodies[0]), outline(side, bodies[1]))
            station, at_vertex = cornered(station, first, now.shape, sides)
            corners.append(corner_station(first, now.shape, sides, ~at_vertex, dofs, tool, n))
        faces.append(station)
        corners += inner_stations(first, now.shape, station, dofs, tool, begin, n)
    return faces, corners


def carried_station(
    own: Obstacle, station: Station, now: Shape, tool: RigidDofs[RigidBlocks], n: int
) -> Station:
    """Control values of the edges of a body against a tool.

    Args:
        own: the face of the tool.
        station: of the face where the step begins, as if it were at rest.
        now: the shape where the step is solved.
        tool: its unknowns there.
        n: unknowns.
    """
    assert own.carrier is not None
    places = station.places.T
    x, y = tool.velocity_rows(np.zeros(places.shape[1], dtype=np.int64), places, n)
    return replace(
        station,
        bodies=(own.body, own.carrier),
        normals=now.normal(places).T,
        x=csr_matrix(station.x - x),
        y=csr_matrix(station.y - y),
        moving=np.column_stack([station.moving[:, 0], np.zeros(places.shape[1], np.int64)]),
    )


def cornered(
    station: Station, own: Obstacle, now: Shape, sides: tuple[Outline, Outline]
) -> tuple[Station, Bools]:
    """Control values with the normal of the body at sharp corners of a face.

    A corner has no normal of its own. Against the mean of its two lines, the body would slide off
    the corner, which would then cut into an edge.

    Args:
        station: of all control values, against the closest lines.
        own: the face where the step begins.
        now: its shape where the step is solved.
        sides: the side of the body where the step begins, and where it is solved.

    Returns:
        The control values, and at which corners a vertex has such a normal.
    """
    ends = [np.concatenate([side.curves.start, side.curves.end], axis=1) for side in sides]
    outward = np.concatenate(
        [sides[1].normal(np.full(sides[1].edges.size, s)) for s in (0.0, 1.0)], axis=1
    )
    near = _INSIDE * np.tile(sides[1].lengths, 2)
    normals, gaps = station.normals.copy(), station.gaps.copy()
    found = []
    for first, here in zip(corners_of(own.shape).T, corners_of(now).T, strict=True):
        at = np.linalg.norm(ends[1] - here[:, None], axis=0) <= near
        reach = float(near[at].min(initial=np.inf))
        away = np.linalg.norm(station.places - here, axis=1)
        # A vertex that is closer to a line than to the corner has the normal of the line.
        rows = at.any() & (away <= reach) & (np.abs(gaps) >= _SAME * away - own.near)
        found.append(bool(rows.any()))
        if found[-1]:
            normals[rows] = _within_corner(-outward[:, at].sum(axis=1), now, here, reach)
            before = ends[0][:, at].mean(axis=1) - first
            gaps[rows] = np.maximum(normals[rows] @ before, 0.0)
    return replace(station, normals=normals, gaps=gaps, away=gaps > own.near), np.array(found)


def _within_corner(normal: Floats, shape: Shape, corner: Floats, reach: float) -> Floats:
    """The unit normal between those of the two lines of a corner that is closest to a direction."""
    bisector = shape.normal(corner[:, None])[:, 0]
    along = np.array([-bisector[1], bisector[0]])
    inside = np.stack([along - bisector, -along - bisector], axis=1)
    lines = shape.normal(corner[:, None] + reach * inside)
    unit = normal / np.linalg.norm(normal)
    if unit @ bisector >= lines[:, 0] @ bisector:
        return np.asarray(unit)
    return np.asarray(lines[:, int(np.argmax(unit @ lines))])


def inner_stations(
    own: Obstacle,
    now: Shape,
    station: Station,
    dofs: BodyDofs,
    tool: RigidDofs[RigidBlocks] | None,
    begin: Configuration,
    n: int,
) -> list[Station]:
    """Control values in inner corners of a face, against the line that `station` leaves out.

    Args:
        own: the face where the step begins.
        now: its shape where the step is solved.
        station: of its control values, against the closest lines.
        dofs: of the body.
        tool: that carries the face; None of a face at rest.
        begin: where the step begins.
        n: unknowns.
    """
    found = []
    for first, here in zip(inner_corners(own.shape), inner_corners(now), strict=True):
        away = np.linalg.norm(station.places - here.place, axis=1)
        within = station.normals @ here.bisector > _SAME * (here.normals[0] @ here.bisector)
        near = (away < first.reach) & within
        there = station.normals @ here.normals.T > _SAME
        for side in (0, 1):
            line = Plane.through(first.place, first.normals[side])
            more = obstacle_station(replace(own, shape=line), dofs, n, begin)
            if tool is not None:
                moved = Plane.through(here.place, here.normals[side])
                more = carried_station(own, more, moved, tool, n)
            found.append(more.take(near & ~there[:, side]))
    return found


def corner_station(
    own: Obstacle,
    now: Shape,
    sides: tuple[Outline, Outline],
    chosen: Bools,
    dofs: BodyDofs,
    tool: RigidDofs[RigidBlocks] | None,
    n: int,
) -> Station:
    """Sharp corners of a face that stand before, or on, edges of a body.

    Control values of the body do not see a corner between two of its vertices.

    Args:
        own: the face where the step begins.
        now: its shape where the step is solved.
        sides: the side of the body where the step begins, and where it is solved.
        chosen: corners at which no vertex is in contact, see `cornered`.
        dofs: of the body there.
        tool: that carries the face; None of a face at rest.
        n: unknowns.
    """
    first, here = (corners_of(shape) for shape in (own.shape, now))
    pairs = {k: _edge_below(sides[1], here[:, k]) for k in np.flatnonzero(chosen).tolist()}
    found = {k: pair for k, pair in pairs.items() if pair is not None}
    kept = np.array(list(found), dtype=np.int64)
    edge = np.array([pair[0] for pair in found.values()], dtype=np.int64)
    share = np.array([pair[1] for pair in found.values()], dtype=float)
    there, on = (side.take(edge) for side in sides)
    away = first[:, kept] - there.at(share)
    gap = np.sum(there.normal(share) * away, axis=0)
    x, y = dofs.velocity_rows(on.edges, on.at(share), n)
    moving = np.full((kept.size, 2), [0, -1 if tool is None else 0])
    if tool is not None:
        u, v = tool.velocity_rows(moving[:, 1], here[:, kept], n)
        x, y = csr_matrix(x - u), csr_matrix(y - v)
    station = Station(
        name=own.name,
        bodies=(own.body,) if own.carrier is None else (own.body, own.carrier),
        places=on.at(share).T,
        normals=-on.normal(share).T,
        weights=on.lengths / 3,
        gaps=gap,
        laws=Laws(np.full(kept.size, own.law.coefficient), *np.zeros((3, kept.size))),
        away=gap > own.near,
        x=csr_matrix(x),
        y=csr_matrix(y),
        moving=moving,
    )
    return station.take(gap >= -_DEEP * own.size)


def driving(
    rigid: Mapping[str, BlockAssembly], motions: Mapping[str, Floats], tools: Iterable[str]
) -> list[Load]:
    """Return the reference load that drives the named tools, or no load if none of them moves."""
    moving = [name for name in tools if name in motions and np.any(motions[name])]
    return [_drive(name, rigid[name], motions[name]) for name in moving[:1]]


def _drive(name: str, block: BlockAssembly, motion: Floats) -> PointForce:
    """A force on a tool where it is, whose power per travel is 1."""
    x, y, turn = motion.tolist()
    if x or y:
        size = x * x + y * y
        return PointForce(name, PART, (x / size, y / size))
    corner = block.polygons[PART][0]
    a, b = (corner - block.centroid[:, 0]).tolist()
    size = turn * (a * a + b * b)
    return PointForce(name, tuple(corner.tolist()), (-b / size, a / size))


def _edge_below(side: Outline, place: Floats) -> tuple[int, float] | None:
    """The edge that a corner stands before, and where on it; None beyond the ends of all edges."""
    s = side.closest(np.repeat(place[:, None], side.edges.size, axis=1))
    length = np.linalg.norm(side.at(np.clip(s, 0.0, 1.0)) - place[:, None], axis=0)
    nearest = int(np.argmin(length))
    return (nearest, float(s[nearest])) if 0.0 <= s[nearest] <= 1.0 else None
