"""Result of a search for the lowest and the highest load factor of a problem."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import numpy as np
import pandas as pd

from lacore.coupling.claims.proving import Ray
from lacore.limit.state import LimitState
from lacore.reporting.findings import Finding, texts
from lacore.reporting.showing import Facts, Picture, counted
from lacore.reporting.status import Reported, Scope, Status
from lacore.reporting.text import PYTHON, Reader

_CLOSE = 1e-6  # relative distance at which a load factor has reached a bound


class RangeKind(Enum):
    """Reason for several load factors of a problem."""

    COULOMB = "Coulomb load factors"
    SOIL = "load factors"

    @property
    def bounds(self) -> str:
        """Problems whose load factors are the bounds of all others."""
        if self is RangeKind.COULOMB:
            return "frictionless, associated"
        return "associated flow with the dilation angle, and with the friction angle"

    @property
    def digits(self) -> str:
        """Format of a load factor: those of soils are certified to a larger tolerance."""
        return ".7g" if self is RangeKind.COULOMB else ".6g"


@dataclass(frozen=True, repr=False)
class LoadFactorRange(Reported):
    """The lowest and the highest load factor found, in SI units.

    Each of them is proven by its certificate. It is proven that there is none lower or higher only
    if they reach `bracket`; otherwise it is just the result of the search. For deformable bodies
    this applies to the discrete problem (`scope`), whose load factors are usually above those of
    the continuum; for the continuum `continuum` is proven.

    Attributes:
        kind: Reason for several load factors: Coulomb friction, or soil with non-associated flow.
        status: SOLVED if states were found; else why there is none.
        lowest, highest: their states; None if none was found. If a mechanism carries any load
            factor (`high` = inf), `highest` is a state with a large one.
        low, high: their load factors; NaN if nothing is certified, +inf for a LOCKED problem.
        scope: problem of the load factors and of `bracket`.
        bracket: proven bounds of every load factor of that problem; -inf and inf without a bound.
            For Coulomb friction those without friction and with associated friction (T14); for
            soils those with associated flow with the dilation angle and the same apex, and with the
            friction angle (T54).
        continuum: proven bounds of every Coulomb load factor of the continuum: a strict lower bound
            of the problem without Coulomb friction, a strict upper bound of that with associated
            friction; -inf and inf without a bound. Equal to `bracket` if nothing is discretised.
        unbounded: Why the continuum has no bound; empty if it has both.
        davis: load factor with Davis's strength of soils (T55), which is not a bound; NaN without
            such a state.
        states: one row per certified state, or per search; see `lacore.coulomb_range` and
            `lacore.soil_range`.
        certified: number of certified states.
        backend: name of the backend.
        tolerance: tolerance for all residuals.
        settings: settings of the search: ``seed`` and ``restarts``, or ``shares``.
        solves: inner solves of the search.
        solve_time: s, wall clock, without the compilation of the backend.
        findings: further findings; `message` is their text.
        stop: Why the search ended early; None if it did not.
        ray: proof of LOCKED or UNSAFE, with its residuals: see `LimitState`; else None.
    """

    kind: RangeKind
    status: Status
    lowest: LimitState | None
    highest: LimitState | None
    low: float
    high: float
    scope: Scope
    bracket: tuple[float, float]
    continuum: tuple[float, float]
    unbounded: tuple[Finding, ...]
    davis: float
    states: pd.DataFrame
    certified: int
    backend: str
    tolerance: float
    settings: Mapping[str, Any]
    solves: int
    solve_time: float
    findings: tuple[Finding, ...]
    stop: Finding | None = None
    ray: Ray | None = None

    @property
    def width(self) -> float:
        """``(high - low)/mean``."""
        return 2 * (self.high - self.low) / (self.high + self.low)

    @property
    def missing(self) -> str:
        """Text of `unbounded`: why the continuum has no bound; empty where it has both."""
        return texts(self.unbounded)

    @property
    def stopped(self) -> str:
        """Text of `stop`: why the search ended early; empty where it did not."""
        return str(self.stop or "")

    @property
    def lowest_proven(self) -> bool:
        """Whether it is proven that the problem of `scope` has no lower load factor."""
        return _reached(self.low, self.bracket[0])

    @property
    def highest_proven(self) -> bool:
        """Whether it is proven that the problem of `scope` has no higher load factor."""
        return _reached(self.high, self.bracket[1])

    @property
    def sampled(self) -> tuple[str, ...]:
        """Ends, ``low`` and ``high``, that belong to a sample of states: others may lie beyond."""
        proven = {"low": self.lowest_proven, "high": self.highest_proven}
        return () if self.lowest is None else tuple(end for end in proven if not proven[end])

    @property
    def _sample(self) -> str:
        """Text of `sampled`; empty where both ends are proven."""
        beyond = [{"low": "lower", "high": "higher"}[end] for end in self.sampled]
        return f" in a sample of states ({' and '.join(beyond)} ones may exist)" if beyond else ""

    def facts(self) -> Facts:
        """Return the results and what is proven, for printing; `summary` is complete."""
        return self.facts_for(PYTHON)

    def facts_for(self, reader: Reader) -> Facts:
        """Return the facts for a reader."""
        form = self.kind.digits
        found = f"{self.low:{form}} to {self.high:{form}}{self.scope.phrase}{self._sample}"
        if self.lowest is None:
            found = "none is certified"
        told = {"status": self.report.summary_for(reader), "proven": self._proven()}
        told |= self._residuals()
        told |= {} if self.ray is None else {"proof": str(self.ray)}
        told["solved by"] = (
            f"{self.backend}: {counted(self.certified, 'certified state')} in"
            f" {counted(self.solves, 'solve')}, {self.solve_time:.3g} s"
        )
        if self.lowest is not None:
            told["size"] = self.lowest.discretisation.contents
        told |= {"stopped": self.stopped} if self.stop else {}
        short = ", stopped by its time limit" if self.stop else ""
        return Facts(f"{self.kind.value} {found}{short}", told, "LoadFactorRange")

    def _proven(self) -> str:
        """Return the bounds of all load factors, in one line."""
        if np.isinf(self.bracket).all():
            return "no bounds"
        lines = [f"every one is in {_interval(self.bracket, self.kind.digits)}"]
        if self.kind is RangeKind.COULOMB and self.scope is Scope.DISCRETE:
            lines.append(f"those of the continuum in {_interval(self.continuum, self.kind.digits)}")
        if np.isfinite(self.davis):
            lines.append(f"Davis's strength: {self.davis:{self.kind.digits}}, no bound")
        return "; ".join(lines)

    def _residuals(self) -> dict[str, str]:
        """Return a line on the residuals of the states; empty without any."""
        worst = [
            f"{state.certificate.summary} of the {name}"
            for name, state in (("lowest", self.lowest), ("highest", self.highest))
            if state is not None and state.certificate is not None
        ]
        return {"residual": "; ".join(worst)} if worst else {}

    def picture(self) -> Picture | None:
        """Return the mechanism of the lowest load factor."""
        if self.lowest is None:
            return None
        return Picture(self.lowest.plot(), "the mechanism with the lowest load factor")

    def summary(self) -> str:
        """Return the results and what is proven, as plain text."""
        return "\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        of = self.scope.phrase
        if self.lowest is None:
            yield f"none of the {self.kind.value}{of} is certified: {self.message}"
        else:
            yield f"{self.kind.value}{of}: {self.low:.6g} to {self.high:.6g}{self._sample}"
        if self.kind is RangeKind.COULOMB and self.scope is Scope.DISCRETE:
            yield (
                f"  proven of the continuum: every one lies in {_interval(self.continuum, '.6g')}"
                " (lower bound frictionless, upper bound associated)"
            )
            if self.unbounded:
                yield f"  of the continuum {self.missing}"
        if np.isinf(self.bracket).all():
            yield f"  no bounds are proven{of}"
        else:
            ends = _interval(self.bracket, ".6g")
            yield f"  proven{of}: every one lies in {ends} ({self.kind.bounds})"
        if self.ray is not None:
            yield f"  proof: {self.ray}"
        yield from self._end("lower", self.low, self.lowest, self.lowest_proven)
        yield from self._end("higher", self.high, self.highest, self.highest_proven)
        if np.isfinite(self.davis):
            yield f"  with Davis's strength, which bounds nothing: {self.davis:.6g}"
        settings = "".join(f", {name} {value}" for name, value in self.settings.items())
        yield (
            f"  {counted(self.certified, 'certified state')} in {self.solves} solves by"
            f" {self.backend}{settings}, {self.solve_time:.1f} s"
        )
        if self.stop:
            yield f"  stopped {self.stopped}: others may lie outside"

    def _end(
        self, other: str, value: float, state: LimitState | None, proven: bool
    ) -> Iterator[str]:
        """Yield lines on the proof of one end; `other` describes load factors beyond it."""
        if state is None or state.certificate is None:
            return
        of, (residual, size) = self.scope.phrase, state.certificate.worst
        worst = f"(largest residual {size:.1e}, {residual})"
        if np.isinf(value):
            yield f"  proven{of}: any higher one is carried {worst}"
            return
        yield f"  proven{of}: {value:.6g} is one, by its certificate {worst}"
        if proven:
            yield f"  proven{of}: none is {other}, because it reaches its bound"
        else:
            yield f"  not proven{of}: a {other} one may exist"

    def __str__(self) -> str:
        return self.summary()


@dataclass(frozen=True)
class NoState:
    """Report of a range without certified states.

    Attributes:
        status: Why there is none.
        findings: further findings; also for a range with states.
        ray: proof of LOCKED or UNSAFE.
    """

    status: Status
    findings: tuple[Finding, ...] = ()
    ray: Ray | None = None


@dataclass(frozen=True)
class SearchRecord:
    """Results of a search other than its states; the fields are those of `LoadFactorRange`."""

    kind: RangeKind
    scope: Scope
    bracket: tuple[float, float]
    states: pd.DataFrame
    certified: int
    backend: str
    tolerance: float
    settings: Mapping[str, Any]
    solves: int
    solve_time: float
    stop: Finding | None
    davis: float = float("nan")
    continuum: tuple[float, float] | None = None
    unbounded: tuple[Finding, ...] = field(default=())


def range_of(
    ends: Sequence[LimitState], without: NoState, searched: SearchRecord
) -> LoadFactorRange:
    """Build a range from the states at its ends.

    Args:
        ends: The lowest state first, the highest last; empty if none was certified.
        without: Report in this case.
        searched: Other results.
    """
    nothing = np.inf if without.status is Status.LOCKED else np.nan
    bracket = searched.bracket
    return LoadFactorRange(
        kind=searched.kind,
        status=Status.SOLVED if ends else without.status,
        lowest=ends[0] if ends else None,
        highest=ends[-1] if ends else None,
        low=ends[0].load_factor if ends else nothing,
        high=ends[-1].load_factor if ends else nothing,
        scope=searched.scope,
        bracket=bracket,
        continuum=bracket if searched.continuum is None else searched.continuum,
        unbounded=searched.unbounded,
        davis=searched.davis,
        states=searched.states,
        certified=searched.certified,
        backend=searched.backend,
        tolerance=searched.tolerance,
        settings=searched.settings,
        solves=searched.solves,
        solve_time=searched.solve_time,
        findings=without.findings,
        stop=searched.stop,
        ray=None if ends else without.ray,
    )


def _interval(ends: tuple[float, float], form: str) -> str:
    """Return ``[0.3, 0.5]``; a lower end that is zero but for round-off is written as zero."""
    below, above = ends
    if np.isfinite(above) and abs(below) <= _CLOSE * abs(above):
        below = 0.0
    return f"[{below:{form}}, {above:{form}}]"


def about(bracket: tuple[float, float], low: float, high: float) -> tuple[float, float]:
    """Return bounds moved to certified load factors that exceed them by round-off."""
    below, above = bracket
    sizes = [abs(value) for value in (below, above, low, high) if np.isfinite(value)]
    slack = _CLOSE * max(sizes)
    if below - slack <= low < below:
        below = low
    if above < high <= above + slack:
        above = high
    return below, above


def _reached(value: float, bound: float) -> bool:
    """Return whether a load factor is at a bound; both may be infinite."""
    if not (np.isfinite(value) and np.isfinite(bound)):
        return value == bound
    return abs(value - bound) <= _CLOSE * max(abs(value), abs(bound))
