"""Bodies: continua, rigid blocks, frames."""

from math import radians
from pathlib import Path as File
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, StrictBool, Tag, model_validator

from lacore.files.problem.calls import Call
from lacore.files.problem.places import Path
from lacore.files.problem.schema.entry import Entry, node
from lacore.files.problem.schema.materials import Friction, Materials
from lacore.files.problem.schema.meshes import Mesh, NamedFile
from lacore.files.problem.schema.places import Part, Place
from lacore.files.problem.schema.sections import Section, section
from lacore.files.problem.schema.values import (
    Count,
    FileUnit,
    Length,
    MassDensity,
    Moment,
    Number,
    Point,
    Turn,
    Whole,
    refused,
)

_MOST = 20_000  # number of blocks of a wall
_Few = Annotated[int, Whole(most=_MOST)]
_From0 = Annotated[int, Whole(0)]


class Continuum(Entry):
    """Deformable body with a mesh and a material."""

    maker: ClassVar[str] = "la.Body"
    tag: ClassVar[str] = "kind"
    kind: Literal["continuum"]
    mesh: Mesh
    material: Materials
    kinematics: str | None = None
    """Plane_strain, plane_stress or axisymmetric."""
    space: str | None = None
    """Velocity space; p2-vertex gives strict bounds."""
    geometry: str | None = None
    """Exact, or approximated where curves are not."""
    boundaries: dict[str, Place] | None = None
    """Names for parts of the boundary."""
    regions: dict[str, Part] | None = None
    """Names for parts of the mesh, for a material each."""

    def call(self, at: Path) -> Any:
        """Return its call, see `Entry.call`."""
        given = self.arguments(at)
        mesh, criterion = given.pop("mesh"), given.pop("material")
        named = {"boundaries": given.pop("boundaries", None), "regions": given.pop("regions", None)}
        parts: dict[str, Any] = {name: own for name, own in named.items() if own}
        if parts:
            places = {name: (*at, name) for name in ("mesh", *parts)}
            first = (*at, next(iter(parts)))
            mesh = Call("la.meshes.named", {"mesh": mesh, **parts}, first, places)
        arguments = {"mesh": mesh, "criterion": criterion, **given}
        return Call(self.maker, arguments, at, {"criterion": (*at, "material")})


class JointFriction(Entry):
    """Different friction of the joint between two blocks, or two layers."""

    between: tuple[str, str]
    friction: Friction


def _with_joints(
    given: dict[str, Any], joints: tuple[JointFriction, ...], at: Path
) -> dict[str, Any]:
    """Return the arguments with the laws of joints by pairs."""
    if given.pop("joints", None):
        given["joint_friction"] = {
            one.between: node(one.friction, (*at, "joints", place, "friction"))
            for place, one in enumerate(joints)
        }
    return given


class _Blocks(Entry):
    tag: ClassVar[str] = "kind"
    friction: Friction
    joints: tuple[JointFriction, ...] = ()

    def call(self, at: Path) -> Any:
        """Return its call, see `Entry.call`."""
        given = _with_joints(self.arguments(at), self.joints, at)
        return Call(self.maker, given, at, {"joint_friction": (*at, "joints")})


class Layer(Entry):
    """Material of the blocks of a layer of a drawing."""

    maker: ClassVar[str] = "la.masonry.Layer"
    friction: Friction
    density: MassDensity
    """0 for blocks that are held."""


class Drawing(Entry):
    """Rigid blocks of a DXF or GeoJSON file, or of an assembly of compas."""

    maker: ClassVar[str] = "la.masonry.read"
    tag: ClassVar[str] = "kind"
    kind: Literal["drawing"]
    file: NamedFile
    layers: dict[str, Layer]
    """Layers of the drawing by name; others are ignored."""
    unit: FileUnit | None = None
    """Unit of the drawing, instead of that in the file."""
    snap: Length | None = None
    """Vertices nearer than this are one; 1e-5 of the size of the drawing if left out."""
    sagitta: Length | None = None
    """Largest distance of chords from curves; by default curves are rejected."""
    gap: Length | None = None
    """Width of mortar joints that are drawn as gaps."""
    openings: tuple[str, ...] = ()
    """Layers of the outlines of windows and doors."""
    joints: tuple[JointFriction, ...] = ()
    """Between two layers; the weaker one of both if left out."""

    def call(self, at: Path) -> Any:
        """Return its call, see `Entry.call`."""
        given = _with_joints(self.arguments(at), self.joints, at)
        arguments = {"path": File(given.pop("file")), **given}
        places = {"path": (*at, "file"), "joint_friction": (*at, "joints")}
        return Call(self.maker, arguments, at, places)


