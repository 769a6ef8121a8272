"""Rigid tools with an exact outline and a given motion, as a user states them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.continuum.body import Body
from lacore.model.conditions.where import Where
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.obstacles import Shape
from lacore.model.materials.friction import Friction, friction_law
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.paths.control import ToolTravel
from lacore.paths.tools.carrier import PART, carrier
from lacore.reporting import terms
from lacore.reporting.errors import (
    InputError,
    is_number,
    is_plane_vector,
    require_place,
    require_range,
    suggest,
)
from lacore.reporting.showing import Compact
from lacore.reporting.text import Term, text

Side = tuple[str, Where]


@dataclass(frozen=True, repr=False)
class Tool(Compact):
    """A rigid tool that moves by a given velocity.

    Several tools move together: each by its own velocity per travel of the path.

    Attributes:
        shape: of `lacore.shapes`, or a shape of your own, see
        `lacore.model.contact.obstacles.Shape`.
        touches: ``(body name, where)``, or a list of several: the boundaries that it may touch.
        velocity: how far the reference point moves per travel, (x, y).
        turn: angle by which the tool turns about it per travel, rad/m, anticlockwise.
        about: the reference point, m; by default that of the shape: the tip of a wedge, the centre
            of a disc, the point of a plane, the centroid of an outline.
        friction: see `Interface`.

    Raises:
        InputError: not a shape, a boundary, a velocity, an angle, a point or a friction.

    Example:
        >>> wedge = la.shapes.wedge(tip=(0, 0), half_angle=30)
        >>> tool = la.Tool(wedge, touches=("body", "top"), velocity=(0, -1), friction=0.1)
    """

    shape: Shape
    touches: Side | Sequence[Side]
    velocity: tuple[float, float] = (0.0, 0.0)
    turn: float = 0.0
    about: tuple[float, float] | None = None
    friction: float | Friction = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.shape, Shape):
            raise InputError(
                "Tool.shape",
                self.shape,
                "not a shape",
                "give la.shapes.wedge(...), disc, plane or outline, or an object with distance,"
                " normal and outline",
            )
        sides: Any = (self.touches,) if _is_side(self.touches) else self.touches
        if not isinstance(sides, Sequence) or not sides or not all(map(_is_side, sides)):
            raise InputError(
                "Tool.touches",
                self.touches,
                "not a boundary",
                "give ('body', 'boundary'), or a list of such pairs",
            )
        object.__setattr__(self, "touches", tuple((name, where) for name, where in sides))
        if not is_plane_vector(self.velocity):
            raise InputError("Tool.velocity", self.velocity, "not a velocity", "give (x, y)")
        require_range("Tool.velocity", self.velocity)
        if not is_number(self.turn):
            raise InputError("Tool.turn", self.turn, "not an angle", "give a number, rad per m")
        require_range("Tool.turn", self.turn)
        if self.about is not None:
            if not is_plane_vector(self.about):
                raise InputError("Tool.about", self.about, "not a point", "give (x, y)")
            require_place("Tool.about", self.about)
        object.__setattr__(self, "friction", friction_law(self.friction, "Tool.friction"))

    @property
    def moves(self) -> bool:
        """Whether it is not at rest."""
        return bool(np.any(self.velocity) or self.turn)

    @property
    def motion(self) -> Floats:
        """Velocity x, y and turn per travel, shape (3,)."""
        return np.array([*self.velocity, self.turn], dtype=float)

    @property
    def sides(self) -> tuple[Side, ...]:
        """The boundaries that it may touch."""
        return self.touches  # type: ignore[return-value]  # since it was built

    @property
    def reference(self) -> tuple[float, float]:
        """The point that its velocity moves, m."""
        if self.about is not None:
            return self.about
        x, y = getattr(self.shape, "reference", (0.0, 0.0))
        return float(x), float(y)


def _is_side(side: object) -> bool:
    return (
        isinstance(side, Sequence)
        and not isinstance(side, str)
        and len(side) == 2
        and isinstance(side[0], str)
        and (callable(side[1]) or isinstance(side[1], str | tuple))
    )


@dataclass(frozen=True)
class Tooling:
    """Tools made ready for a path.

    Attributes:
        shapes: of them, by name.
        blocks: that carry them, where these are not among the bodies of the problem.
        interfaces: what they may touch.
        drives: motion per travel by name, shape (3,).
    """

    shapes: Mapping[str, Shape]
    blocks: Mapping[str, BlockAssembly] = field(default_factory=dict)
    interfaces: tuple[Interface, ...] = ()
    drives: Mapping[str, Floats] = field(default_factory=dict)

    @property
    def moves(self) -> bool:
        """Whether one of them does."""
        return any(map(np.any, self.drives.values()))

    @property
    def travel(self) -> ToolTravel:
        """The control that measures how far the tools have moved."""
        return ToolTravel({name: tuple(own.tolist()) for name, own in self.drives.items()})


NO_TOOLS = Tooling({})


def tooling(problem: Problem, tools: Mapping[str, Tool]) -> Tooling:
    """Tools as bodies of a problem, and what they may touch.

    Raises:
        InputError: names that are taken or no names, bodies and boundaries that there are not,
            tools that move in a problem with reference loads, tools at rest in one without.
    """
    continua = of_kind(problem.bodies, Body)
    for name, tool in tools.items():
        _check(name, tool, problem, continua)
    moving = [name for name, tool in tools.items() if tool.moves]
    if moving and problem.reference_loads:
        raise InputError(
            f"tools[{moving[0]!r}].velocity",
            tools[moving[0]].velocity,
            "the problem has reference loads, too, and only one of them can drive the path",
            text("leave {} empty; loads that stay constant are dead_loads", terms.REFERENCE_LOADS),
        )
    if tools and not (moving or problem.reference_loads):
        raise InputError(
            "tools",
            sorted(tools),
            "no tool moves, and there is no reference load, so nothing drives the path",
            text(
                "give one of them a velocity, such as {}",
                Term("Tool(..., velocity=(0, -1))", "velocity = [0, -1]"),
            ),
        )
    return Tooling(
        shapes={name: tool.shape for name, tool in tools.items()},
        blocks={name: _carrier(tool, continua) for name, tool in tools.items()},
        interfaces=tuple(
            Interface((body, where), (name, PART), tool.friction)
            for name, tool in tools.items()
            for body, where in tool.sides
        ),
        drives={name: tool.motion for name, tool in tools.items()},
    )


def _check(name: object, tool: object, problem: Problem, continua: Mapping[str, Body]) -> None:
    if not isinstance(name, str):
        raise InputError("tools", name, "not a name", "give a text, 'wedge'")
    field = f"tools[{name!r}]"
    if not isinstance(tool, Tool):
        raise InputError(field, tool, "not a tool", "give lacore.Tool(shape, touches, velocity)")
    if name in problem.bodies:
        raise InputError("tools", name, "a body has this name", "give the tool another name")
    for body, where in tool.sides:
        if body not in continua:
            raise InputError(
                f"{field}.touches",
                body,
                "no deformable body of this name",
                suggest(body, continua)
                if continua
                else text("give the problem a {}", terms.CONTINUUM),
            )
        known = continua[body].mesh.boundaries or {}
        if isinstance(where, str) and where not in known:
            raise InputError(
                f"{field}.touches",
                where,
                f"the mesh of body {body!r} has no boundary of this name",
                suggest(where, known),
            )
        if continua[body].axisymmetric and (tool.velocity[0] or tool.turn):
            raise InputError(
                f"{field}.velocity",
                (*tool.velocity, tool.turn),
                f"the body {body!r} is axisymmetric, and a rigid tool around its axis moves along y"
                " only",
                text(
                    "give {}", Term("velocity=(0, y) and turn=0", "velocity = [0, y] and no turn")
                ),
            )


def _carrier(tool: Tool, continua: Mapping[str, Body]) -> BlockAssembly:
    return carrier(tool.reference, min(continua[body].size for body, _ in tool.sides))


def require_own_travel(control: ToolTravel, tools: Tooling) -> None:
    """Raise `InputError` where a control gives tools other velocities than their own."""
    for name, own in control.velocity.items():
        known = tools.drives.get(name)
        given = np.array([*own, 0.0][:3], dtype=float)
        if known is None or not np.array_equal(known, given):
            raise InputError(
                f"ToolTravel.velocity[{name!r}]",
                own,
                "not the velocity of a tool of this name"
                + ("" if known is None else f", which is {tuple(known.tolist())}"),
                text(
                    "leave out the control, and give all tools {}",
                    Term("as lacore.Tool(..., velocity=(x, y))", "velocity = [x, y]"),
                ),
            )
