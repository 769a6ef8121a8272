"""What measures how far a path has come: a footing, a point of a body, or time (T29)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from lacore.arrays import Floats
from lacore.assembly.discretisation import Discretisation
from lacore.bodies.any_body import of_kind
from lacore.bodies.continuum.body import Body
from lacore.bodies.continuum.boundaries import vertex_at
from lacore.conditions.footings import footings
from lacore.errors import InputError, is_plane_vector, require_range
from lacore.problem.problem import Problem
from lacore.showing import Compact

Gauge = Callable[[Discretisation, Floats], float]
"""Rate of the travel at a velocity of all unknowns, in units of the travel per s."""


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
            "give lacore.FootingTravel(), lacore.PointTravel(body, at, direction) or lacore.Time()",
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
                "the reference load is not one RigidFooting",
                "give control=lacore.PointTravel(body, at, direction) or lacore.Time()",
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
                "PointTravel.body", self.body, "no body that deforms", f"give one of {known}"
            )
        if not (is_plane_vector(self.direction) and np.any(self.direction)):
            raise InputError(
                "PointTravel.direction", self.direction, "has no direction", "give a vector != 0"
            )
        require_range("PointTravel.direction", self.direction)
        node = vertex_at(body, self.at, "PointTravel.at")  # vertices are the first nodes
        along = np.array(self.direction) / np.linalg.norm(self.direction)
        return lambda d, velocity: float(along @ velocity[d.bodies[self.body].dofs[:, node]])


@dataclass(frozen=True, repr=False)
class Time(Compact):
    """The time that has gone by, s, at velocities of ``F0.u = 1``: the work of the unit load.

    Example:
        >>> control = la.Time()
    """

    unit: ClassVar[str] = "s"

    def gauge(self, problem: Problem) -> Gauge:
        """See `Control`."""
        return lambda d, velocity: 1.0
