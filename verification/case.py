"""What a verification case is: a problem, its reference, and how far a result may lie from it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any

import lacore as la

SOLVER = 1e-6  # relative: bar of the certificate, so what a certified value may be off by
EXACT = 1e-5  # relative: the exact mechanism lies in the velocity space, what is left is solving


@dataclass(frozen=True)
class Reference:
    """A load factor to compare with.

    Attributes:
        value: in units of the case.
        formula: as text.
        source: where it comes from.
        kind: ``exact``, ``exact, numerical`` (integrated to all digits given) or ``bracket``.
        half_width: the reference is ``value +- half_width``.
    """

    value: float
    formula: str
    source: str
    kind: str
    half_width: float = 0.0


@dataclass(frozen=True)
class Band:
    """Relative discretisation error that is allowed, and why.

    Attributes:
        below, above: of the reference, both >= 0.
        reason: how they were derived.
    """

    below: float
    above: float
    reason: str


@dataclass(frozen=True)
class Convergence:
    """Relative error as measured under refinement, ``coefficient * elements**-order``.

    Attributes:
        coefficient, order: fitted with the exact backend on meshes graded like those of the case.
        fitted: which meshes, which errors: for the reader of the report.
        safety: factor on the fit: results scatter about a fit, other meshes are not nested.
    """

    coefficient: float
    order: float
    fitted: str
    safety: float = 1.3

    def error(self, elements: int) -> float:
        """Fitted relative error of a mesh."""
        return float(self.coefficient * elements**-self.order)

    def strict(self, elements: int) -> Band:
        """Band of a strict upper bound: never below the reference."""
        return Band(
            below=SOLVER,
            above=self.safety * self.error(elements),
            reason=f"A strict upper bound (vertex rule, exact geometry): never below the reference"
            f" by more than the solver tolerance {SOLVER:g}. {self._fit(elements)}",
        )

    def two_sided(self, elements: int, why: str) -> Band:
        """Band of a value that is not a bound."""
        allowed = self.safety * self.error(elements)
        return Band(
            below=allowed, above=allowed, reason=f"Not a bound: {why} {self._fit(elements)}"
        )

    def _fit(self, elements: int) -> str:
        return (
            f"Error measured under refinement: {self.coefficient:.3g} N^-{self.order:.2f} for N"
            f" elements ({self.fitted}); allowed {self.safety:g} times that,"
            f" {100 * self.safety * self.error(elements):.3g} % at N = {elements}."
        )


def exact_patch(why: str) -> Band:
    """Band of a case whose exact mechanism lies in the velocity space of every mesh level."""
    return Band(
        below=EXACT,
        above=EXACT,
        reason=f"Exact on every mesh: {why} What is left is the solver, {EXACT:g}.",
    )


@dataclass(frozen=True)
class Variant:
    """One setting of a case's parameters.

    Attributes:
        name: unique in the case.
        parameters: keyword arguments of `Case.build`, `Case.reference` and `Case.band`.
        meshes: levels that are run by default.
    """

    name: str
    parameters: Mapping[str, float | bool]
    meshes: tuple[str, ...] = ("coarse", "medium")


@dataclass(frozen=True)
class Case:
    """A verification case.

    Attributes:
        id: unique.
        title: one line.
        tags: for finding it.
        unit: of the load factor.
        explanation: paragraphs; indented ones are a sketch.
        hand_calculation: how the reference is found with pencil and paper, line by line.
        meshes: levels, coarse to fine: keyword arguments of `build`.
        build: the problem, from those of a mesh level and a variant.
        reference: the reference of a variant.
        band: allowed error from the number of elements and the parameters of a variant.
        variants: settings, in the order of the report.
        sweep: parameter against which a figure of the load factor is drawn; empty for none.
    """

    id: str
    title: str
    tags: tuple[str, ...]
    unit: str
    explanation: str
    hand_calculation: str
    meshes: Mapping[str, Mapping[str, Any]]
    build: Callable[..., la.Problem]
    reference: Callable[..., Reference]
    band: Callable[..., Band]
    variants: tuple[Variant, ...]
    sweep: str = ""

    def problem(self, variant: Variant, mesh: str) -> la.Problem:
        """The problem of a variant on a mesh level."""
        return self.build(**self.meshes[mesh], **variant.parameters)


@dataclass(frozen=True)
class Allowed:
    """Values between which a result must lie, ends included."""

    low: float = -inf
    high: float = inf

    def holds(self, value: float) -> bool:
        """Whether a finite value lies inside."""
        return isfinite(value) and self.low <= value <= self.high


def allowed_values(reference: Reference, band: Band) -> Allowed:
    """Interval of a reference (positive) widened by its own uncertainty and by the band."""
    low, high = reference.value - reference.half_width, reference.value + reference.half_width
    return Allowed(low * (1 - band.below), high * (1 + band.above))
