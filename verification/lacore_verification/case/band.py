"""Allowed errors of results, with reasons: bands, brackets, orders of refinement."""

from __future__ import annotations  # Annotations are not evaluated, so they do not load lacore.

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

SOLVER = 1e-6  # relative: tolerance of the certificate, which is the error of a certified value


# relative: the exact mechanism lies in the velocity space, so only the solver's error remains
EXACT = 1e-5

BRACKET = "bracket"
"""Name used as coupling in runs that compute proven bounds of a case."""

PROVEN = 1e-9
"""Relative round-off of a proven load factor, with two digits in reserve.

Residuals are at 1e-12 of all loads, and round-off in elements is about ten times that in sums.
"""


@dataclass(frozen=True)
class Band:
    """Allowed relative discretisation error, with the reason.

    Attributes:
        below, above: allowed error below and above the reference, both >= 0.
        reason: their derivation.
        scale: load factor of the size of the dead loads. Their errors affect a reference that is
            small compared with them, or 0: `below` and `above` are relative to the larger one.
    """

    below: float
    above: float
    reason: str
    scale: float = 0.0

    @property
    def wrong(self) -> str:
        """Why nothing can be assessed with it; empty if it is valid."""
        if all(isfinite(own) and own >= 0 for own in (self.below, self.above, self.scale)):
            return ""
        return f"a band of -{self.below:g} ... +{self.above:g}, scale {self.scale:g}, is none"

    def size(self, value: float) -> float:
        """Return the scale of the band for a value; 0 for an infinite one."""
        return max(abs(value), self.scale) if isfinite(value) else 0.0


@dataclass(frozen=True)
class Convergence:
    """Relative error as measured under refinement, ``coefficient * elements**-order``.

    Attributes:
        coefficient, order: fitted with the exact backend on meshes graded like those of the case.
        fitted: meshes and errors of the fit, for the report.
        safety: factor on the fit: results scatter about a fit, other meshes are not nested.
    """

    coefficient: float
    order: float
    fitted: str
    safety: float = 1.3

    def error(self, elements: int) -> float:
        """Return the fitted relative error of a mesh."""
        return float(self.coefficient * elements**-self.order)

    def strict(self, elements: int) -> Band:
        """Return the band of a strict upper bound: never below the reference."""
        return Band(
            below=SOLVER,
            above=self.safety * self.error(elements),
            reason=f"A strict upper bound (vertex rule, exact geometry): never below the reference"
            f" by more than the solver tolerance {SOLVER:g}. {self._fit(elements)}",
        )

    def two_sided(self, elements: int, why: str) -> Band:
        """Return the band of a value that is not a bound."""
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
    """Return the band of a case whose exact mechanism lies in the velocity space of every mesh."""
    return Band(
        below=EXACT,
        above=EXACT,
        reason=f"Exact on every mesh: {why} The remaining error is that of the solver, {EXACT:g}.",
    )


def rigid(dead: float) -> Band:
    """Return the band of rigid blocks and frames, which have no discretisation error.

    Args:
        dead: load factor at which the live load is as large as the dead load.
    """
    return Band(
        below=SOLVER,
        above=SOLVER,
        reason=f"Rigid bodies are exact: the remaining error is what the certificate admits,"
        f" {SOLVER:g} of the load factor or, if larger, of the dead loads.",
        scale=dead,
    )


@dataclass(frozen=True)
class Order:
    """Required order of convergence under refinement.

    Attributes:
        meshes: at least four sizes, coarse to fine: keyword arguments of `Case.build`.
        expected: p of ``error ~ elements**-p``, from a regression over the ladder.
        tolerance: allowed error of p.
        reason: origin of both.
    """

    meshes: Sequence[Mapping[str, Any]]
    expected: float
    tolerance: float
    reason: str

    def holds(self, order: float) -> bool:
        """Return whether a measured order is the expected one; False for NaN."""
        return abs(order - self.expected) <= self.tolerance


@dataclass(frozen=True)
class Bracketing:
    """Requirements on proven lower and upper load factors of a case.

    Attributes:
        target_width: required value of ``(upper - lower)/mean``.
        max_elements: limit for each mesh.
        mesh: level to start from; empty for the first one.
        below, above: how far straight edges instead of curved ones may move the load factor
            from the reference, relative; both 0 with exact geometry.
        reason: their origin; required if one is not 0.
    """

    target_width: float = 0.01
    max_elements: int = 6000
    mesh: str = ""
    below: float = 0.0
    above: float = 0.0
    reason: str = ""

    @property
    def straightened(self) -> bool:
        """Whether the effect of straight edges is given."""
        return self.below > 0 or self.above > 0
