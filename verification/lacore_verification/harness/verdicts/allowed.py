"""Values that the reference and the band of a case allow, and distances from the reference."""

from dataclasses import dataclass
from math import inf, isfinite, nan
from typing import Any

from lacore_verification.case import Band, Reference


@dataclass(frozen=True)
class Allowed:
    """Interval that must contain a result, ends included."""

    low: float = -inf
    high: float = inf

    def holds(self, value: float) -> bool:
        """Return whether a value is inside; False for NaN."""
        return self.low <= value <= self.high

    def __str__(self) -> str:
        return f"[{self.low:.7g}, {self.high:.7g}]"


def allowed_values(reference: Reference, band: Band) -> Allowed:
    """Return load factors that are right: those of a reference, widened by the band."""
    low, high = reference.low, reference.high
    if not reference.complete:
        low, high = -inf, inf if reference.associated is None else reference.associated
    return Allowed(low - band.below * band.size(low), high + band.above * band.size(high))


def upper_values(reference: Reference, band: Band) -> Allowed:
    """Return right values of upper bounds of every Coulomb load factor (T14)."""
    top = reference.low if reference.up_to is None else reference.up_to
    return Allowed(low=top - band.below * band.size(top))


def lower_values(reference: Reference, band: Band) -> Allowed:
    """Return right values of lower bounds of every Coulomb load factor (T14)."""
    bottom = reference.value + reference.half_width
    return Allowed(high=bottom + band.above * band.size(bottom))


def cannot_judge(reference: Reference, band: Band) -> str:
    """Return why a reference and a band would accept anything, or nothing; empty otherwise."""
    return reference.wrong or band.wrong


def about(reference: Reference) -> dict[str, Any]:
    """Return columns of a reference."""
    up_to = nan if reference.up_to is None else reference.up_to
    return {"reference": reference.value, "reference_to": up_to, "expected": reference.text}


def distance(value: float, reference: Reference, band: Band) -> float:
    """Return the relative distance from a reference; NaN without a value, or for another state.

    A load factor above the associated one belongs to no Coulomb state (T14). Its distance is that
    from the associated one.
    """
    nearest, most = reference.value, reference.associated
    if reference.up_to is not None:
        nearest = min(max(value, nearest), reference.up_to)
        if not (reference.complete or reference.low <= value <= reference.high):
            if most is None or not value > most:
                return nan
            nearest = most
    size = abs(nearest) or band.scale
    return (value - nearest) / size if isfinite(nearest) and size > 0 else nan
