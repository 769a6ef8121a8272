"""One summary for each variant of a case: proven bounds, errors, agreement and failures.

It is used on the terminal and in the index of a page. Unlike the rest of the analysis it takes
outcomes, for the bands of their cases; all else is read from their rows.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from math import floor, inf, isfinite, isnan, log10, nan
from typing import Any

import numpy as np

import lacore as la
from lacore_verification.case import SOLVER
from lacore_verification.case.band import BRACKET, Bracketing
from lacore_verification.harness.verdicts.allowed import allowed_values, distance
from lacore_verification.harness.verdicts.limit_state import FINDS_NONE
from lacore_verification.harness.verdicts.words import (
    BOUND_ONLY,
    FAIL,
    NO_REFERENCE,
    NO_RESULT,
    PASS,
    SKIPPED,
)
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.row import STRICT, Row

CONTINUUM, DISCRETE = "continuum", "discrete"
_SOLVED = la.Status.SOLVED.label
_UPPER, _LOWER = la.Rigor.UPPER.label, la.Rigor.LOWER.label
_DISCRETE = la.Rigor.DISCRETE.label
_EXACT = (_UPPER, _LOWER, _DISCRETE)
_ORDER = (FAIL, PASS, BOUND_ONLY, NO_REFERENCE, NO_RESULT, SKIPPED)


@dataclass(frozen=True)
class Shortfall:
    """A run that failed, gave no result or was skipped.

    Attributes:
        label: of the run, as in its progress.
        backend, coupling, mesh: of the run.
        verdict: ``FAIL``, ``no result`` or ``skipped``.
        status: final status.
        why: the rule that gave the verdict, with its numbers.
    """

    label: str
    backend: str
    coupling: str
    mesh: str
    verdict: str
    status: str
    why: str


@dataclass(frozen=True)
class VariantSummary:
    """Summary of all runs of one variant of a case. Numbers that do not exist are NaN.

    Attributes:
        case, variant: names.
        expected: the reference as text: number, interval or status.
        reference, reference_to: the reference; the upper end where it is an interval.
        lower, upper: the closest proven bounds of the load factor, each NaN where there is none.
        bounded: the problem that they refer to: ``continuum``, or ``discrete`` where curved edges
            are straightened; empty without any.
        value: load factor of the exact backend and mesh to which `error` refers; without a
            reference, of the finest mesh.
        mesh, elements: that mesh, and its number of elements; empty and NaN where `error` is that
            of a bracket.
        error: the worst of exact backends on the finest mesh on which any has a number: relative,
            as `Row.error`, and as `Row.path_error` of paths. Where the narrowest bracket is closer
            to the reference, that of its farther end.
        below, above: errors that the band of the case allows, relative as `error` is; for a
            bracket the width that it must reach.
        agreeing: backends all of whose results are right; without a reference, those whose values
            agree with the exact backend on each mesh, within the tolerance of both.
        answered: backends that have any result, a load factor or a claim such as ``locked``.
        asked: backends that were run.
        runs: number of them, without the skipped ones.
        seconds: solve time of all runs, s.
        verdict: ``FAIL`` if a run failed, else ``pass`` if one passes, ``bound only``,
            ``no reference``, ``no result`` or ``skipped``.
        shortfalls: runs that failed, gave no result, or were skipped.
    """

    case: str
    variant: str
    expected: str
    reference: float
    reference_to: float
    lower: float
    upper: float
    bounded: str
    value: float
    mesh: str
    elements: float
    error: float
    below: float
    above: float
    agreeing: int
    answered: int
    asked: int
    runs: int
    seconds: float
    verdict: str
    shortfalls: tuple[Shortfall, ...]

    @property
    def name(self) -> str:
        """``case:variant``."""
        return f"{self.case}:{self.variant}"

    @property
    def allowed(self) -> float:
        """Return the error allowed on the side of the error: negative below the reference."""
        return -self.below if self.error < 0 else self.above if self.error >= 0 else nan

    @property
    def rounded(self) -> bool:
        """Return whether the error is within round-off and the tolerance of solvers."""
        return abs(self.error) < SOLVER

    @property
    def rank(self) -> tuple[bool, float]:
        """Return the sort key of summaries: failures first, then the largest errors."""
        known = isfinite(self.error) and not self.rounded
        return self.verdict != FAIL, -abs(self.error) if known else 0.0

    @property
    def error_text(self) -> str:
        """The error in per cent, such as ``+98 %``; empty without one."""
        return percent(self.error)

    @property
    def tolerance_text(self) -> str:
        """Return the allowed error in per cent; without a sign if the error is round-off."""
        text = percent(self.allowed)
        return text.lstrip("+-") if self.rounded else text

    def record(self) -> dict[str, Any]:
        """Return all values by name, including shortfalls, with `allowed`."""
        return {**asdict(self), "allowed": self.allowed}


def percent(value: float) -> str:
    """Format a relative number in per cent, with two digits, and all of them from 10 % on.

    Example:
        >>> percent(0.98321), percent(-0.00123), percent(12.0), percent(1e-9)
        ('+98 %', '-0.12 %', '+1200 %', '0 %')
    """
    if not isfinite(value):
        return ""
    if abs(value) < SOLVER:
        return "0 %"
    size = abs(100 * value)
    digits = max(1 - floor(log10(size)), 0)
    return f"{100 * value:+.{digits}f} %"


def summaries(outcomes: Sequence[Outcome]) -> list[VariantSummary]:
    """Return one summary for each variant, in the order of their first outcomes.

    Args:
        outcomes: of one comparison, verification or sweep; of any backends and couplings.
    """
    groups: dict[tuple[str, str], list[Outcome]] = {}
    for outcome in outcomes:
        groups.setdefault((outcome.row.case, outcome.row.variant), []).append(outcome)
    return [_Group(tuple(group)).summary() for group in groups.values()]


@dataclass(frozen=True)
class _Group:
    """All outcomes of one variant."""

    outcomes: tuple[Outcome, ...]

    def summary(self) -> VariantSummary:
        named, worst = self._reference_row, self._worst
        lower, upper, bounded = self._bounds
        below, above = (nan, nan) if worst is None else _allowed(worst)
        error = nan if worst is None else _error(worst.row)
        narrowest = self._narrowest
        end = nan if narrowest is None else _farther_end(narrowest)
        bracketed = narrowest is not None and not abs(end) >= abs(error) and isfinite(end)
        if narrowest is not None and bracketed:
            error, below, above = end, _target(narrowest), _target(narrowest)
        solvers = [self._loops(name) for name in dict.fromkeys(o.row.backend for o in self._ran)]
        agreeing = [own for own in solvers if self._agrees(own)]
        return VariantSummary(
            case=named.case,
            variant=named.variant,
            expected=named.expected,
            reference=named.reference,
            reference_to=named.reference_to,
            lower=lower,
            upper=upper,
            bounded=bounded,
            value=nan if worst is None else worst.row.load_factor,
            mesh="" if worst is None or bracketed else worst.row.mesh,
            elements=nan if worst is None or bracketed else worst.row.n_elements,
            error=error,
            below=below,
            above=above,
            agreeing=len(agreeing),
            answered=sum(any(_answers(row) for row in own) for own in solvers),
            asked=len(solvers),
            runs=len(self._ran),
            seconds=float(np.nansum([o.row.solve_time for o in self._ran])),
            verdict=self._verdict,
            shortfalls=self._shortfalls,
        )

    @property
    def _shortfalls(self) -> tuple[Shortfall, ...]:
        return tuple(
            Shortfall(
                o.run.label,
                *(o.row.backend, o.row.coupling, o.row.mesh),
                *(o.row.verdict, o.row.status, o.row.why),
            )
            for o in self.outcomes
            if o.row.verdict in (FAIL, NO_RESULT, SKIPPED)
        )

    @cached_property
    def _ran(self) -> list[Outcome]:
        return [o for o in self.outcomes if o.row.verdict != SKIPPED]

    @property
    def _verdict(self) -> str:
        found = {o.row.verdict for o in self.outcomes}
        return next(kind for kind in _ORDER if kind in found)

    @property
    def _reference_row(self) -> Row:
        """Return a row with the reference of a Coulomb load factor.

        Bounds have other references.
        """
        rows = [o.row for o in self.outcomes]
        own = [row for row in rows if row.expected and row.coupling not in FINDS_NONE]
        return (own or [row for row in rows if row.expected] or rows)[0]

    def _loops(self, backend: str) -> list[Row]:
        """Return rows of a backend that determine a load factor and do not bound it."""
        rows = [o.row for o in self._ran if o.row.backend == backend]
        return [row for row in rows if row.coupling not in FINDS_NONE] or rows

    @cached_property
    def _finest(self) -> list[Outcome]:
        """Return the runs of exact backends on the finest mesh that has a number."""
        found = [
            o for o in self._ran if o.row.coupling not in FINDS_NONE and _is_exact_number(o.row)
        ]
        finest = max((o.row.n_elements for o in found), default=nan)
        return [o for o in found if o.row.n_elements == finest]

    @property
    def _worst(self) -> Outcome | None:
        """Return the one of `_finest` with the largest error; NaN only if all are NaN."""
        return max(
            self._finest,
            key=lambda o: (-1.0 if isnan(_error(o.row)) else abs(_error(o.row)), o.row.n_elements),
            default=None,
        )

    @property
    def _bounds(self) -> tuple[float, float, str]:
        """Return the closest proven bounds and the problem that they refer to.

        A bracket of a problem with Coulomb friction is one of the associated problem: its lower end
        does not bound Coulomb load factors (T14). Bounds of a path are those of its beginning.
        """
        rows = [o.row for o in self._ran if o.row.status == _SOLVED and not o.row.ending]
        straightened = [r for r in rows if r.coupling == BRACKET and r.rigor == _DISCRETE]
        of_continuum = [r for r in rows if r.rigor in (STRICT, _LOWER, _UPPER)]
        for problem, proofs in ((CONTINUUM, of_continuum), (DISCRETE, straightened)):
            below = [r for r in proofs if not (r.coupling == BRACKET and self._coulomb)]
            lower = max((r.lower for r in below if isfinite(r.lower)), default=nan)
            upper = min((r.upper for r in proofs if isfinite(r.upper)), default=nan)
            if isfinite(lower) or isfinite(upper):
                return lower, upper, problem
        return nan, nan, ""

    @property
    def _narrowest(self) -> Outcome | None:
        """Return the narrowest bracket that is proven and passes."""
        found = [
            o
            for o in self._ran
            if o.row.coupling == BRACKET and isfinite(o.row.width) and o.row.verdict == PASS
        ]
        return min(found, key=lambda o: o.row.width, default=None)

    @cached_property
    def _coulomb(self) -> bool:
        """Return whether there is Coulomb friction, as far as it can be determined."""
        try:
            from lacore.bounds.enclosing import has_coulomb  # Imported for brackets only.

            return has_coulomb(self.outcomes[0].run.problem())
        # A case of a user may raise at other parameters: then no lower bound is proven.
        except Exception:
            return True

    def _agrees(self, rows: Sequence[Row]) -> bool:
        """Return whether there are results, and all of them are right."""
        given = [row for row in rows if _answers(row)]
        return bool(given) and all(
            row.verdict in (PASS, BOUND_ONLY)
            or (row.verdict == NO_REFERENCE and self._is_the_exact_one(row))
            for row in given
        )

    def _is_the_exact_one(self, row: Row) -> bool:
        """Return whether a value agrees with the first exact backend on its mesh."""
        exact = next(
            (
                o.row
                for o in self._ran
                if o.row.mesh == row.mesh
                and o.row.coupling not in FINDS_NONE
                and _is_exact_number(o.row)
            ),
            None,
        )
        if exact is None:
            return False
        slack = 2 * SOLVER * abs(exact.load_factor)
        energy = 0.0 if isnan(row.energy) else max(row.energy, 0.0)
        off = row.load_factor - exact.load_factor
        return -slack - energy <= off <= slack + (energy if row.ending else 0.0)


def _answers(row: Row) -> bool:
    """Return whether a run ended with a result that is right or wrong."""
    judged = row.verdict in (PASS, BOUND_ONLY, NO_REFERENCE)
    return judged or (row.verdict == FAIL and isfinite(row.load_factor))


def _is_exact_number(row: Row) -> bool:
    known = isfinite(row.load_factor) and isfinite(row.n_elements)
    return row.rigor in _EXACT and isnan(row.energy) and known


def _error(row: Row) -> float:
    """Return the error of a row; for a path the largest of all its loads."""
    if not row.ending:
        return row.error
    known = [abs(size) for size in (row.error, row.path_error) if not isnan(size)]
    return max(known, default=nan)


def _farther_end(outcome: Outcome) -> float:
    """Return the relative distance of the farther end of a bracket from the reference."""
    row, run = outcome.row, outcome.run
    if row.model:  # The reference is that of another model.
        return nan
    try:
        reference = run.case.reference_of(run.variant)
        band = run.case.band_of(run.variant, int(row.n_elements))
    except Exception:  # A case of a user may raise; its row reports the error.
        return nan
    ends = [distance(end, reference, band) for end in (row.lower, row.upper)]
    return max((end for end in ends if isfinite(end)), key=abs, default=nan)


def _target(outcome: Outcome) -> float:
    """Return the width that a bracket must reach."""
    run = outcome.run
    stated = run.case.bracket or Bracketing()
    return float(run.settings.get("target_width", stated.target_width))


def _allowed(outcome: Outcome) -> tuple[float, float]:
    """Return the errors that the band allows below and above, relative as errors (`distance`)."""
    row = outcome.row
    try:
        reference = outcome.run.case.reference_of(outcome.run.variant)
        band = outcome.run.case.band_of(outcome.run.variant, int(row.n_elements))
    except Exception:  # A case of a user may raise; its row reports the error.
        return nan, nan
    if reference.unknown or band.wrong:
        return nan, nan
    if row.ending:
        return (max(band.below, band.above),) * 2
    ends = reference.value, reference.value if reference.up_to is None else reference.up_to
    near = min(max(row.load_factor, ends[0]), ends[1])
    size = band.size(near) if row.error == 0 else abs(near) or band.scale
    if not 0 < size < inf:
        return nan, nan
    allowed = allowed_values(replace(reference, complete=True), band)
    return (ends[0] - allowed.low) / size, (allowed.high - ends[1]) / size
