"""Expected result of a case: a load factor, an interval of them, or a status."""

from __future__ import annotations  # Annotations are not evaluated, so they do not load lacore.

from dataclasses import dataclass
from math import inf, isclose, isfinite, isnan, nan

import lacore as la

UNKNOWN_KINDS = ("none", "no closed form", "unknown")
"""Kinds of unknown references, which alone may be NaN."""


@dataclass(frozen=True)
class Reference:
    """Expected result: a load factor, an interval of them, or a status.

    Attributes:
        value: in units of the case; for an interval its lower end. +inf if the status is LOCKED or
            JAM, -inf if it is UNSAFE; NaN for a kind without a known value.
        formula: text of the formula.
        source: its origin.
        kind: ``exact``, ``exact, numerical`` (integrated to all digits given), ``bracket``,
            ``interval`` (of Coulomb load factors: any certified one inside is correct), ``status``,
            or one of `UNKNOWN_KINDS`, without a comparison.
        half_width: the reference is ``value +- half_width``.
        up_to: upper end of an interval.
        status: required final status of a Coulomb loop.
        associated: load factor with associated friction, +inf if it is unbounded; None if it is
            unknown, or equal.
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
        """Whether its kind has no known value."""
        return self.kind in UNKNOWN_KINDS

    @property
    def wrong(self) -> str:
        """Why nothing can be assessed with it; empty if it is valid.

        NaN and an infinite distance are not references, because comparisons with them are void.
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
        """Lower end of the correct values."""
        return self.value - self.half_width

    @property
    def high(self) -> float:
        """Upper end of the correct values."""
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
        """Return the reference for associated friction, if it is known."""
        assert self.associated is not None
        status = la.Status.LOCKED if self.associated == inf else la.Status.SOLVED
        return Reference(
            self.associated, f"associated: {self.formula}", self.source, self.kind, status=status
        )


UNKNOWN = Reference(nan, "none is listed at these parameters", "", "none", complete=False)
