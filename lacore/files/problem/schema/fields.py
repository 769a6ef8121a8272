"""Strengths, angles, pressures and weights that vary with place."""

from itertools import pairwise
from typing import Annotated, Any, ClassVar

from pydantic import Discriminator, Tag

from lacore.files.problem.calls import Call
from lacore.files.problem.places import Path
from lacore.files.problem.schema.entry import Entry
from lacore.files.problem.schema.values import (
    Angle,
    AngleSlope,
    Length,
    Point,
    Slope,
    Steep,
    Stress,
    UnitWeight,
    WeightSlope,
)


class Linear(Entry):
    """`value` at a place `at` (by default the origin), and its `gradient` by x and y."""

    maker: ClassVar[str] = "la.Linear"
    value: Stress
    gradient: tuple[Slope, Slope]
    at: Point | None = None


class ByLevel(Entry):
    """Values at heights y, linear between them."""

    maker: ClassVar[str] = "la.ByLevel"
    levels: tuple[Length, ...]
    values: tuple[Stress, ...]


class StrengthByLevel(ByLevel):
    """Strengths at heights y, linear between them; levels may run through elements."""

    def call(self, at: Path) -> Any:
        """Return its call, see `Entry.call`."""
        table = super().call(at)
        pairs = sorted(zip(self.levels, self.values, strict=False))
        slopes = [
            abs((b - a) / (high - low)) for (low, a), (high, b) in pairwise(pairs) if high > low
        ]
        steepest = {"steepest": max(slopes)} if any(slopes) else {}
        return Call("la.Field", {"values": table, **steepest}, at)


def _kind(given: Any) -> str:
    if isinstance(given, dict):
        return "~levels" if {"levels", "values"} & set(given) else "~linear"
    return "~number"


Strength = Annotated[
    Annotated[Stress, Tag("~number")]
    | Annotated[Linear, Tag("~linear")]
    | Annotated[StrengthByLevel, Tag("~levels")],
    Discriminator(_kind),
]
"""A number, or a function of place."""


class LinearAngle(Linear):
    """`value` of a friction angle at a place `at`, and its `gradient` by x and y."""

    value: Angle
    gradient: tuple[AngleSlope, AngleSlope]


class AngleByLevel(StrengthByLevel):
    """Friction angles at heights y, linear between them."""

    values: tuple[Angle, ...]


FrictionAngle = Annotated[
    Annotated[Steep, Tag("~number")]
    | Annotated[LinearAngle, Tag("~linear")]
    | Annotated[AngleByLevel, Tag("~levels")],
    Discriminator(_kind),
]
"""An angle, or a function of place."""
DilationAngle = Annotated[
    Annotated[Angle, Tag("~number")]
    | Annotated[LinearAngle, Tag("~linear")]
    | Annotated[AngleByLevel, Tag("~levels")],
    Discriminator(_kind),
]


class LinearWeight(Linear):
    """`value` of a force per volume at a place `at`, and its `gradient` by x and y."""

    value: UnitWeight
    gradient: tuple[WeightSlope, WeightSlope]

    def times(self, factor: float) -> "LinearWeight":
        """Return it as a component of a force."""
        x, y = self.gradient
        gradient = (factor * x, factor * y)
        return self.model_copy(update={"value": factor * self.value, "gradient": gradient})


class WeightByLevel(ByLevel):
    """Weights or other forces per volume at heights y, linear between them."""

    values: tuple[UnitWeight, ...]

    def times(self, factor: float) -> "WeightByLevel":
        """Return it as a component of a force."""
        return self.model_copy(update={"values": tuple(factor * own for own in self.values)})


Density = Annotated[
    Annotated[UnitWeight, Tag("~number")]
    | Annotated[LinearWeight, Tag("~linear")]
    | Annotated[WeightByLevel, Tag("~levels")],
    Discriminator(_kind),
]
"""A force per volume: a number, or a function of place."""


def times(density: float | LinearWeight | WeightByLevel, factor: float) -> Any:
    """Return a component of a force per volume; none if it is 0."""
    if factor == 0:
        return 0.0
    return factor * density if isinstance(density, float) else density.times(factor)
