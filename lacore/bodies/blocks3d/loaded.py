"""Loads on rigid blocks in space: which blocks carry them, where, and how much."""

from functools import singledispatch
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from lacore.arrays import Floats, Ints
from lacore.bodies.blocks.loaded import loaded_block, named, refuse_footing, refuse_water
from lacore.bodies.blocks3d.polyhedron import Polyhedron
from lacore.conditions.body_forces import BodyForce
from lacore.conditions.footings import Footing, RigidFooting, Twist
from lacore.conditions.loads import Load, PointForce, Pressure, Traction
from lacore.conditions.water import PorePressure, StandingWater
from lacore.errors import InputError

if TYPE_CHECKING:
    from lacore.bodies.blocks3d.block_assembly import BlockAssembly3D

_BENT = 1e-9  # of the largest value: what is linear, up to round-off
# Rule of four points on tetrahedra, exact of degree 2: a linear force times its lever.
_NEAR, _FAR = (5 + 3 * np.sqrt(5)) / 20, (5 - np.sqrt(5)) / 20
_RULE = np.full((4, 4), _FAR) + (_NEAR - _FAR) * np.eye(4)

Carried = tuple[Ints, Floats, Floats]
"""Blocks (k,), points of attack (3, k) in m, forces (3, k) in N."""


@singledispatch
def carried(load: Load, body: "BlockAssembly3D") -> Carried:
    """What blocks carry of a load.

    Raises:
        InputError: a load that acts on no block, or on several; a footing, water.
    """
    raise TypeError(f"not a load: {type(load).__name__}")


@carried.register(Traction)
@carried.register(Pressure)
def _boundary(load: Traction | Pressure, body: "BlockAssembly3D") -> Carried:
    faces = body.outline(load.where, f"{type(load).__name__}.where")
    own = body.faces
    vectors = load.on(own.normal[:, faces]) * own.area[faces]
    return own.block[faces], body.face_centroid[:, faces], vectors


@carried.register(RigidFooting)
@carried.register(Twist)
def _footing(load: Footing, body: "BlockAssembly3D") -> Carried:
    raise refuse_footing(load)


@carried.register(PorePressure)
@carried.register(StandingWater)
def _water(load: PorePressure | StandingWater, body: "BlockAssembly3D") -> Carried:
    raise refuse_water(load)


@carried.register(BodyForce)
def _volume(load: BodyForce, body: "BlockAssembly3D") -> Carried:
    blocks = named(body, load.where, "BodyForce.where")
    count = len(body.names)
    if load.piecewise_uniform:
        places = body.centroid[:, blocks]
        force = load.at(places, blocks, count, "BodyForce")
        return blocks, places, force * body.volume[blocks]
    corner, owners = _tetrahedra(body, blocks)
    places = np.einsum("qc,xct->xqt", _RULE, corner)
    parts = np.tile(owners, 4)
    force = load.at(places.reshape(3, -1), parts, count, "BodyForce").reshape(places.shape)
    ends = load.at(corner.reshape(3, -1), parts, count, "BodyForce").reshape(corner.shape)
    bent = np.abs(np.einsum("qc,xct->xqt", _RULE, ends) - force).max()
    if bent > _BENT * np.abs(ends).max():
        raise InputError(
            "BodyForce.vector",
            load.told,
            "is not linear in each block",
            "give a value for each block, or a function that is linear in each",
        )
    u, v, w = (corner[:, k] - corner[:, 0] for k in (1, 2, 3))
    volume = np.sum(u * np.cross(v, w, axis=0), axis=0) / 6  # with its sign: pieces may lie outside
    return parts, places.reshape(3, -1), (force * volume / 4).reshape(3, -1)


def _tetrahedra(body: "BlockAssembly3D", blocks: Ints) -> tuple[Floats, Ints]:
    """Tetrahedra of blocks over the triangles of their faces, (3, 4, t), m, and their blocks."""
    found, owners = [], []
    for number in blocks.tolist():
        own = body.polyhedra[body.names[number]]
        triangles = np.array(
            [(ring[0], *pair) for ring in own.faces for pair in pairwise(ring[1:])]
        )
        apex = np.repeat(own.centroid[None, None], len(triangles), axis=0)
        found.append(np.concatenate([apex, own.vertices[triangles]], axis=1))
        owners.append(np.full(len(triangles), number))
    return np.concatenate(found).transpose(2, 1, 0), np.concatenate(owners)


@carried.register(PointForce)
def _point(load: PointForce, body: "BlockAssembly3D") -> Carried:
    def away(at: Floats) -> Floats:
        return np.array([_outside(block, at) for block in body.polyhedra.values()])

    blocks, points = loaded_block(body, load, away)
    return blocks, points, np.reshape(np.asarray(load.vector, dtype=float), (3, 1))


def _outside(block: Polyhedron, at: Floats) -> float:
    """How far a place is outside of the planes of the nearest convex piece of a block, m."""
    return min(float((at @ piece.normal - piece.offset).max()) for piece in block.pieces)
