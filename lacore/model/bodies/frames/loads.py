"""Loads on frames: forces at nodes, and along members."""

from functools import singledispatch
from typing import TYPE_CHECKING

import numpy as np

from lacore.model.conditions.loads import Load, PointForce, Traction
from lacore.numerics.arrays import Floats
from lacore.reporting import terms
from lacore.reporting.errors import InputError, suggest
from lacore.reporting.text import text

if TYPE_CHECKING:
    from lacore.model.bodies.frames.frame import Frame


@singledispatch
def nodal(load: Load, body: "Frame") -> Floats:
    """Return the forces and moments of a load at the nodes, shape (N, 3), N/m and 0.

    Raises:
        InputError: a load that frames do not support, or at no node or member.
    """
    raise InputError(
        f"{type(load).__name__}.body",
        load.body,
        "a frame, whose members have neither width nor sides",
        text(
            "give {} along members (own weight: N/m per m of member), or {}",
            terms.TRACTION,
            terms.POINT_FORCE,
        ),
    )


@nodal.register(PointForce)
def _point(load: PointForce, body: "Frame") -> Floats:
    total = np.zeros((len(body.names), 3))
    total[_loaded_node(load, body), :2] = load.vector
    return total


@nodal.register(Traction)
def _along(load: Traction, body: "Frame") -> Floats:
    total = np.zeros((len(body.names), 3))
    half = (line_load(load, body) * body.pieces.length / 2).T
    for nodes in (body.pieces.start, body.pieces.end):
        np.add.at(total[:, :2], nodes, half)
    return total


def _loaded_node(load: PointForce, body: "Frame") -> int:
    if load.where is not None:
        raise InputError(
            "PointForce.where", load.where, "a node of a frame needs none", "leave it out"
        )
    if isinstance(load.at, str):
        return int(body.find(load.at, "PointForce.at")[0])
    node = body.node_at(load.at)
    if node is None:
        away = body.position - np.reshape(load.at, (2, 1))
        nearest = body.names[int(np.argmin(np.linalg.norm(away, axis=0)))]
        raise InputError(
            "PointForce.at",
            load.at,
            "lies on no member of the frame",
            f"the nearest node is {nearest!r}",
        )
    return node


@singledispatch
def line_load(load: Load, body: "Frame") -> Floats:
    """Return a load along members on all pieces, N/m per m, (2, P): 0 on other members."""
    return np.zeros(body.pieces.along.shape)


@line_load.register(Traction)
def _traction(load: Traction, body: "Frame") -> Floats:
    wanted = (load.where,) if isinstance(load.where, str) else load.where
    if not isinstance(wanted, tuple):
        raise InputError("Traction.where", None, "not a member", "give the name of a member")
    for name in wanted:
        if name not in body.member_names:
            fix = suggest(str(name), body.member_names)
            raise InputError("Traction.where", name, "no such member", fix)
        if not body.section_of[body.member_names.index(name)].bends:
            why = "a bar, which carries axial force alone"
            raise InputError("Traction.where", name, why, "load its nodes")
    loaded = np.isin(body.member_names, wanted)[body.pieces.member]
    return np.outer(load.vector, loaded)
