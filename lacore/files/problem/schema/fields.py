"""Strengths, angles, pressures and weights that vary from place to place."""

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
    """`value` at a place `at` (the origin, if left out), and its `gradient` by x and y."""

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
    """The same of a strength: levels may run through elements, which bounds take into account."""

    def call(self, at: Path) -> Any:
        """See `Entry.call`."""
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
"""A number, or as it varies from place to place."""


class LinearAngle(Linear):
    """The same of a friction angle."""

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
"""An angle, or as it varies from place to place."""
DilationAngle = Annotated[
    Annotated[Angle, Tag("~number")]
    | Annotated[LinearAngle, Tag("~linear")]
    | Annotated[AngleByLevel, Tag("~levels")],
    Discriminator(_kind),
]


class LinearWeight(Linear):
    """The same per volume: a weight or another force."""

    value: UnitWeight
    gradient: tuple[WeightSlope, WeightSlope]

    def times(self, factor: float) -> "LinearWeight":
        """As a component of a force."""
        x, y = self.gradient
        gradient = (factor * x, factor * y)
        return self.model_copy(update={"value": factor * self.value, "gradient": gradient})


class WeightByLevel(ByLevel):
    """Weights or other forces per volume at heights y, linear between them."""

    values: tuple[UnitWeight, ...]

    def times(self, factor: float) -> "WeightByLevel":
        """As a component of a force."""
        return self.model_copy(update={"values": tuple(factor * own for own in self.values)})


Density = Annotated[
    Annotated[UnitWeight, Tag("~number")]
    | Annotated[LinearWeight, Tag("~linear")]
    | Annotated[WeightByLevel, Tag("~levels")],
    Discriminator(_kind),
]
"""A force per volume: a number, or as it varies from place to place."""


def times(density: float | LinearWeight | WeightByLevel, factor: float) -> Any:
    """A component of a force per volume; none is 0."""
    if factor == 0:
        return 0.0
    return factor * density if isinstance(density, float) else density.times(factor)
