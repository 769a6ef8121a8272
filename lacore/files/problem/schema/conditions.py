"""Supports, interfaces and loads."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, StrictBool, Tag

from lacore.files.problem.calls import Call
from lacore.files.problem.places import Path
from lacore.files.problem.schema.entry import Entry, node
from lacore.files.problem.schema.fields import ByLevel, Density, Linear
from lacore.files.problem.schema.materials import Friction
from lacore.files.problem.schema.places import Where
from lacore.files.problem.schema.values import (
    Force,
    Length,
    LineLoad,
    Number,
    Point,
    Stress,
    UnitWeight,
)


class Support(Entry):
    """Velocities held at zero."""

    maker: ClassVar[str] = "la.Fix"
    body: str
    where: Where
    components: str | None = None
    """x, y, xy (if left out), normal, tangential; of nodes of frames rotation, clamped."""


class Side(Entry):
    """A part of the boundary of a body."""

    body: str
    where: Where

    def call(self, at: Path) -> Any:
        """See `Entry.call`."""
        return self.body, node(self.where, (*at, "where"))


class Plane(Entry):
    """A rigid plane: a point of it, and its normal towards the body."""

    maker: ClassVar[str] = "la.RigidObstacle"
    point: Point
    normal: tuple[Number, Number]


def _master(given: Any) -> str:
    if isinstance(given, dict):
        return "~plane" if {"point", "normal"} & set(given) else "~side"
    return "~word"


class Interface(Entry):
    """Contact with friction: between two bodies, or a body and a rigid obstacle."""

    maker: ClassVar[str] = "la.Interface"
    slave: Side
    master: Annotated[
        Annotated[Side, Tag("~side")]
        | Annotated[Plane, Tag("~plane")]
        | Annotated[Literal["obstacle"], Tag("~word")],
        Discriminator(_master),
    ]
    """Another body, a plane, or 'obstacle': as the boundary is."""
    friction: Friction

    def arguments(self, at: Path) -> dict[str, Any]:
        """See `Entry.arguments`."""
        given = super().arguments(at)
        if self.master == "obstacle":
            given["master"] = Call("la.RigidObstacle", {}, (*at, "master"))
        return given


class _Load(Entry):
    tag: ClassVar[str] = "load"
    body: str


class Traction(_Load):
    """A force per area of a boundary; on a frame per length of a member."""

    maker: ClassVar[str] = "la.Traction"
    load: Literal["traction"]
    where: Where
    vector: tuple[LineLoad, LineLoad]


class Pressure(_Load):
    """A pressure against the outward normal."""

    maker: ClassVar[str] = "la.Pressure"
    load: Literal["pressure"]
    where: Where
    value: Stress


class Weight(_Load):
    """Weight, downwards along y."""

    maker: ClassVar[str] = "la.BodyForce"
    load: Literal["weight"]
    unit_weight: Density
    where: str | tuple[str, ...] | None = None
    """Blocks or regions; all if left out."""

    def call(self, at: Path) -> Any:
        """See `Entry.call`."""
        own, place = self.unit_weight, (*at, "unit_weight")
        down = -own if isinstance(own, float) else node(own.downwards(), place)
        given: dict[str, Any] = {"body": self.body, "vector": (0.0, down)}
        if self.where is not None:
            given["where"] = self.where
        return Call(self.maker, given, at, {"vector": place})


class BodyForce(_Load):
    """A force per volume."""

    maker: ClassVar[str] = "la.BodyForce"
    load: Literal["body-force"]
    vector: tuple[Density, Density]
    where: str | tuple[str, ...] | None = None
    """Blocks or regions; all if left out."""


def _at(given: Any) -> str:
    return "~name" if isinstance(given, str) else "~point"


class PointForce(_Load):
    """A single force, per thickness; on a frame as it stands."""

    maker: ClassVar[str] = "la.PointForce"
    load: Literal["point-force"]
    at: Annotated[
        Annotated[str, Tag("~name")] | Annotated[Point, Tag("~point")], Discriminator(_at)
    ]
    """[x, y], or the name of a block or of a node."""
    vector: tuple[Force, Force]
    where: str | None = None
    """The block, where several are there."""


class RigidFooting(_Load):
    """A rigid footing that presses along a direction without turning."""

    maker: ClassVar[str] = "la.RigidFooting"
    load: Literal["rigid-footing"]
    where: Where
    direction: tuple[Number, Number]
    pressure: Stress | None = None
    """Mean pressure; 1 Pa if left out."""
    rough: StrictBool | None = None


class WaterTable(Entry):
    """Water at rest below a height."""

    maker: ClassVar[str] = "la.WaterTable"
    height: Length
    unit_weight: UnitWeight | None = None


def _water(given: Any) -> str:
    if not isinstance(given, dict):
        return "~uniform"
    if {"value", "gradient"} & set(given):
        return "~linear"
    return "~levels" if {"levels", "values"} & set(given) else "~table"


class PorePressure(_Load):
    """Water in the pores of a body."""

    maker: ClassVar[str] = "la.PorePressure"
    load: Literal["pore-pressure"]
    pressure: Annotated[
        Annotated[WaterTable, Tag("~table")]
        | Annotated[Stress, Tag("~uniform")]
        | Annotated[Linear, Tag("~linear")]
        | Annotated[ByLevel, Tag("~levels")],
        Discriminator(_water),
    ]


class StandingWater(_Load):
    """Free water on a boundary."""

    maker: ClassVar[str] = "la.StandingWater"
    load: Literal["standing-water"]
    where: Where
    pressure: WaterTable


Load = Annotated[
    Traction
    | Pressure
    | Weight
    | BodyForce
    | PointForce
    | RigidFooting
    | PorePressure
    | StandingWater,
    Field(discriminator="load"),
]
