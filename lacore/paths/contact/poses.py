"""Where rigid blocks are along a path: the centroid of each, and how far it has turned."""

from dataclasses import replace

import numpy as np

from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError
from lacore.reporting.text import Term, text


def require_single(name: str, body: BlockAssembly) -> None:
    """Raise `InputError` unless an assembly is one block, whose contact is all in interfaces."""
    if len(body.names) > 1:
        raise InputError(
            f"Problem.bodies[{name!r}]",
            f"{len(body.names)} blocks",
            "a path does not follow the joints between the blocks of one assembly",
            text(
                "give each block as a body of its own, {}, with an {} for each contact",
                Term("lacore.RigidBlock(vertices)", 'kind = "block"'),
                Term("lacore.Interface", "interface"),
            ),
        )


def pose(body: BlockAssembly) -> Floats:
    """Centroid x, y [m] and angle [rad] where a path begins, shape (3, 1)."""
    return np.array([*body.centroid, np.zeros(1)])


def carried_along(body: BlockAssembly, at: Floats, point: Floats) -> Floats:
    """Where points of the block have come to, (2, n); points are those where the path began."""
    away = point - body.centroid
    turn = at[2, 0]
    c, s = np.cos(turn), np.sin(turn)
    return np.asarray(at[:2] + np.array([[c, -s], [s, c]]) @ away)


def placed(body: BlockAssembly, at: Floats) -> BlockAssembly:
    """The block at another pose."""
    if np.array_equal(at, pose(body)):
        return body
    corners = {
        name: carried_along(body, at, vertices.T).T for name, vertices in body.polygons.items()
    }
    return replace(body, blocks=corners)
