"""Loads on rigid blocks: which blocks carry them, where, and how much."""

from collections.abc import Callable, Sequence
from functools import singledispatch
from typing import TYPE_CHECKING, Protocol

import numpy as np
import shapely

from lacore.arrays import Floats, Ints
from lacore.conditions.body_forces import BodyForce
from lacore.conditions.footings import Footing, RigidFooting, Twist
from lacore.conditions.loads import Load, PointForce, Pressure, Traction
from lacore.conditions.water import PorePressure, StandingWater
from lacore.errors import InputError, suggest
from lacore.reporting import terms
from lacore.reporting.text import Term, text

if TYPE_CHECKING:
    from lacore.bodies.blocks.block_assembly import BlockAssembly

_BENT = 1e-9  # of the largest value: what is linear, up to round-off


class Named(Protocol):
    """What consists of blocks with names."""

    @property
    def names(self) -> tuple[str, ...]:
        """Of its blocks."""
        ...


class Placed(Named, Protocol):
    """Blocks that lie somewhere."""

    @property
    def centroid(self) -> Floats:
        """Of each, (d, B), m."""
        ...

    @property
    def allowed(self) -> float:
        """Distance up to which coordinates count as one, m."""
        ...


Carried = tuple[Ints, Floats, Floats]
"""Blocks (k,), points of attack (2, k) in m, forces (2, k) in N/m."""


@singledispatch
def carried(load: Load, body: "BlockAssembly") -> Carried:
    """What blocks carry of a load.

    Raises:
        InputError: a load that acts on no block, or on several; a footing.
    """
    raise TypeError(f"not a load: {type(load).__name__}")


@carried.register(Traction)
@carried.register(Pressure)
def _boundary(load: Traction | Pressure, body: "BlockAssembly") -> Carried:
    edges = body.outline(load.where, f"{type(load).__name__}.where")
    start, end = body.edges.start[:, edges], body.edges.end[:, edges]
    length = np.linalg.norm(end - start, axis=0)
    vectors = load.on(body.edges.normal[:, edges]) * length
    return body.edges.block[edges], (start + end) / 2, vectors


@carried.register(RigidFooting)
@carried.register(Twist)
def _footing(load: Footing, body: "BlockAssembly") -> Carried:
    raise refuse_footing(load)


def refuse_footing(load: Footing) -> InputError:
    """What is wrong with a footing on blocks."""
    return InputError(
        f"{type(load).__name__}.body", load.body, "its blocks are rigid already", "load the blocks"
    )


@carried.register(PorePressure)
@carried.register(StandingWater)
def _water(load: PorePressure | StandingWater, body: "BlockAssembly") -> Carried:
    raise refuse_water(load)


def refuse_water(load: PorePressure | StandingWater) -> InputError:
    """What is wrong with water on blocks."""
    return InputError(
        f"{type(load).__name__}.body",
        load.body,
        "rigid blocks, which have no pores, and whose edges are too long for a pressure that is"
        " linear along each",
        text(
            "load their edges by {}, part by part, or by {} in the centre of pressure",
            terms.PRESSURE,
            Term("a PointForce", 'load = "point-force"'),
        ),
    )


@carried.register(BodyForce)
def _volume(load: BodyForce, body: "BlockAssembly") -> Carried:
    blocks = named(body, load.where, "BodyForce.where")
    count = len(body.names)
    if load.piecewise_uniform:
        places = body.centroid[:, blocks]
        return blocks, places, load.at(places, blocks, count, "BodyForce") * body.area[blocks]
    triangles, owners = _triangles(body, blocks)
    corner = triangles.transpose(2, 1, 0)  # (2, 3, triangles)
    middle = (corner + np.roll(corner, -1, axis=1)) / 2  # of edges: exact of degree 2
    parts = np.tile(owners, 3)
    force = load.at(middle.reshape(2, -1), parts, count, "BodyForce").reshape(middle.shape)
    ends = load.at(corner.reshape(2, -1), parts, count, "BodyForce").reshape(middle.shape)
    bent = np.abs(ends + np.roll(ends, -1, axis=1) - 2 * force).max()
    if bent > _BENT * np.abs(ends).max():
        raise InputError(
            "BodyForce.vector",
            load.told,
            "is not linear in each block",
            text(
                "give {}",
                Term("a value for each block, or a lacore.Linear", "numbers, or at and gradient"),
            ),
        )
    u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = np.abs(u[0] * v[1] - u[1] * v[0]) / 2
    return parts, middle.reshape(2, -1), (force * area / 3).reshape(2, -1)