class Block(Entry):
    """One rigid block, named "block"."""

    maker: ClassVar[str] = "la.RigidBlock"
    tag: ClassVar[str] = "kind"
    kind: Literal["block"]
    outline: tuple[Point, ...]

    def call(self, at: Path) -> Any:
        """Return its call, see `Entry.call`."""
        outline = {"vertices": list(self.outline)}
        place = (*at, "outline")
        return Call(self.maker, outline, place, dict.fromkeys(("vertices", "blocks"), place))


class Blocks(_Blocks):
    """Rigid blocks by their polygons."""

    maker: ClassVar[str] = "la.BlockAssembly"
    kind: Literal["blocks"]
    blocks: dict[str, tuple[Point, ...]]
    tolerance: Length | None = None


class Opening(Entry):
    """A hole in a wall: `left` and `width` in blocks, `sill` and `height` in courses."""

    maker: ClassVar[str] = "la.masonry.Opening"
    left: Number
    width: Number
    sill: _From0
    height: Count


class Wall(_Blocks):
    """A wall in running bond on a base, with its lower left corner at the origin."""

    maker: ClassVar[str] = "la.masonry.running_bond"
    kind: Literal["wall"]
    wide: _Few | None = None
    """Blocks in a course."""
    courses: _Few | None = None
    first: str | None = None
    """The lowest course: full, or halves at both ends."""
    openings: tuple[Opening, ...] = ()
    rows: tuple[tuple[Number, ...], ...] | None = None
    """Alternative to wide and courses: widths, negative for openings."""
    block: Point | None = None
    """Width and height of a block."""
    base: StrictBool | None = None

    @model_validator(mode="after")
    def _either(self) -> "Wall":
        regular = [self.wide, self.courses]
        if self.rows is not None and (any(regular) or self.openings or self.first):
            raise refused("wide and courses are given, too", "give one of the two", "rows")
        if self.rows is None and None in regular:
            raise refused("has no size", "add wide and courses, or rows")
        if self.wide and self.courses and self.wide * self.courses > _MOST:
            many = f"these are {self.wide * self.courses} blocks"
            raise refused(many, f"give at most {_MOST}", "courses")
        return self

    def call(self, at: Path) -> Any:
        """Return its call, see `Entry.call`."""
        made = super().call(at)
        given = dict(made.arguments)
        bond = {
            name: given.pop(name)
            for name in ("wide", "courses", "openings", "first")
            if name in given
        }
        if bond:
            if "openings" in bond:
                bond["openings"] = list(bond["openings"])
            given = {"rows": Call("la.masonry.regular_bond", bond, at), **given}
        return Call(self.maker, given, at, made.places)


class Stack(_Blocks):
    """Blocks on top of each other, on a base."""

    maker: ClassVar[str] = "la.masonry.stack"
    kind: Literal["stack"]
    sizes: tuple[Point, ...]


class Arch(_Blocks):
    """A circular arch between springings "left" and "right", about x = 0."""

    maker: ClassVar[str] = "la.masonry.arch"
    kind: Literal["arch"]
    voussoirs: _Few
    inner_radius: Length
    thickness: Length
    embrace: Turn | None = None
    """Angle at the centre; 180 degrees if left out."""

    def arguments(self, at: Path) -> dict[str, Any]:
        """Return its arguments, see `Entry.arguments`."""
        given = super().arguments(at)
        if self.embrace is not None:
            given["embrace"] = float(f"{radians(self.embrace):.16g}")
        return given


class Frame(Entry):
    """Rigid bars with plastic hinges; forces and moments are those of the whole frame."""

    maker: ClassVar[str] = "la.Frame"
    tag: ClassVar[str] = "kind"
    kind: Literal["frame"]
    nodes: dict[str, Point]
    members: dict[str, tuple[str, str]]
    plastic_moment: (
        Annotated[
            Annotated[Moment, Tag("~one")] | Annotated[dict[str, Moment], Tag("~each")],
            Discriminator(lambda given: "~each" if isinstance(given, dict) else "~one"),
        ]
        | None
    ) = None
    """M_p of all members without a section, or of each by its name."""
    sections: dict[str, Section] | None = None
    """Sections of members by name, with interaction of axial force and moment."""
    releases: tuple[tuple[str, str], ...] = ()
    """[member, node] without moment."""
    tolerance: Length | None = None

    def arguments(self, at: Path) -> dict[str, Any]:
        """Return its arguments, see `Entry.arguments`."""
        given = super().arguments(at)
        if self.sections:
            named = {
                name: section(own, (*at, "sections", name)) for name, own in self.sections.items()
            }
            given["sections"] = named
        return given


Body = Annotated[
    Continuum | Block | Blocks | Wall | Stack | Arch | Drawing | Frame, Field(discriminator="kind")
]
