"""What must come out of a case: a load factor, an interval of them, or a status."""

from __future__ import annotations  # not evaluated: names of lacore in them load nothing

from dataclasses import dataclass
from math import inf, isclose, isfinite, isnan, nan

import lacore as la

UNKNOWN_KINDS = ("none", "no closed form", "unknown")
"""Kinds that say that nothing is known; only with them a reference may be NaN."""


@dataclass(frozen=True)
class Reference:
    """What must come out: a load factor, an interval of them, or a status.

    Attributes:
        value: in units of the case; of an interval its lower end. +inf where the status is LOCKED
            or JAM, -inf where it is UNSAFE; NaN where the kind says that nothing is known.
        formula: as text.
        source: where it comes from.
        kind: ``exact``, ``exact, numerical`` (integrated to all digits given), ``bracket``,
            ``interval`` (of Coulomb load factors: any certified one inside is right), ``status``,
            or one of `UNKNOWN_KINDS`: then there is nothing to pass.
        half_width: the reference is ``value +- half_width``.
        up_to: upper end of an interval.
        status: with which a Coulomb loop must end.
        associated: load factor with associated friction, +inf where nothing bounds it; None where
            it is not known, or no other.
        complete: whether there are no other Coulomb load factors; else the interval is that of one
            mechanism, others may carry other loads, and only `associated` bounds them.
    """

    value: float
    formula: str
    source: str
    kind: str
    half_width: float = 0.0
    up_to: float | None = None
    status: la.Status = la.Status.SOLVED
    associated: float | None = None
    complete: bool = True

    @property
    def unknown(self) -> bool:
        """Whether its kind says that there is nothing to compare with."""
        return self.kind in UNKNOWN_KINDS

    @property
    def wrong(self) -> str:
        """Why nothing can be judged by it, though its kind says so; empty where all is well.

        NaN and a distance without bounds are no references: comparisons with them are void.
        """
        if self.unknown:
            return ""
        if isnan(self.value):
            return f"the reference is NaN, and its kind {self.kind!r} does not say unknown"
        if not (isfinite(self.half_width) and self.half_width >= 0):
            return f"the reference is known to +- {self.half_width:g} only"
        known = (self.up_to, self.associated)
        if any(value is not None and isnan(value) for value in known) or self.high < self.low:
            return f"the reference [{self.low:g}, {self.high:g}] is no interval"
        return ""

    @property
    def low(self) -> float:
        """Lower end of what is right."""
        return self.value - self.half_width

    @property
    def high(self) -> float:
        """Upper end of what is right."""
        return self.value + self.half_width if self.up_to is None else self.up_to

    @property
    def text(self) -> str:
        """For tables: ``[1.26667, 1.6]``, ``2.197 ± 0.003``, ``jam``."""
        if self.status is not la.Status.SOLVED:
            return self.status.label
        if isnan(self.value):
            return "unknown"
        if self.up_to is not None:
            return f"[{self.value:.7g}, {self.up_to:.7g}]"
        return f"{self.value:.7g}" + (f" ± {self.half_width:g}" if self.half_width else "")

    @property
    def associated_differs(self) -> bool:
        """Whether associated friction is known to carry another load, or one of an interval."""
        if self.associated is None:
            return False
        return self.up_to is not None or not isclose(self.associated, self.value)

    def of_associated(self) -> Reference:
        """What associated friction must give, where that is known."""
        assert self.associated is not None
        status = la.Status.LOCKED if self.associated == inf else la.Status.SOLVED
        return Reference(
            self.associated, f"associated: {self.formula}", self.source, self.kind, status=status
        )


UNKNOWN = Reference(nan, "none is listed at these parameters", "", "none", complete=False)
