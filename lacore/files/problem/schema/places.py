"""Parts of boundaries, by name or by numbers."""

from dataclasses import replace
from typing import Annotated, Any, ClassVar

from pydantic import Discriminator, Field, Tag

from lacore.files.problem.calls import Own
from lacore.files.problem.places import Path
from lacore.files.problem.schema.entry import Entry
from lacore.files.problem.schema.values import End, Length, Number, Point

DRAWING = "drawing"
"""Part of the key of a drawing, after the name of its body."""


def _extent(given: Any) -> str:
    return "~interval" if isinstance(given, list | tuple) else "~number"


Extent = Annotated[
    Annotated[Length, Tag("~number")] | Annotated[tuple[End, End], Tag("~interval")],
    Discriminator(_extent),
]


class Box(Entry):
    """Places in a box, or on an upright or level line."""

    maker: ClassVar[str] = "la.Within"
    x: Extent | None = None
    """A number, or [least, greatest], which may be inf."""
    y: Extent | None = None
    """A number, or [least, greatest], which may be inf."""


class Line(Entry):
    """Places on a straight line between two points."""

    maker: ClassVar[str] = "la.Along"
    start: Point = Field(alias="from")
    end: Point = Field(alias="to")

    def call(self, at: Path) -> Any:
        """Return its value, see `Entry.call`."""
        made = super().call(at)
        return type(made)(
            made.maker,
            made.arguments,
            at,
            {"start": (*at, "from"), "end": (*at, "to")},
        )


class OfLayer(Entry):
    """Blocks of a drawing, by their layer."""

    layer: str

    def call(self, at: Path) -> Any:
        """Return its value, see `Entry.call`; `of_body` adds the drawing."""
        return Own(("", DRAWING), "named", {"layer": self.layer}, (*at, "layer"))


def of_body(where: Any, body: str, entry: Path) -> Any:
    """Return a place as part of calls, on a body that an entry of the file names."""
    if not isinstance(where, Own):
        return where
    why = f"{body!r} is not a drawing, so its blocks have no layers"
    fix = "name its blocks: where = [ ... ]"
    return replace(where, thing=(body, DRAWING), entry=entry, unless=(why, fix))


class HalfPlane(Entry):
    """Places on that side of a line through `point` that `normal` points to."""

    maker: ClassVar[str] = "la.Beyond"
    point: Point
    normal: tuple[Number, Number]


def _part(given: Any) -> str:
    return "~half" if isinstance(given, dict) and {"point", "normal"} & set(given) else "~box"


def _kind(given: Any) -> str:
    if isinstance(given, dict):
        keys = set(given)
        own = {"~line": {"from", "to"}, "~half": {"point", "normal"}, "~layer": {"layer"}}
        return next((kind for kind, names in own.items() if names & keys), "~box")
    return "~names" if isinstance(given, list | tuple) else "~name"


def _place(given: Any) -> str:
    return "~line" if isinstance(given, dict) and {"from", "to"} & set(given) else "~box"


Place = Annotated[
    Annotated[Box, Tag("~box")] | Annotated[Line, Tag("~line")],
    Discriminator(_place),
]
Part = Annotated[
    Annotated[Box, Tag("~box")] | Annotated[HalfPlane, Tag("~half")], Discriminator(_part)
]
"""A region, by numbers."""
Where = Annotated[
    Annotated[str, Tag("~name")]
    | Annotated[tuple[str, ...], Tag("~names")]
    | Annotated[Box, Tag("~box")]
    | Annotated[Line, Tag("~line")]
    | Annotated[HalfPlane, Tag("~half")]
    | Annotated[OfLayer, Tag("~layer")],
    Discriminator(_kind),
]
"""A boundary by its name, blocks or nodes by their names or layer, or places by numbers."""


def _blocks(given: Any) -> str:
    return "~layer" if isinstance(given, dict) else "~name" if isinstance(given, str) else "~names"


Blocks = Annotated[
    Annotated[str, Tag("~name")]
    | Annotated[tuple[str, ...], Tag("~names")]
    | Annotated[OfLayer, Tag("~layer")],
    Discriminator(_blocks),
]
"""Blocks or regions by their names, or the layer of blocks."""
