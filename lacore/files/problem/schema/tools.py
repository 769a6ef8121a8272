"""Rigid tools of an exact shape, `[tools.NAME]`."""

from math import radians
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag

from lacore.files.problem.calls import Call
from lacore.files.problem.places import Path
from lacore.files.problem.schema.conditions import Side
from lacore.files.problem.schema.entry import Entry
from lacore.files.problem.schema.materials import Friction
from lacore.files.problem.schema.values import Angle, AngleSlope, Length, Number, Point


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
    """Of its reference point, per travel; [0, 0] if left out."""
    turn: AngleSlope | None = None
    """Angle by which it turns, per travel, anticlockwise; 0 if left out."""
    about: Point | None = None
    """The reference point; the tip, the centre, the point of a plane or the centroid."""
    friction: Friction | None = None
    """0 if left out."""

    def call(self, at: Path) -> Call:
        """See `Entry.call`."""
        given = self.arguments(at)
        own = {name: given.pop(name) for name in self.shaped if name in given}
        if "turn" in given:
            given["turn"] = radians(given["turn"])
        made = Call(f"la.shapes.{self.shape}", own, at, {self.shape: at})
        return Call(self.maker, {"shape": made, **given}, at)


class WedgeTool(_Tool):
    """A wedge without end."""

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


class OutlineTool(_Tool):
    """A polygon, whose corners may be rounded."""

    shape: ClassVar[str] = "outline"
    shaped: ClassVar[tuple[str, ...]] = ("points", "rounding")
    tool: Literal["outline"]
    points: tuple[Point, ...]
    rounding: (
        Annotated[
            Annotated[Length, Tag("~all")] | Annotated[tuple[Length, ...], Tag("~each")],
            Discriminator(_radii),
        ]
        | None
    ) = None
    """Radius of all corners, or one radius per corner; 0 (sharp) if left out."""


Tool = Annotated[WedgeTool | DiscTool | PlaneTool | OutlineTool, Field(discriminator="tool")]
