"""Meshes: from a file, or of a shape."""

from pathlib import Path as File
from typing import Annotated, Any, ClassVar, Literal

from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    StrictBool,
    Tag,
    ValidationInfo,
    model_validator,
)

from lacore.files.problem.calls import Call
from lacore.files.problem.places import Path
from lacore.files.problem.schema.entry import Entry
from lacore.files.problem.schema.values import (
    Count,
    FileUnit,
    Interval,
    Length,
    Number,
    Point,
    Whole,
    refused,
)

FOLDER = "folder"
"""Key of a validation context: the folder of the problem file."""
_CELLS = 100_000


def _beside(given: str, info: ValidationInfo) -> str:
    # Missing names, or invalid bytes, are rejected when the file is read.
    return str((info.context or {}).get(FOLDER, File()) / given)


NamedFile = Annotated[str, AfterValidator(_beside)]
"""The path of a file, from the folder of the problem file."""


class MeshFile(Entry):
    """A mesh of gmsh, of another program, or saved by lacore; the path is relative to this file."""

    maker: ClassVar[str] = "la.meshes.read"
    file: NamedFile
    surface: str | None = None
    """Physical group of the triangles to read."""
    merge: Number | None = None
    unit: FileUnit | None = None
    """Unit of the coordinates; m if left out."""
    elements: Literal["triangles"] | None = None
    """Triangles: cut quadrilaterals in two, and replace curved edges by chords."""

    @model_validator(mode="before")
    @classmethod
    def _no_shape(cls, given: Any) -> Any:
        if isinstance(given, dict) and "shape" in given:
            raise refused("is given in addition to a file", "give one of the two", "shape")
        return given

    def arguments(self, at: Path) -> dict[str, Any]:
        """Return its arguments, see `Entry.arguments`."""
        given = super().arguments(at)
        del given["file"]
        return {"path": File(self.file), **given}

    def call(self, at: Path) -> Any:
        """Return its call, see `Entry.call`."""
        saved = self.file.lower().endswith(".npz")
        maker = "la.meshes.load" if saved else self.maker
        return Call(maker, self.arguments(at), at, {"path": (*at, "file")})

    @model_validator(mode="after")
    def _known(self) -> "MeshFile":
        if self.file.lower().endswith(".npz"):
            for name in ("surface", "merge", "unit", "elements"):
                if getattr(self, name) is not None:
                    raise refused("does not apply to .npz files", "leave it out", name)
        return self


class _Shape(Entry):
    tag: ClassVar[str] = "shape"
    cells: ClassVar[tuple[str, str]] = ("nx", "ny")

    @model_validator(mode="after")
    def _few(self) -> "_Shape":
        first, second = (getattr(self, name) for name in self.cells)
        if first * second > _CELLS:
            raise refused(
                f"with {self.cells[1]} = {second} these are {first * second} cells",
                f"give at most {_CELLS} cells; a bracket refines the mesh where needed",
                self.cells[0],
            )
        return self


class Rectangle(_Shape):
    """Triangles in an upright rectangle; boundaries left, right, bottom, top."""

    maker: ClassVar[str] = "la.meshes.rectangle"
    shape: Literal["rectangle"]
    x: Interval
    y: Interval
    nx: Count
    ny: Count
    crossed: StrictBool | None = None
    grade_x: tuple[Length, Number] | None = None
    """[at, largest per smallest]."""
    grade_y: tuple[Length, Number] | None = None
    """[at, largest per smallest]."""


class Quadrilaterals(_Shape):
    """Quadrilaterals in an upright rectangle, for the space q2."""

    maker: ClassVar[str] = "la.meshes.quadrilaterals"
    shape: Literal["quadrilaterals"]
    x: Interval
    y: Interval
    nx: Count
    ny: Count
    grade_x: tuple[Length, Number] | None = None
    grade_y: tuple[Length, Number] | None = None


class Fan(_Shape):
    """A rectangle of triangles around a point, such as the edge of a footing."""

    maker: ClassVar[str] = "la.meshes.fan"
    cells: ClassVar[tuple[str, str]] = ("sectors", "rings")
    shape: Literal["fan"]
    x: Interval
    y: Interval
    at: Point
    sectors: Annotated[int, Whole(4)]
    rings: Count
    grade: Number | None = None
    crossed: StrictBool | None = None


class Layered(_Shape):
    """A rectangle of level layers, which are its regions; boundaries left, right, bottom, top."""

    maker: ClassVar[str] = "la.meshes.layered"
    shape: Literal["layered"]
    x: Interval
    layers: dict[str, Interval]
    """From where to where in y, by name."""
    nx: Count
    ny: Count
    """Cells in all of the height."""
    crossed: StrictBool | None = None
    grade_x: tuple[Length, Number] | None = None
    """[At, largest cell per smallest]."""


class QuarterRing(_Shape):
    """A quarter of a ring; boundaries bore, outside, x_axis, y_axis."""

    maker: ClassVar[str] = "la.meshes.quarter_ring"
    cells: ClassVar[tuple[str, str]] = ("n_radial", "n_angular")
    shape: Literal["quarter-ring"]
    inner: Length
    outer: Length
    n_radial: Count
    n_angular: Count
    crossed: StrictBool | None = None
    grade: Number | None = None


class Patch(_Shape):
    """A convex quadrangle with anticlockwise `corners`, and `nx` cells along its first side."""

    maker: ClassVar[str] = "la.meshes.Patch"
    tag: ClassVar[str] = ""
    corners: tuple[Point, Point, Point, Point]
    nx: Count
    ny: Count
    grade_x: tuple[Number, Number] | None = None
    """[At which share of the side, largest cell per smallest]."""
    grade_y: tuple[Number, Number] | None = None
    name: str | None = None
    """Name of its region."""


class Patches(Entry):
    """Quadrangles that share whole sides: slopes, layers; boundaries left, right, bottom, top."""

    maker: ClassVar[str] = "la.meshes.patches"
    tag: ClassVar[str] = "shape"
    shape: Literal["patches"]
    parts: tuple[Patch, ...]
    crossed: StrictBool | None = None


def _kind(given: Any) -> str:
    return "~file" if isinstance(given, dict) and "file" in given else "~shape"


Shape = Annotated[
    Rectangle | Quadrilaterals | Fan | QuarterRing | Layered | Patches, Field(discriminator="shape")
]
Mesh = Annotated[
    Annotated[MeshFile, Tag("~file")] | Annotated[Shape, Tag("~shape")], Discriminator(_kind)
]
"""``{ file = "soil.msh" }``, or a shape with its numbers."""
