"""Contact of tools along a path: control values of bodies, and corners of tools on their edges.

Normals are those of the tool where the step is solved, distances those where it begins, so that
``gap + dt (u - v).n >= 0`` is of second order for tools that turn and for curved faces, and exact
for flat faces that do not turn (T28).
"""

from collections.abc import Mapping, Sequence
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
from lacore.numerics.arrays import Floats
from lacore.paths.configuration import Configuration
from lacore.paths.contact.approach import obstacle_station
from lacore.paths.contact.outlines import Outline, outline
from lacore.paths.contact.pairs import Side
from lacore.paths.contact.stations import Station
from lacore.paths.tools.carrier import PART, corners_of, inner_corners

_INSIDE = 0.02  # of an edge: closer to a vertex of it a corner adds nothing to the vertex
_SAME = 1 - 1e-9  # cosine between normals of one line
_DEEP = 0.1  # of the body size: what is deeper has another part of the body in between


def face_stations(
    obstacles: tuple[Sequence[Obstacle], Sequence[Obstacle]],
    bodies: tuple[Mapping[str, PlaneBody], Mapping[str, PlaneBody]],
    unknowns: Unknowns,
    begin: Configuration,
) -> tuple[list[Station], list[Station]]:
    """Contact with rigid faces: that of control values of bodies, and that of corners.

    Args:
        obstacles: the faces where the step begins, and where it is solved.
        bodies: those that deform, there.
        unknowns: of the problem where it is solved.
        begin: where the step begins.
    """
    faces: list[Station] = []
    corners: list[Station | None] = []
    n = unknowns.n
    for first, now in zip(*obstacles, strict=True):
        dofs = unknowns.continua[first.body]
        tool = None if first.carrier is None else unknowns.blocks[first.carrier]
        station = obstacle_station(first, dofs, n, begin)
        if tool is not None:
            station = carried_station(first, station, now.shape, tool, n)
        faces.append(station)
        corners += inner_stations(first, now.shape, station, dofs, tool, begin, n)
        own = (bodies[0][first.body], bodies[1][first.body])
        corners.append(corner_station(first, (first.shape, now.shape), own, dofs, tool, n))
    return faces, [own for own in corners if own is not None]


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
    shapes: tuple[Shape, Shape],
    bodies: tuple[PlaneBody, PlaneBody],
    dofs: BodyDofs,
    tool: RigidDofs[RigidBlocks] | None,
    n: int,
) -> Station | None:
    """Sharp corners of a face that stand before, or on, edges of a body; None of none.

    Control values of the body do not see a corner between two of its vertices.

    Args:
        own: the face.
        shapes, bodies: the face and the body where the step begins, and where it is solved.
        dofs: of the body there.
        tool: that carries the face; None of a face at rest.
        n: unknowns.
    """
    first, here = (corners_of(shape) for shape in shapes)
    if not here.shape[1]:
        return None
    side = Side.of(own.body, bodies[1], own.where, "Tool.touches")
    begin, now = (outline(side, {own.body: body}) for body in bodies)
    pairs = [_edge_below(now, place) for place in here.T]
    kept = [number for number, pair in enumerate(pairs) if pair is not None]
    if not kept:
        return None
    found = [pair for pair in pairs if pair is not None]
    edge, share = np.array([own[0] for own in found]), np.array([own[1] for own in found])
    there, on = begin.take(edge), now.take(edge)
    away = first[:, kept] - there.at(share)
    gap = np.sum(there.normal(share) * away, axis=0)
    deep = gap < -_DEEP * own.size
    x, y = dofs.velocity_rows(side.edges[edge], on.at(share), n)
    moving = np.full(edge.size, -1)
    if tool is not None:
        moving = np.zeros(edge.size, np.int64)
        u, v = tool.velocity_rows(moving, here[:, kept], n)
        x, y = csr_matrix(x - u), csr_matrix(y - v)
    count = int(np.sum(~deep))
    laws = (own.law.coefficient, 0.0, 0.0, 0.0)
    return Station(
        name=own.name,
        bodies=(own.body,) if own.carrier is None else (own.body, own.carrier),
        places=on.at(share).T[~deep],
        normals=-on.normal(share).T[~deep],
        weights=on.lengths[~deep] / 3,
        gaps=gap[~deep],
        laws=Laws(*(np.full(count, float(value)) for value in laws)),
        away=gap[~deep] > own.near,
        x=csr_matrix(x[~deep]),
        y=csr_matrix(y[~deep]),
        moving=np.column_stack([np.zeros(count, np.int64), moving[~deep]]),
    )


def driving(rigid: Mapping[str, BlockAssembly], motions: Mapping[str, Floats]) -> list[Load]:
    """The reference load by which tools of given motions are driven; none where none moves."""
    moving = [name for name, motion in motions.items() if np.any(motion)]
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
    """The edge that a corner stands before, and where on it; None before a vertex, or beside."""
    count = side.edges.size
    s = np.clip(side.closest(np.repeat(place[:, None], count, axis=1)), 0.0, 1.0)
    length = np.linalg.norm(side.at(s) - place[:, None], axis=0)
    nearest = int(np.argmin(length))
    if _INSIDE < s[nearest] < 1 - _INSIDE:
        return nearest, float(s[nearest])
    return None
