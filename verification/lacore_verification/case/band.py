"""How far a result may lie from its reference, and why: bands, brackets, orders of refinement."""

from __future__ import annotations  # not evaluated: names of lacore in them load nothing

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

SOLVER = 1e-6  # relative: bar of the certificate, so what a certified value may be off by


EXACT = 1e-5  # relative: the exact mechanism lies in the velocity space, what is left is solving

BRACKET = "bracket"
"""What stands for a coupling in runs that put a case between two proven load factors."""

PROVEN = 1e-9
"""Relative: what round-off leaves of a proven load factor, with two digits in hand.

Residuals are at 1e-12 of all loads, and round-off in elements is some ten times that in sums.
"""


@dataclass(frozen=True)
class Band:
    """Relative discretisation error that is allowed, and why.

    Attributes:
        below, above: of the reference, both >= 0.
        reason: how they were derived.
        scale: load factor that stands for the size of the dead loads. They pass their errors on to
            a reference that is small against them, or 0: `below` and `above` are of the larger.
    """

    below: float
    above: float
    reason: str
    scale: float = 0.0

    @property
    def wrong(self) -> str:
        """Why nothing can be judged with it; empty where all is well."""
        if all(isfinite(own) and own >= 0 for own in (self.below, self.above, self.scale)):
            return ""
        return f"a band of -{self.below:g} ... +{self.above:g}, scale {self.scale:g}, is none"

    def size(self, value: float) -> float:
        """What the band of a value is relative to; an infinite one needs none."""
        return max(abs(value), self.scale) if isfinite(value) else 0.0


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


def rigid(dead: float) -> Band:
    """Band of rigid blocks and frames: there is no discretisation error.

    Args:
        dead: load factor at which the live load is as large as the dead load.
    """
    return Band(
        below=SOLVER,
        above=SOLVER,
        reason=f"Rigid bodies are exact: what is left is what the certificate lets through,"
        f" {SOLVER:g} of the load factor or, if larger, of the dead loads.",
        scale=dead,
    )


@dataclass(frozen=True)
class Order:
    """Order of convergence that refinement must show.

    Attributes:
        meshes: a ladder of at least four sizes, coarse to fine: keyword arguments of `Case.build`.
        expected: p of ``error ~ elements**-p``, from a regression over the ladder.
        tolerance: on p, either way.
        reason: where both come from.
    """

    meshes: Sequence[Mapping[str, Any]]
    expected: float
    tolerance: float
    reason: str

    def holds(self, order: float) -> bool:
        """Whether a measured order is the expected one; never NaN."""
        return abs(order - self.expected) <= self.tolerance


@dataclass(frozen=True)
class Bracketing:
    """How a case is put between a proven lower and a proven upper load factor.

    Attributes:
        target_width: of ``(upper - lower)/mean``, to be reached.
        max_elements: of each mesh.
        mesh: level to start from; empty for the first one.
        below, above: how far straight edges instead of curved ones may move the load factor
            from the reference, relative; both 0 with exact geometry.
        reason: where these come from; must be given where one is not 0.
    """

    target_width: float = 0.01
    max_elements: int = 6000
    mesh: str = ""
    below: float = 0.0
    above: float = 0.0
    reason: str = ""

    @property
    def straightened(self) -> bool:
        """Whether it is said what straight edges do."""
        return self.below > 0 or self.above > 0
