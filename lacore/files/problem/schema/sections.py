"""Cross-sections of members of frames."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Tag

from lacore.files.problem.calls import Call
from lacore.files.problem.places import Path
from lacore.files.problem.schema.entry import Entry
from lacore.files.problem.schema.values import Axial, Length, Moment, Stress, Strut, Whole

_MOST = 256  # sides: with 8, a rectangle's polygon is within 0.4 % of its curve


class _OfStress(Entry):
    """A section whose N-M curve is replaced by a polygon."""

    yield_stress: Stress
    layers: Annotated[int, Whole(1, _MOST)] | None = None
    """Sides of the polygon between N = 0 and the squash load; 8 if left out."""
    polygon: Literal["inner", "outer"] | None = None
    """Inside the curve, which is safe, if left out."""


class Rolled(_OfStress):
    """A rolled section by its name, such as IPE 300 or HEA 200."""

    maker: ClassVar[str] = "la.sections.standard"
    name: str


class Rectangle(_OfStress):
    """A solid rectangle; it bends over its height."""

    maker: ClassVar[str] = "la.sections.rectangle"
    width: Length
    height: Length


class ISection(_OfStress):
    """An I-section with parallel flanges, bent about its strong axis."""

    maker: ClassVar[str] = "la.sections.i_section"
    height: Length
    width: Length
    web: Length
    """Thickness."""
    flange: Length
    """Thickness."""
    fillet: Length = 0.0
    """Radius between web and flange; 0 of welded ones."""

    def call(self, at: Path) -> Any:
        """Return its call, see `Entry.call`.

        Lacore names the fillet if web and flanges do not fit.
        """
        arguments = {"fillet": self.fillet} | self.arguments(at)
        places = {} if "fillet" in self.model_fields_set else {"fillet": (*at, "web")}
        return Call(self.maker, arguments, at, places)


class Bar(Entry):
    """A pin-ended strut: axial strength alone."""

    maker: ClassVar[str] = "la.sections.bar"
    tension: Strut
    """Strength; infinite if it never yields."""
    compression: Strut | None = None
    """Equal to tension by default; 0 for a cable."""


class Plastic(Entry):
    """A plastic moment, for any axial force."""

    maker: ClassVar[str] = "la.sections.plastic"
    plastic_moment: Moment
    hogging: Moment | None = None
    """Equal to the other sense by default."""


class Polygon(Entry):
    """Corners (N, M) of a yield polygon, its upper side, from compression, N < 0, to tension."""

    maker: ClassVar[str] = "la.sections.Section"
    corners: tuple[tuple[Axial, Moment], ...]
    name: str = ""
    lower: tuple[tuple[Axial, Moment], ...] | None = None
    """Lower side, likewise; the mirror image by default."""
    side: Literal["inner", "outer"] | None = None
    """Inside or around a yield curve; left out where the polygon is the yield surface itself."""
    other: tuple[tuple[Axial, Moment], ...] | None = None
    """Corners of the polygon on the other side of the curve."""


_KEYS = {
    "corners": "~polygon",
    "web": "~i",
    "flange": "~i",
    "fillet": "~i",
    "tension": "~bar",
    "compression": "~bar",
    "plastic_moment": "~plastic",
    "width": "~rectangle",
    "height": "~rectangle",
}


def _kind(given: Any) -> str:
    if not isinstance(given, dict):
        return "~word"
    return next((kind for key, kind in _KEYS.items() if key in given), "~rolled")


Section = Annotated[
    Annotated[Rolled, Tag("~rolled")]
    | Annotated[Rectangle, Tag("~rectangle")]
    | Annotated[ISection, Tag("~i")]
    | Annotated[Bar, Tag("~bar")]
    | Annotated[Plastic, Tag("~plastic")]
    | Annotated[Polygon, Tag("~polygon")]
    | Annotated[Literal["rigid"], Tag("~word")],
    Discriminator(_kind),
]


def section(given: Any, at: Path) -> Any:
    """Return a section as part of calls."""
    return Call("la.sections.rigid", {}, at) if given == "rigid" else given.call(at)
