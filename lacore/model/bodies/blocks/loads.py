"""Loads on rigid blocks, in the plane and in three dimensions: forces and their places."""

from collections.abc import Sequence
from functools import singledispatch

import numpy as np

from lacore.model.bodies.blocks.rigid_blocks import RigidBlocks
from lacore.model.conditions.body_forces import BodyForce
from lacore.model.conditions.footings import Footing, RigidFooting, Twist
from lacore.model.conditions.loads import Load, PointForce, SurfaceLoad
from lacore.model.conditions.water import PorePressure, StandingWater
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting import terms
from lacore.reporting.errors import InputError, suggest
from lacore.reporting.text import Term, text

_BENT = 1e-9  # by the largest value: round-off of a linear field
# Quadrature on triangles and tetrahedra, exact to degree 2: the product of a linear force and its
# lever. Rows are the barycentric coordinates of the points, whose weights are equal.
_NEAR, _FAR = (5 + 3 * np.sqrt(5)) / 20, (5 - np.sqrt(5)) / 20
_RULES = {
    2: np.array([[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]]),
    3: np.full((4, 4), _FAR) + (_NEAR - _FAR) * np.eye(4),
}

Carried = tuple[Ints, Floats, Floats]
"""Blocks (k,), points of attack (d, k) in m, forces (d, k) in N/m; in three dimensions N."""


@singledispatch
def carried(load: Load, body: RigidBlocks) -> Carried:
    """Return the forces of a load on blocks."""
    raise TypeError(f"not a load: {type(load).__name__}")


@carried.register(SurfaceLoad)
def _boundary(load: SurfaceLoad, body: RigidBlocks) -> Carried:
    facets = body.outline(load.where, f"{type(load).__name__}.where")
    places, normal, size = body.geometry_of(facets)
    return body.blocks_of(facets), places, load.on(normal) * size


@carried.register(RigidFooting)
@carried.register(Twist)
def _footing(load: Footing, body: RigidBlocks) -> Carried:
    raise InputError(
        f"{type(load).__name__}.body", load.body, "its blocks are rigid already", "load the blocks"
    )


@carried.register(PorePressure)
@carried.register(StandingWater)
def _water(load: PorePressure | StandingWater, body: RigidBlocks) -> Carried:
    raise InputError(
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
def _volume(load: BodyForce, body: RigidBlocks) -> Carried:
    blocks = named(body, load.where, "BodyForce.where")
    count = len(body.names)
    if load.piecewise_uniform:
        places = body.centroid[:, blocks]
        force = load.at(places, blocks, count, "BodyForce")
        return blocks, places, force * body.measure[blocks]
    corners, measure, owners = body.simplices(blocks)
    rule = _RULES[body.dimension]
    places = np.einsum("qc,xct->xqt", rule, corners)
    parts = np.tile(owners, len(rule))
    force, ends = (
        load.at(own.reshape(len(own), -1), parts, count, "BodyForce").reshape(own.shape)
        for own in (places, corners)
    )
    bent = np.abs(np.einsum("qc,xct->xqt", rule, ends) - force).max()
    if bent > _BENT * np.abs(ends).max():
        raise InputError(
            "BodyForce.vector",
            load.told,
            "is not linear in each block",
            text(
                "give {}",
                Term(
                    "a value for each block, a lacore.Linear, or a function that is linear in each",
                    "numbers, or at and gradient",
                ),
            ),
        )
    flat = body.dimension, -1
    return parts, places.reshape(flat), (force * measure / len(rule)).reshape(flat)


@carried.register(PointForce)
def _point(load: PointForce, body: RigidBlocks) -> Carried:
    block, place = _loaded_block(body, load)
    return block, place, np.reshape(np.asarray(load.vector, dtype=float), (-1, 1))


def named(body: RigidBlocks, where: str | tuple[str, ...] | None, field: str) -> Ints:
    """Return the numbers of blocks from their names; None: all blocks."""
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


def _loaded_block(body: RigidBlocks, load: PointForce) -> tuple[Ints, Floats]:
    """Return the block that a point force acts on, and the place, shapes (1,) and (d, 1).

    Raises:
        InputError: a place on several blocks, or on none without the name of the one that carries
            the force there, as on a rigid arm; or an unknown name.
    """
    if isinstance(load.at, str):
        block = named(body, load.at, "PointForce.at")
        if load.where not in (None, load.at):
            raise InputError(
                "PointForce.where", load.where, f"`at` names {load.at!r}", "leave `where` out"
            )
        return block, body.centroid[:, block]
    at = np.asarray(load.at, dtype=float)
    distance = body.away(at)
    blocks = np.flatnonzero(distance <= body.allowed)
    if load.where is not None:
        carrying = named(body, load.where, "PointForce.where")
        blocks = np.intersect1d(blocks, carrying) if blocks.size else carrying
    names = [body.names[block] for block in blocks]
    if len(names) != 1:
        why = f"lies on the blocks {', '.join(names)}" if names else "lies on no block"
        nearest = body.names[int(np.argmin(distance))]
        fix = "say by `where` which one carries it"
        if not names:
            fix = (
                f"the nearest is {nearest!r}: name it by `where` if it carries the force on an arm"
            )
        raise InputError("PointForce.at", load.at, why, fix)
    return blocks, at[:, None]
