"""Yield criteria and friction."""

from math import radians, tan
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Discriminator, Field, StrictBool, Tag, model_validator

from lacore.files.problem.calls import Call, Name
from lacore.files.problem.places import Path
from lacore.files.problem.schema.entry import Entry
from lacore.files.problem.schema.fields import DilationAngle, FrictionAngle, Strength
from lacore.files.problem.schema.values import Number, Steep, Stress, refused


class _Hardening(Entry):
    tag: ClassVar[str] = "law"


class Perfect(_Hardening):
    """No hardening."""

    maker: ClassVar[str] = "la.hardening.Perfect"
    law: Literal["perfect"]
    yield_stress: Stress


class LinearHardening(_Hardening):
    """Yield stress plus slope times strain."""

    maker: ClassVar[str] = "la.hardening.Linear"
    law: Literal["linear"]
    yield_stress: Stress
    slope: Stress


class Voce(_Hardening):
    """Hardening to a limit, `saturation`."""

    maker: ClassVar[str] = "la.hardening.Voce"
    law: Literal["voce"]
    yield_stress: Stress
    saturation: Stress
    rate: Number


class Swift(_Hardening):
    """A power law, strength (offset + strain)^exponent."""

    maker: ClassVar[str] = "la.hardening.Swift"
    law: Literal["swift"]
    strength: Stress
    offset: Number
    exponent: Number


class HardeningTable(_Hardening):
    """Measured points."""

    maker: ClassVar[str] = "la.hardening.Table"
    law: Literal["table"]
    strains: tuple[Number, ...]
    """Equivalent plastic, from 0."""
    stresses: tuple[Stress, ...]
    """Yield stresses in tension."""


Hardening = Annotated[
    Perfect | LinearHardening | Voce | Swift | HardeningTable, Field(discriminator="law")
]


class VonMises(Entry):
    """Metal, undrained clay: yield at a shear stress, or at a yield stress in tension."""

    maker: ClassVar[str] = "la.VonMises"
    tag: ClassVar[str] = "criterion"
    criterion: Literal["von-mises"]
    shear_strength: Strength | None = None
    yield_stress: Strength | None = None
    hardening: Hardening | None = None
    """Alternative to both: used along paths; a load factor is that of the initial yield stress."""


class MohrCoulomb(Entry):
    """Soil, rock, concrete: cohesion and friction."""

    maker: ClassVar[str] = "la.MohrCoulomb"
    tag: ClassVar[str] = "criterion"
    criterion: Literal["mohr-coulomb"]
    cohesion: Strength
    friction_angle: FrictionAngle
    tension_cutoff: Strength | None = None
    crushing: Strength | None = None
    dilation_angle: DilationAngle | None = None


class DruckerPrager(Entry):
    """A cone around the hydrostatic axis."""

    maker: ClassVar[str] = "la.DruckerPrager"
    tag: ClassVar[str] = "criterion"
    criterion: Literal["drucker-prager"]
    cohesion: Strength
    friction_angle: FrictionAngle
    match: str = "plane_strain"
    dilation_angle: DilationAngle | None = None


class Rankine(Entry):
    """Limits of the principal stresses: plain concrete, masonry."""

    maker: ClassVar[str] = "la.Rankine"
    tag: ClassVar[str] = "criterion"
    criterion: Literal["rankine"]
    tensile_strength: Strength
    compressive_strength: Strength | None = None


class NoTension(Entry):
    """Masonry as a continuum."""

    maker: ClassVar[str] = "la.NoTension"
    tag: ClassVar[str] = "criterion"
    criterion: Literal["no-tension"]
    compressive_strength: Strength | None = None


class MaximumShear(Entry):
    """Tresca's criterion."""

    maker: ClassVar[str] = "la.MaximumShear"
    tag: ClassVar[str] = "criterion"
    criterion: Literal["maximum-shear"]
    shear_strength: Strength


Material = Annotated[
    VonMises | MohrCoulomb | DruckerPrager | Rankine | NoTension | MaximumShear,
    Field(discriminator="criterion"),
]


def _regions(given: Any) -> str:
    tables = isinstance(given, dict) and given and all(isinstance(v, dict) for v in given.values())
    return "~regions" if tables else "~one"


Materials = Annotated[
    Annotated[Material, Tag("~one")] | Annotated[dict[str, Material], Tag("~regions")],
    Discriminator(_regions),
]
"""A material, or one for each region by its name."""


class FrictionLaw(Entry):
    """Friction by exactly one of mu, angle and limit."""

    mu: Number | None = None
    """Coefficient of Coulomb friction."""
    angle: Steep | None = None
    """Friction angle of Coulomb friction."""
    limit: Stress | None = None
    """Shear stress that slips at any pressure."""
    adhesion: Stress | None = None
    """Shear strength of Coulomb friction without pressure."""
    tension: Stress | None = None
    """Strength in tension of Coulomb friction."""
    associated: StrictBool = False
    """Whether sliding dilates, as bounds assume."""

    @model_validator(mode="after")
    def _one(self) -> "FrictionLaw":
        given = [name for name in ("mu", "angle", "limit") if getattr(self, name) is not None]
        if len(given) != 1:
            raise refused(
                "needs exactly one of mu, angle and limit", "give friction = { mu = 0.5 }"
            )
        for name in ("adhesion", "tension", "associated"):
            if getattr(self, name) and self.limit is not None:
                raise refused("applies to Coulomb friction only", "leave it out", name)
        if self.angle is not None and not 0 <= self.angle < 90:
            raise refused("not a friction angle", "give 0 to less than 90 degrees", "angle")
        return self

    def call(self, at: Path) -> Any:
        """Return its call, see `Entry.call`."""
        if self.limit is not None:
            return Call("la.Tresca", {"limit": self.limit}, at)
        if self.angle is not None:
            value, key = tan(radians(self.angle)), "angle"
        else:
            value, key = self.mu or 0.0, "mu"
        more = {name: getattr(self, name) for name in ("associated", "adhesion", "tension")}
        law: dict[str, Any] = {"mu": value} | {name: own for name, own in more.items() if own}
        return Call("la.Coulomb", law, at, {"mu": (*at, key)})


def _kind(given: Any) -> str:
    if isinstance(given, dict):
        return "~law"
    return "~word" if isinstance(given, str) else "~number"


def _named(word: str) -> Name:
    return Name(f"la.{word.upper()}")


Friction = Annotated[
    Annotated[Number, Tag("~number")]
    | Annotated[Literal["smooth", "stick", "bond"], AfterValidator(_named), Tag("~word")]
    | Annotated[FrictionLaw, Tag("~law")],
    Discriminator(_kind),
]
"""A coefficient, a law by its name, or one with numbers."""
