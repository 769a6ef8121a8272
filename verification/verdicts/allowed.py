"""Values between which results must lie, from the reference and the band of a case."""

from dataclasses import dataclass
from math import inf

from verification.case import Band, Reference


@dataclass(frozen=True)
class Allowed:
    """Values between which a result must lie, ends included."""

    low: float = -inf
    high: float = inf

    def holds(self, value: float) -> bool:
        """Whether a value lies inside; never NaN."""
        return self.low <= value <= self.high

    def __str__(self) -> str:
        return f"[{self.low:.7g}, {self.high:.7g}]"


def allowed_values(reference: Reference, band: Band) -> Allowed:
    """Load factors that are right: those of a reference, widened by the band."""
    low, high = reference.low, reference.high
    if not reference.complete:
        low, high = -inf, inf if reference.associated is None else reference.associated
    return Allowed(low - band.below * band.size(low), high + band.above * band.size(high))


def upper_values(reference: Reference, band: Band) -> Allowed:
    """Values of what bounds every Coulomb load factor from above (T14)."""
    top = reference.low if reference.up_to is None else reference.up_to
    return Allowed(low=top - band.below * band.size(top))


def lower_values(reference: Reference, band: Band) -> Allowed:
    """Values of what bounds every Coulomb load factor from below (T14)."""
    bottom = reference.value + reference.half_width
    return Allowed(high=bottom + band.above * band.size(bottom))
