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
    """How far the rigid footing of the reference load has moved."""

    maker: ClassVar[str] = "la.FootingTravel"
    tag: ClassVar[str] = "measure"
    measure: Literal["footing"]


class PointTravel(Entry):
    """How far a vertex of a body has moved along a direction."""

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
    """How far rigid blocks have moved together, each with its own velocity."""

    maker: ClassVar[str] = "la.ToolTravel"
    tag: ClassVar[str] = "measure"
    measure: Literal["tools"]
    velocity: dict[str, Motion]
    """Of each block, per travel: [x, y], or [x, y, turn] with the angle by which it turns."""

    def arguments(self, at: Place) -> dict[str, Any]:
        """See `Entry.arguments`."""
        given = super().arguments(at)
        return given | {
            "velocity": {name: in_radians(own) for name, own in given["velocity"].items()}
        }


def in_radians(motion: tuple[float, ...]) -> tuple[float, ...]:
    """A motion (x, y, turn) with its turn in rad/m; (x, y) as it is."""
    return (*motion[:2], *map(radians, motion[2:]))


class TimeTravel(Entry):
    """The time, at velocities for which the reference loads do work at a rate of one."""

    maker: ClassVar[str] = "la.Time"
    tag: ClassVar[str] = "measure"
    measure: Literal["time"]


class AdaptiveSteps(Entry):
    """Steps as long as their error allows."""

    maker: ClassVar[str] = "la.AdaptiveSteps"
    tolerance: Number | None = None
    """Of the change of the displacement in a step, per size of the body; 0.001 if left out."""
    first: Number | None = None
    """Length of the first step, per travel; 0.05 if left out."""
    smallest: Number | None = None
    """Least length of a step, per travel; 0.0001 if left out."""


class LeastNorm(Entry):
    """The most regular of all velocities of nearly the same load."""

    maker: ClassVar[str] = "la.LeastNorm"
    within: Number | None = None
    """By how much its load may be above the load factor; 0.0001 if left out."""


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
    """Ratio of the quality of an element to that at first, below which it is replaced."""


class Steady(Entry):
    """When load and flow count as stationary: the path ends then."""

    maker: ClassVar[str] = "la.Steady"
    tolerance: Number | None = None
    """Of the drift of the load, per mean load; 0.01 if left out."""
    window: Length | None = None
    """Part of the travel that is looked at; the last third if left out."""
    flow: Number | None = None
    """Largest difference of the velocities, per norm; 0.1 if left out."""


@dataclass(frozen=True)
class _Travel(Measure):
    """A length, or a time where that is what the control measures."""

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
    """What the travel is of; the footing of the reference load if left out."""
    travel: Annotated[float, _Travel()]
    """How far to go."""
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
        """See `Entry.call`."""
        given = self.arguments(at)
        given.pop("animation", None)
        if "approaching" in given:
            given["approaching"] = list(given["approaching"])
        return Call(self.maker, {"problem": Own(PROBLEM), **given}, at)
