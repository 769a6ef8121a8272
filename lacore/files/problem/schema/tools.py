"""Rigid tools of an exact shape, `[tools.NAME]`."""

from dataclasses import replace
from math import radians
from pathlib import Path as File
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from lacore.files.problem.calls import Call
from lacore.files.problem.places import Path
from lacore.files.problem.schema.conditions import Side
from lacore.files.problem.schema.entry import Entry
from lacore.files.problem.schema.materials import Friction
from lacore.files.problem.schema.meshes import NamedFile
from lacore.files.problem.schema.values import (
    Angle,
    AngleSlope,
    FileUnit,
    Length,
    Number,
    Point,
    refused,
)


def _several(given: Any) -> str:
    return "~several" if isinstance(given, list | tuple) else "~one"


class _Tool(Entry):
    maker: ClassVar[str] = "la.Tool"
    tag: ClassVar[str] = "tool"
    shape: ClassVar[str]
    """The function of `la.shapes` that makes its shape."""
    shaped: ClassVar[tuple[str, ...]]
    """Keys that are the arguments of this function."""
    touches: Annotated[
        Annotated[Side, Tag("~one")] | Annotated[tuple[Side, ...], Tag("~several")],
        Discriminator(_several),
    ]
    """The boundaries that it may touch: { body, where }, or a list of these."""
    velocity: tuple[Number, Number] | None = None
    """Velocity of its reference point, per travel; [0, 0] by default."""
    turn: AngleSlope | None = None
    """Angle by which it turns, per travel, anticlockwise; 0 if left out."""
    about: Point | None = None
    """The reference point; the tip, the centre, the point of a plane or the centroid."""
    friction: Friction | None = None
    """0 if left out."""

    def call(self, at: Path) -> Call:
        """Return its call, see `Entry.call`."""
        given = self.arguments(at)
        own = {name: given.pop(name) for name in self.shaped if name in given}
        if "turn" in given:
            given["turn"] = radians(given["turn"])
        return Call(self.maker, {"shape": self._shape(own, at), **given}, at)

    def _shape(self, given: dict[str, Any], at: Path) -> Call:
        """Return the call for the shape from its keys."""
        return Call(f"la.shapes.{self.shape}", given, at, {self.shape: at})


class WedgeTool(_Tool):
    """An unbounded wedge."""

    shape: ClassVar[str] = "wedge"
    shaped: ClassVar[tuple[str, ...]] = ("tip", "half_angle", "axis")
    tool: Literal["wedge"]
    tip: Point
    half_angle: Angle
    """Between the axis and a face."""
    axis: tuple[Number, Number] | None = None
    """Direction from the tip into the wedge; [0, 1] if left out."""


class DiscTool(_Tool):
    """A disc: a round punch or a roll."""

    shape: ClassVar[str] = "disc"
    shaped: ClassVar[tuple[str, ...]] = ("centre", "radius")
    tool: Literal["disc"]
    centre: Point
    radius: Length


class PlaneTool(_Tool):
    """A plane: its normal points towards the bodies."""

    shape: ClassVar[str] = "plane"
    shaped: ClassVar[tuple[str, ...]] = ("point", "normal")
    tool: Literal["plane"]
    point: Point
    normal: tuple[Number, Number]


def _radii(given: Any) -> str:
    return "~each" if isinstance(given, list | tuple) else "~all"


class DrawnOutline(Entry):
    """A closed outline in a DXF or GeoJSON file."""

    maker: ClassVar[str] = "la.shapes.read_outline"
    file: NamedFile
    layer: str | None = None
    """Layer of the outline; by default the only layer of the drawing."""
    unit: FileUnit | None = None
    """Unit of the drawing, instead of that in the file."""
    sagitta: Length | None = None
    """Largest distance of chords from curves; by default curves are rejected."""

    def call(self, at: Path) -> Call:
        """Return its call, see `Entry.call`."""
        given = self.arguments(at)
        arguments = {"path": File(given.pop("file")), **given}
        return Call(self.maker, arguments, at, {"path": (*at, "file")})


class OutlineTool(_Tool):
    """A polygon, whose corners may be rounded."""

    shape: ClassVar[str] = "outline"
    shaped: ClassVar[tuple[str, ...]] = ("points", "outline", "rounding")
    tool: Literal["outline"]
    points: tuple[Point, ...] | None = None
    """Its corners; alternatively give `outline`."""
    outline: DrawnOutline | None = None
    """A file with its corners."""
    rounding: (
        Annotated[
            Annotated[Length, Tag("~all")] | Annotated[tuple[Length, ...], Tag("~each")],
            Discriminator(_radii),
        ]
        | None
    ) = None
    """Radius of all corners, or one radius per corner; 0 (sharp) if left out."""

    @model_validator(mode="after")
    def _one(self) -> "OutlineTool":
        if self.points is None and self.outline is None:
            raise refused("missing", "add points, or outline = { file = ... }", "points")
        if self.points is not None and self.outline is not None:
            raise refused("the points are given, too", "leave one of the two out", "outline")
        return self

    def _shape(self, given: dict[str, Any], at: Path) -> Call:
        """Return the call for the shape, see `_Tool`."""
        drawn: Call | None = given.pop("outline", None)
        if drawn is None:
            return super()._shape(given, at)
        places = {**drawn.places, "rounding": (*at, "rounding")}
        return replace(drawn, arguments={**drawn.arguments, **given}, places=places)


Tool = Annotated[WedgeTool | DiscTool | PlaneTool | OutlineTool, Field(discriminator="tool")]
