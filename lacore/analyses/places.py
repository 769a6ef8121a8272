"""Places of forces and supports, as numbers of a problem that can be changed."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import singledispatch
from typing import Any

import numpy as np

from lacore.model.bodies.any_body import of_kind, rigid_blocks
from lacore.model.bodies.frames.frame import Frame
from lacore.model.conditions.loads import Load, PointForce
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats

_STRAIGHT = 1e-6  # sine of the angle between members on one line
_AXES = [("x", np.array([1.0, 0.0])), ("y", np.array([0.0, 1.0]))]


@dataclass(frozen=True)
class Place:
    """Coordinate that can be changed.

    Attributes:
        name: its name.
        value: m; for a movement along a member 0.
        size: size of the body, m.
        at: function that returns the problem with another value.
        body: name of the body.
    """

    name: str
    value: float
    size: float
    at: Callable[[Problem, float], Problem]
    body: str


def places(problem: Problem) -> Iterator[Place]:
    """Yield the coordinates of forces on blocks, and of held or loaded nodes of frames.

    A node inside a straight line of members moves along it only: off the line, inextensible members
    would lock each other. On meshes forces act at vertices, and supports along edges, whose places
    depend on the mesh.
    """
    blocks = rigid_blocks(problem.bodies)
    for attribute in ("reference_loads", "dead_loads"):
        for index, load in enumerate(getattr(problem, attribute)):
            if load.body in blocks and load.point is not None:
                size = float(blocks[load.body].size)
                for axis, letter in enumerate("xyz"[: problem.dimension]):
                    name = f"{attribute}[{index}]: {letter} of the force on {load.body}"
                    at = _of_force(attribute, index, axis)
                    yield Place(name, float(load.point[axis]), size, at, load.body)
    for body, frame in of_kind(problem.bodies, Frame).items():
        for node, what in _marked(problem, body, frame).items():
            for letter, direction in _directions(frame, node):
                name = f"{body}: {what} at {node}, {letter}"
                yield Place(name, 0.0, frame.size, _of_node(body, node, direction), body)


def fixed_places(problem: Problem) -> Iterator[str]:
    """Yield coordinates of held or loaded nodes that must keep members straight, for a message."""
    for body, frame in of_kind(problem.bodies, Frame).items():
        for node, what in _marked(problem, body, frame).items():
            free = len(_directions(frame, node))
            if free < len(_AXES):
                yield f"{body}: {what} at {node}" + (", across its members" if free else "")


def _of_force(attribute: str, index: int, axis: int) -> Callable[[Problem, float], Problem]:
    def at(problem: Problem, value: float) -> Problem:
        loads: list[Any] = list(getattr(problem, attribute))
        point = list(loads[index].point)
        point[axis] = value
        loads[index] = replace(loads[index], at=tuple(point))
        return problem.with_loads(**{attribute: loads})

    return at


def _marked(problem: Problem, body: str, frame: Frame) -> dict[str, str]:
    """Return the held or loaded nodes of a frame, with the support or load."""
    found: dict[str, str] = {}
    for support in problem.supports:
        if support.body == body:
            nodes = frame.find(support.where, "Fix.where")
            found |= {frame.names[node]: "support" for node in nodes}
    for load in problem.loads.values():
        if load.body == body and (name := _loaded_node(load, frame)) is not None:
            held = found.get(name, "").startswith("support")
            found[name] = "support and force" if held else "force"
    return found


@singledispatch
def _loaded_node(load: Load, frame: Frame) -> str | None:
    """Return the node of a frame that a force acts at; None for other loads."""
    return None


@_loaded_node.register(PointForce)
def _at(load: PointForce, frame: Frame) -> str:
    node = frame.node_at(load.point) if load.point is not None else None
    return str(load.at) if node is None else frame.names[node]


def _directions(frame: Frame, node: str) -> list[tuple[str, Floats]]:
    """Return the directions in which a node can move: along its members, else x, y.

    Members must remain straight if other nodes divide them, or if any member at the node is
    divided.
    """
    number, pieces = frame.names.index(node), frame.pieces
    here = (pieces.start == number) | (pieces.end == number)
    along = np.asarray(pieces.along[:, here])
    split = np.bincount(pieces.member)[pieces.member[here]] > 1
    if along.shape[1] < 2 and not split.any():
        return _AXES
    across = along[0, 0] * along[1] - along[1, 0] * along[0]
    if np.abs(across).max() > _STRAIGHT:
        if not split.any():
            return _AXES
        along = along[:, split]
        across = along[0, 0] * along[1] - along[1, 0] * along[0]
        if np.abs(across).max() > _STRAIGHT:
            return []
    first = along[:, 0] if along[np.abs(along[:, 0]).argmax(), 0] > 0 else -along[:, 0]
    straight = [letter for letter, axis in _AXES if np.allclose(first, axis, atol=_STRAIGHT)]
    return [(straight[0] if straight else "along", first)]


def _of_node(body: str, node: str, direction: Floats) -> Callable[[Problem, float], Problem]:
    def at(problem: Problem, value: float) -> Problem:
        frame = of_kind(problem.bodies, Frame)[body]
        old = np.array(frame.nodes[node])
        x, y = old + value * direction
        new = (float(x), float(y))
        moved = replace(frame, nodes={**frame.nodes, node: new})

        def shifted(load: Any) -> Any:
            on = load.body == body and load.point is not None
            return replace(load, at=new) if on and np.allclose(load.point, old) else load

        return replace(
            problem,
            bodies={**problem.bodies, body: moved},
            reference_loads=[shifted(load) for load in problem.reference_loads],
            dead_loads=[shifted(load) for load in problem.dead_loads],
        )

    return at
