"""A path of large deformation."""

from dataclasses import dataclass
from math import radians
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, StrictBool, Tag, ValidationInfo

from lacore.files.problem.calls import PROBLEM, Call, Own
from lacore.files.problem.places import Path as Place
from lacore.files.problem.schema.conditions import Interface
from lacore.files.problem.schema.entry import Entry
from lacore.files.problem.schema.values import AngleSlope, Count, Length, Measure, Number, Point


class FootingTravel(Entry):
    """Displacement of the rigid footing of the reference load."""

    maker: ClassVar[str] = "la.FootingTravel"
    tag: ClassVar[str] = "measure"
    measure: Literal["footing"]


class PointTravel(Entry):
    """Displacement of a vertex of a body along a direction."""

    maker: ClassVar[str] = "la.PointTravel"
    tag: ClassVar[str] = "measure"
    measure: Literal["point"]
    body: str
    at: Point
    direction: tuple[Number, Number]


def _motion(given: Any) -> str:
    return "~turning" if isinstance(given, list | tuple) and len(given) > 2 else "~plain"


Motion = Annotated[
    Annotated[tuple[Number, Number], Tag("~plain")]
    | Annotated[tuple[Number, Number, AngleSlope], Tag("~turning")],
    Discriminator(_motion),
]
"""Velocity per travel: [x, y], or [x, y, turn] with the angle by which a tool turns."""


class ToolTravel(Entry):
    """Common displacement of rigid blocks, each with its own velocity."""

    maker: ClassVar[str] = "la.ToolTravel"
    tag: ClassVar[str] = "measure"
    measure: Literal["tools"]
    velocity: dict[str, Motion]
    """Velocity of each block, per travel: [x, y], or [x, y, turn] with the angle of rotation."""

    def arguments(self, at: Place) -> dict[str, Any]:
        """Return its arguments, see `Entry.arguments`."""
        given = super().arguments(at)
        return given | {
            "velocity": {name: in_radians(own) for name, own in given["velocity"].items()}
        }


def in_radians(motion: tuple[float, ...]) -> tuple[float, ...]:
    """Return a motion (x, y, turn) with its rotation in rad/m, and (x, y) unchanged."""
    return (*motion[:2], *map(radians, motion[2:]))


class TimeTravel(Entry):
    """Time, at velocities for which the reference loads do work at a rate of one."""

    maker: ClassVar[str] = "la.Time"
    tag: ClassVar[str] = "measure"
    measure: Literal["time"]


class AdaptiveSteps(Entry):
    """Steps as long as their error allows."""

    maker: ClassVar[str] = "la.AdaptiveSteps"
    tolerance: Number | None = None
    """Change of the displacement in a step, by the size of the body; 0.001 by default."""
    first: Number | None = None
    """Length of the first step, per travel; 0.05 if left out."""
    smallest: Number | None = None
    """Least length of a step, per travel; 0.0001 if left out."""


class LeastNorm(Entry):
    """The smoothest of all velocities of nearly the same load."""

    maker: ClassVar[str] = "la.LeastNorm"
    within: Number | None = None
    """Allowed increase of its load over the load factor; 0.0001 by default."""


def _size(given: Any) -> str:
    return "~each" if isinstance(given, dict) else "~all"


class Remeshing(Entry):
    """New triangles when elements are distorted, by Gmsh."""

    maker: ClassVar[str] = "la.Remeshing"
    size: (
        Annotated[
            Annotated[Length, Tag("~all")] | Annotated[dict[str, Length], Tag("~each")],
            Discriminator(_size),
        ]
        | None
    ) = None
    """Length of edges, or one for each body by name; as before if left out."""
    quality: Number | None = None
    """Quality of an element, by its initial value, below which it is replaced."""


class Steady(Entry):
    """Condition for stationary load and flow, at which the path ends."""

    maker: ClassVar[str] = "la.Steady"
    tolerance: Number | None = None
    """Drift of the load, by the mean load; 0.01 by default."""
    window: Length | None = None
    """Part of the travel that is checked; the last third by default."""
    flow: Number | None = None
    """Largest difference of the velocities, per norm; 0.1 if left out."""


@dataclass(frozen=True)
class _Travel(Measure):
    """Length, or time if the control measures it."""

    unit: str = "m"

    def _accepted(self, info: ValidationInfo) -> tuple[str, ...]:
        timed = isinstance((info.data or {}).get("control"), TimeTravel)
        return ("s",) if timed else ("m",)


def _steps(given: Any) -> str:
    return "~adaptive" if isinstance(given, dict) else "~number"


class PathOf(Entry):
    """A path of large deformation: the deformation is divided into steps."""

    maker: ClassVar[str] = "la.sequential"
    control: (
        Annotated[
            FootingTravel | PointTravel | ToolTravel | TimeTravel, Field(discriminator="measure")
        ]
        | None
    ) = None
    """Motion that the travel measures; the footing of the reference load by default."""
    travel: Annotated[float, _Travel()]
    """Travel at the end of the path."""
    steps: (
        Annotated[
            Annotated[Count, Tag("~number")] | Annotated[AdaptiveSteps, Tag("~adaptive")],
            Discriminator(_steps),
        ]
        | None
    ) = None
    """Number of equal steps (20 if left out), or a table for steps of different lengths."""
    scheme: Literal["leapfrog", "explicit", "implicit-midpoint", "implicit-euler"] | None = None
    selection: LeastNorm | None = None
    remesh: Remeshing | None = None
    until: Steady | None = None
    approaching: tuple[Interface, ...] = ()
    """Interfaces whose sides do not touch yet."""
    keep_every: Count | None = None
    """Number of steps per stored shape."""
    animation: StrictBool = False
    """Whether an animation is written."""

    def call(self, at: Place) -> Call:
        """Return its call, see `Entry.call`."""
        given = self.arguments(at)
        given.pop("animation", None)
        if "approaching" in given:
            given["approaching"] = list(given["approaching"])
        return Call(self.maker, {"problem": Own(PROBLEM), **given}, at)
