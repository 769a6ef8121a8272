"""Supports, interfaces and loads."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, StrictBool, Tag, model_validator

from lacore.files.problem.calls import Call, Own
from lacore.files.problem.places import Path
from lacore.files.problem.schema.entry import Entry, node
from lacore.files.problem.schema.fields import ByLevel, Density, Linear, times
from lacore.files.problem.schema.materials import Friction
from lacore.files.problem.schema.places import DRAWING, Blocks, Where, of_body
from lacore.files.problem.schema.values import (
    Force,
    Length,
    LineLoad,
    Number,
    Point,
    Stress,
    UnitWeight,
    refused,
)


class Support(Entry):
    """Velocities held at zero."""

    maker: ClassVar[str] = "la.Fix"
    body: str
    where: Where
    components: str | None = None
    """x, y, xy (if left out), normal, tangential; of nodes of frames rotation, clamped."""

    def arguments(self, at: Path) -> dict[str, Any]:
        """Return its arguments, see `Entry.arguments`."""
        given = super().arguments(at)
        return given | {"where": of_body(given["where"], self.body, at)}


class Side(Entry):
    """A part of the boundary of a body."""

    body: str
    where: Where

    def call(self, at: Path) -> Any:
        """Return its value, see `Entry.call`."""
        return self.body, of_body(node(self.where, (*at, "where")), self.body, at)


class Plane(Entry):
    """A rigid plane: a point on it, and its normal towards the body."""

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
        """Return its arguments, see `Entry.arguments`."""
        given = super().arguments(at)
        if self.master == "obstacle":
            given["master"] = Call("la.RigidObstacle", {}, (*at, "master"))
        return given


class _Load(Entry):
    tag: ClassVar[str] = "load"
    body: str
    case: str | None = None
    """Name of the load case, or of the component of an envelope, that a reference load is of."""

    @property
    def several(self) -> str:
        """Name of the loads that it becomes, if there are several."""
        return ""

    def arguments(self, at: Path) -> dict[str, Any]:
        """Return its arguments, see `Entry.arguments`."""
        given = super().arguments(at)
        given.pop("case", None)
        if "where" in given:
            given["where"] = of_body(given["where"], self.body, at)
        return given


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
    """Weight, downwards along y unless a direction is given."""

    maker: ClassVar[str] = "la.BodyForce"
    load: Literal["weight"]
    unit_weight: Density | None = None
    """May be left out for a drawing whose layers have densities."""
    where: Blocks | None = None
    """Blocks or regions; all if left out."""
    direction: tuple[Number, Number] | None = None
    """Of unit length; [0, -1] by default, [1, 0] is an acceleration of 1 g against x."""

    @property
    def several(self) -> str:
        """See `_Load.several`: one for each layer."""
        return "weight" if self.unit_weight is None else ""

    @model_validator(mode="after")
    def _of_all(self) -> "Weight":
        if self.unit_weight is None and self.where is not None:
            why = "without unit_weight, the densities give the weight of all blocks"
            raise refused(why, "add unit_weight, or leave it out", "where")
        weights = getattr(self.unit_weight, "values", (self.unit_weight,))
        if any(isinstance(weight, float) and weight < 0 for weight in weights):
            fix = "give a value >= 0; an upward load has direction = [0, 1]"
            raise refused("a weight below 0", fix, "unit_weight")
        return self

    def call(self, at: Path) -> Any:
        """Return its call, see `Entry.call`."""
        given = self.arguments(at)
        if self.unit_weight is None:
            why = f"missing: {self.body!r} is not a drawing whose layers have densities"
            unless = (why, "add unit_weight")
            place = (*at, "unit_weight")
            return Own((self.body, DRAWING), "weight", given, place, at, unless)
        place = (*at, "unit_weight")
        del given["unit_weight"]
        given["vector"] = tuple(
            node(times(self.unit_weight, part), place)
            for part in given.pop("direction", (0.0, -1.0))
        )
        return Call(self.maker, given, at, {"vector": place})


class Fill(_Load):
    """A fill on vaults or behind walls of blocks: its weight and its lateral pressure."""

    maker: ClassVar[str] = "la.masonry.fill"
    load: Literal["fill"]
    unit_weight: UnitWeight
    level: Length
    """Height y of its surface."""
    lateral: Number | None = None
    """Ratio of horizontal to vertical pressure; 0 if left out."""
    surcharge: Stress | None = None
    where: Where | None = None
    """Blocks or edges; those that face upwards and have no joint if left out."""

    @property
    def several(self) -> str:
        """See `_Load.several`: one for each edge."""
        return "fill"

    def call(self, at: Path) -> Any:
        """See `Entry.call`."""
        kinds = "block, blocks, wall, stack, arch or drawing"
        unless = ("it has no blocks that a fill could lie on", f"name a body of kind {kinds}")
        blocks = Own((self.body,), "", None, (*at, "body"), at, unless)
        given = self.arguments(at)
        arguments = {"body": given.pop("body"), "blocks": blocks, **given}
        return Call(self.maker, arguments, at, {"blocks": (*at, "body")})


class BodyForce(_Load):
    """A force per volume."""

    maker: ClassVar[str] = "la.BodyForce"
    load: Literal["body-force"]
    vector: tuple[Density, Density]
    where: Blocks | None = None
    """Blocks or regions; all if left out."""


def _at(given: Any) -> str:
    return "~point" if isinstance(given, list | tuple | dict) else "~name"


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


class PiezometricLine(Entry):
    """Water below a line of points, from left to right."""

    maker: ClassVar[str] = "la.PiezometricLine"
    points: tuple[Point, ...]
    unit_weight: UnitWeight | None = None


def _water(given: Any) -> str:
    if not isinstance(given, dict):
        return "~uniform"
    if "points" in given:
        return "~line"
    if {"value", "gradient"} & set(given):
        return "~linear"
    return "~levels" if {"levels", "values"} & set(given) else "~table"


def _still(given: Any) -> str:
    kind = _water(given)
    return "~table" if kind == "~uniform" else kind


class PorePressure(_Load):
    """Water in the pores of a body."""

    maker: ClassVar[str] = "la.PorePressure"
    load: Literal["pore-pressure"]
    pressure: Annotated[
        Annotated[WaterTable, Tag("~table")]
        | Annotated[PiezometricLine, Tag("~line")]
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
    pressure: Annotated[
        Annotated[WaterTable, Tag("~table")]
        | Annotated[PiezometricLine, Tag("~line")]
        | Annotated[Linear, Tag("~linear")]
        | Annotated[ByLevel, Tag("~levels")],
        Discriminator(_still),
    ]


Load = Annotated[
    Traction
    | Pressure
    | Weight
    | Fill
    | BodyForce
    | PointForce
    | RigidFooting
    | PorePressure
    | StandingWater,
    Field(discriminator="load"),
]