def _triangles(body: "BlockAssembly", blocks: Ints) -> tuple[Floats, Ints]:
    """Triangles of blocks, shape (t, 3, 2), m, and the block of each, shape (t,)."""
    names = [body.names[block] for block in blocks]
    cut = [
        shapely.get_parts(shapely.constrained_delaunay_triangles(shapely.Polygon(ring)))
        for ring in (body.polygons[name] for name in names)
    ]
    rings = shapely.get_coordinates(np.concatenate(cut)).reshape(-1, 4, 2)
    return rings[:, :3], np.repeat(blocks, [len(own) for own in cut])


@carried.register(PointForce)
def _point(load: PointForce, body: "BlockAssembly") -> Carried:
    def away(at: Floats) -> Floats:
        outlines = [shapely.Polygon(ring) for ring in body.polygons.values()]
        return np.asarray(shapely.distance(outlines, shapely.Point(at)))

    blocks, points = loaded_block(body, load, away)
    return blocks, points, np.reshape(np.asarray(load.vector, dtype=float), (2, 1))


def named(body: Named, where: str | tuple[str, ...] | None, field: str) -> Ints:
    """Numbers of blocks from their names; None: of all."""
    if where is None:
        return np.arange(len(body.names))
    if not isinstance(where, str | Sequence):
        fix = text("give a name, or a {} of names", Term("tuple", "list"))
        raise InputError(field, where, "no names of blocks", fix)
    number = {name: index for index, name in enumerate(body.names)}
    names = (where,) if isinstance(where, str) else tuple(where)
    for place, name in enumerate(names):
        if not isinstance(name, str) or name not in number:
            raise InputError(field, name, "no such block", suggest(str(name), number))
        if name in names[:place]:
            raise InputError(field, name, "this block is given twice", "give each block once")
    return np.array([number[name] for name in names], dtype=np.int64)


def loaded_block(
    body: Placed, load: PointForce, away: Callable[[Floats], Floats]
) -> tuple[Ints, Floats]:
    """The block that a point force acts on, and where, shapes (1,) and (d, 1).

    Args:
        body: the assembly.
        load: the force.
        away: distances of a place of shape (d,) from all blocks, m, (B,).

    Raises:
        InputError: a place on no block, or on several; a name of none.
    """
    if isinstance(load.at, str):
        block = named(body, load.at, "PointForce.at")
        if load.where not in (None, load.at):
            raise InputError(
                "PointForce.where", load.where, f"`at` names {load.at!r}", "leave `where` out"
            )
        return block, body.centroid[:, block]
    at = np.asarray(load.at, dtype=float)
    distance = away(at)
    blocks = np.flatnonzero(distance <= body.allowed)
    if load.where is not None:
        blocks = np.intersect1d(blocks, named(body, load.where, "PointForce.where"))
    names = [body.names[block] for block in blocks]
    if len(names) != 1:
        why = f"lies on the blocks {', '.join(names)}" if names else "lies on no block"
        nearest = body.names[int(np.argmin(distance))]
        fix = "say by `where` which one carries it" if names else f"the nearest is {nearest!r}"
        raise InputError("PointForce.at", load.at, why, fix)
    return blocks, at[:, None]
