"""What measures how far a path has come: a footing, a point of a body, or time (T29)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from lacore.assembly.discretisation import Discretisation
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.boundaries import vertex_at
from lacore.model.conditions.footings import footings
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.reporting import terms
from lacore.reporting.errors import InputError, is_plane_vector, is_vector, require_range
from lacore.reporting.showing import Compact
from lacore.reporting.text import Term, text

Gauge = Callable[[Discretisation, Floats], float]
"""Rate of the travel at a velocity of all unknowns, in units of the travel per s."""

_FOOTING = Term("lacore.FootingTravel()", 'control = { measure = "footing" }')
_POINT = Term(
    "lacore.PointTravel(body, at, direction)",
    'control = { measure = "point", body = ..., at = ..., direction = ... }',
)
_TOOLS = Term(
    "lacore.ToolTravel({'tool': (x, y)})",
    'control = { measure = "tools", velocity = { NAME = [x, y] } }',
)
_TIME = Term("lacore.Time()", 'control = { measure = "time" }')


class Control(Protocol):
    """What a path is measured by.

    One that says its `unit`, ``"m"``, has it on the axes of pictures.
    """

    def gauge(self, problem: Problem) -> Gauge:
        """How to read it in a problem.

        Raises:
            InputError: the problem has no such thing.
        """


def gauge_of(control: Control, problem: Problem) -> Gauge:
    """The gauge of a control in a problem.

    Raises:
        InputError: no control, or the problem has no such thing.
    """
    if isinstance(control, type) or not callable(getattr(control, "gauge", None)):
        raise InputError(
            "control",
            control,
            "not a control",
            text("give {}, {}, {} or {}", _FOOTING, _POINT, _TOOLS, _TIME),
        )
    return control.gauge(problem)


def unit_of(control: Control) -> str:
    """Unit of what it measures; empty where it says none."""
    return str(getattr(control, "unit", ""))


@dataclass(frozen=True, repr=False)
class FootingTravel(Compact):
    """How far the rigid footing of the reference load has moved along its direction, m.

    Example:
        >>> control = la.FootingTravel()  # of a problem whose load is a `RigidFooting`
    """

    unit: ClassVar[str] = "m"

    def gauge(self, problem: Problem) -> Gauge:
        """See `Control`."""
        loads = problem.reference_loads
        if len(loads) != 1 or not footings(loads):
            raise InputError(
                "control",
                "FootingTravel",
                text("the reference load is not one {}", terms.FOOTING),
                text(
                    "give {} or {}, or {} that move",
                    _POINT,
                    _TIME,
                    Term("tools={'name': lacore.Tool(...)}", "tools, such as [tools.NAME],"),
                ),
            )
        return lambda d, velocity: float(velocity[d.footings[0]])


@dataclass(frozen=True, repr=False)
class PointTravel(Compact):
    """How far a point of a body has moved along a direction, m.

    Attributes:
        body: name.
        at: a vertex of its mesh at the beginning of the path.
        direction: normalised.

    Example:
        >>> control = la.PointTravel("tube", at=(1, 0), direction=(1, 0))
    """

    unit: ClassVar[str] = "m"
    body: str
    at: tuple[float, float]
    direction: tuple[float, float]

    def gauge(self, problem: Problem) -> Gauge:
        """See `Control`."""
        deforming = of_kind(problem.bodies, Body)
        body = deforming.get(self.body) if isinstance(self.body, str) else None
        if body is None:
            known = ", ".join(sorted(problem.bodies))
            raise InputError(
                "PointTravel.body", self.body, "no deformable body", f"give one of {known}"
            )
        if not (is_plane_vector(self.direction) and np.any(self.direction)):
            raise InputError(
                "PointTravel.direction", self.direction, "has no direction", "give a vector != 0"
            )
        require_range("PointTravel.direction", self.direction)
        node = vertex_at(body.mesh, self.at, "PointTravel.at")  # vertices are the first nodes
        along = np.array(self.direction) / np.linalg.norm(self.direction)
        return lambda d, velocity: float(along @ velocity[d.continua[self.body].dofs[:, node]])


@dataclass(frozen=True, repr=False)
class ToolTravel(Compact):
    """How far rigid tools have moved together, each by its own velocity, m.

    The tools are rigid blocks of the problem, and move in no other way; the reference load is a
    force on one or more of them, which does power. `Path.history` has as ``force`` the power that
    drives all tools per travel, and `Path.tool_forces` what contact exerts on each.

    Attributes:
        velocity: by body (x, y): how far its centroid moves per travel; or (x, y, turn) with the
            angle by which it turns per travel, rad/m, anticlockwise.

    Example:
        >>> closing = la.ToolTravel({"lower": (0, 1), "upper": (0, -1)})
    """

    unit: ClassVar[str] = "m"
    velocity: Mapping[str, tuple[float, ...]]

    def motions(self, problem: Problem) -> dict[str, Floats]:
        """Of the tools, x, y and turn, (3,) each.

        Raises:
            InputError: no such rigid block, or no velocity.
        """
        if not isinstance(self.velocity, Mapping) or not self.velocity:
            raise InputError(
                "ToolTravel.velocity",
                self.velocity,
                "names no tool",
                "give {'tool': (x, y)} with the names of rigid blocks",
            )
        tools = of_kind(problem.bodies, BlockAssembly)
        found = {}
        for name, own in self.velocity.items():
            field = f"ToolTravel.velocity[{name!r}]"
            if name not in tools:
                known = f"give one of {sorted(tools)}"
                fix = known if tools else text("add a {}", terms.RIGID_BLOCK)
                raise InputError(field, own, "no rigid block has this name", fix)
            if not is_vector(own) or len(own) not in (2, 3):
                raise InputError(field, own, "not a velocity", "give (x, y), or (x, y, turn)")
            found[name] = np.array([*own, 0.0][:3], dtype=float)
        if not any(np.any(own) for own in found.values()):
            raise InputError(
                "ToolTravel.velocity", self.velocity, "moves no tool", "give a velocity != 0"
            )
        return found

    def gauge(self, problem: Problem) -> Gauge:
        """See `Control`."""
        motions = self.motions(problem)
        name = next(name for name, own in motions.items() if np.any(own))
        motion = motions[name]

        def speed(d: Discretisation, velocity: Floats) -> float:
            return float(motion @ d.assemblies[name].motion(velocity)[:, 0] / (motion @ motion))

        return speed


def driven_by(control: Control, problem: Problem) -> dict[str, Floats]:
    """Return the motions of the tools that a control drives, see `Problem.driven`, if any."""
    return control.motions(problem) if isinstance(control, ToolTravel) else {}


@dataclass(frozen=True, repr=False)
class Time(Compact):
    """The elapsed time, s, at velocities of ``F0.u = 1``: the work of the unit load.

    Example:
        >>> control = la.Time()
    """

    unit: ClassVar[str] = "s"

    def gauge(self, problem: Problem) -> Gauge:
        """See `Control`."""
        return lambda d, velocity: 1.0
