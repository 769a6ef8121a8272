"""Checks of a load factor: whether it is right, and on which side it is wrong."""

import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite, isnan, nan

import numpy as np

import lacore as la
from lacore.program.regularization import RegularisedValues
from lacore_verification.case import SOLVER, Band, Reference
from lacore_verification.harness.verdicts.allowed import distance
from lacore_verification.harness.verdicts.limit_state import judge, refutation
from lacore_verification.harness.verdicts.words import FAIL, NO_REFERENCE, NO_RESULT, PASS, SKIPPED
from lacore_verification.harness.verify.finding import CheckResult
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.row import Row

_SOLVED = la.Status.SOLVED.label


@dataclass(frozen=True)
class _Said:
    """Columns of a row about its state; as in `la.LimitState`."""

    status: la.Status
    load_factor: float
    coupling: str
    message: str
    regularised: RegularisedValues | None


def _said(row: Row) -> _Said:
    status = next(status for status in la.Status if status.label == row.status)
    values = RegularisedValues(row.P, row.alpha_reg, row.regularised_lambda, nan)
    regularised = None if isnan(row.P) else values
    return _Said(status, row.load_factor, row.coupling, row.message, regularised)


def value(outcomes: Sequence[Outcome], reference: Reference) -> CheckResult:
    """Return whether load factors are in their bands, or statuses are those of a reference.

    The verdict is recomputed: the row of a store may be older than the reference.

    Args:
        outcomes: of one variant, backend and coupling on its meshes.
        reference: of that coupling.
    """
    return _worst([_value(outcome, reference) for outcome in outcomes], abs)


def _value(outcome: Outcome, reference: Reference) -> CheckResult:
    run, row = outcome.run, outcome.row
    if isnan(row.n_elements):  # Nothing was solved.
        return CheckResult(lost_verdict(outcome), f"{run.label}: {row.why}", allowed=reference.text)
    band = run.case.band_of(run.variant, int(row.n_elements))
    refuted = refutation(row.claimed, outcome.evidence.residuals)
    own = run.case.reference_of(run.variant)
    verdict, why = judge(_said(row), own, band, run.insist, refuted)
    if reference.status is not la.Status.SOLVED:
        return CheckResult(
            verdict, f"{run.label}: {why}; {reference.formula}", allowed=reference.text
        )
    return CheckResult(
        verdict,
        f"{run.label}: {why}; the reference is {reference.text}, {reference.formula}",
        distance(row.load_factor, reference, band),
        f"-{band.below:.3g} ... +{band.above:.3g}",
    )


def lost_verdict(outcome: Outcome) -> str:
    """Return the verdict on a run without numbers: a late one has no result if none is required."""
    late = outcome.row.status == la.Status.TIME_LIMIT.label
    return NO_RESULT if late and not outcome.run.insist else FAIL


def upper_from_above(outcomes: Sequence[Outcome], reference: Reference) -> CheckResult:
    """Return whether strict upper bounds are not below the reference, within solver tolerances."""
    return _worst(
        [_upper(outcome, reference) for outcome in outcomes if outcome.row.status == _SOLVED],
        operator.neg,
    )


def _upper(outcome: Outcome, reference: Reference) -> CheckResult:
    run, row = outcome.run, outcome.row
    allowed = f">= -{SOLVER:g}"
    if row.rigor != la.Rigor.UPPER.label:
        why = f"{run.label}: labelled {row.rigor!r}, where a strict upper bound is to be had"
        return CheckResult(FAIL, why, nan, allowed)
    above = _relative(row.load_factor - reference.low, reference.low, _band(outcome))
    verdict = PASS if above >= -SOLVER and isfinite(row.load_factor) else FAIL
    side = f"{above:.3g} above" if above >= 0 else f"{-above:.3g} below"
    why = (
        f"{run.label}: the strict upper bound {row.load_factor:.7g} is {side} (relative) the"
        f" reference {reference.low:.7g}, {reference.formula}"
    )
    return CheckResult(verdict, why, above, allowed)


def lambda_below_exact(outcomes: Sequence[Outcome], exact: Mapping[str, Outcome]) -> CheckResult:
    """Return whether ``P <= alpha_reg <= lambda <= alpha*`` (T19), within both tolerances.

    Args:
        outcomes: of regularised backends, on problems without Coulomb friction: a reaction loop
            would lose the one-sidedness.
        exact: of the same problems, by the keys of the regularised runs.
    """
    return _worst(
        [
            _lambda(outcome, exact[outcome.run.key])
            for outcome in outcomes
            if outcome.row.status == exact[outcome.run.key].row.status == _SOLVED
        ],
        operator.pos,
    )


def _lambda(outcome: Outcome, exact: Outcome) -> CheckResult:
    run, row, star = outcome.run, outcome.row, exact.row.load_factor
    chain = (row.P, row.alpha_reg, row.load_factor, star)
    excess = _relative(float(np.max(-np.diff(chain))), star, _band(outcome))  # NaN is kept.
    allowed = 2 * SOLVER  # One for each of the two.
    verdict = PASS if excess <= allowed and all(map(isfinite, chain)) else FAIL
    why = (
        f"{run.label}: P = {row.P:.7g}, alpha_reg = {row.alpha_reg:.7g}, lambda ="
        f" {row.load_factor:.7g}, alpha* = {star:.7g} of {exact.row.backend}"
        f" {'in this order' if verdict == PASS else f'out of order by {excess:.3g} (relative)'}"
    )
    return CheckResult(verdict, why, excess, f"<= {allowed:g}")


def _band(outcome: Outcome) -> Band:
    return outcome.run.case.band_of(outcome.run.variant, int(outcome.row.n_elements))


def _relative(difference: float, value: float, band: Band) -> float:
    return difference / (band.size(value) or 1.0)


def _worst(answers: Sequence[CheckResult], badness: Callable[[float], float]) -> CheckResult:
    """Return the first failure, missing result or missing reference, or else the worst result."""
    if not answers:
        return CheckResult(SKIPPED, "no run was solved: there is nothing to look at")
    for verdict in (FAIL, NO_RESULT):
        found = [answer for answer in answers if answer.verdict == verdict]
        if found:
            more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
            return CheckResult(verdict, found[0].why + more, found[0].measured, found[0].allowed)
    answers = [answer for answer in answers if answer.verdict == NO_REFERENCE] or answers
    return max(answers, key=lambda a: -inf if isnan(a.measured) else badness(a.measured))
