"""Checks of paths: that all loads are right, and that errors fall with the steps (T30)."""

from collections.abc import Sequence
from math import isnan, nan

import numpy as np

import lacore as la
from lacore_verification.case import SOLVER
from lacore_verification.case.following import ORDER_TOLERANCE, ORDERS
from lacore_verification.harness.verdicts.path import judge_path
from lacore_verification.harness.verdicts.words import FAIL, NO_REFERENCE, NO_RESULT, PASS, SKIPPED
from lacore_verification.harness.verify.finding import CheckResult
from lacore_verification.harness.verify.limit_state import lost_verdict
from lacore_verification.harness.verify.questions import Question
from lacore_verification.runs.outcome import Outcome


def path(outcomes: Sequence[Outcome]) -> CheckResult:
    """Return whether paths end as required, with all loads in their bands.

    The verdict is recomputed: the row of a store may be older than the reference.
    """
    answers = [_path(outcome) for outcome in outcomes]
    for verdict in (FAIL, NO_RESULT, NO_REFERENCE):
        found = [one for one in answers if one.verdict == verdict]
        if found:
            return found[0]
    return max(answers, key=lambda one: np.nan_to_num(one.measured))


def _path(outcome: Outcome) -> CheckResult:
    run, row = outcome.run, outcome.row
    if not row.ending or isnan(row.n_elements):  # Nothing was solved.
        return CheckResult(lost_verdict(outcome), f"{run.label}: {row.why}")
    band = run.case.band_of(run.variant, int(row.n_elements))
    reference = run.case.reference_of(run.variant)
    stated = run.case.following_of(run.variant)
    verdict, why = judge_path(row, stated, reference, band, run.insist)
    allowed = "" if isnan(row.path_error) else f"<= {max(band.below, band.above):.3g}"
    return CheckResult(verdict, f"{run.label}: {why}", row.path_error, allowed)


def steps(question: Question, outcomes: Sequence[Outcome]) -> CheckResult:
    """Return whether the largest error of a path falls as ``steps**-p`` with that p."""
    # Imported here, because it takes most of a second that other commands do not need.
    from lacore_verification.harness.analysis.slope_fits import fit_slope

    stated = question.case.following_of(question.variant)
    expected = ORDERS[stated.scheme]
    allowed = f"{expected:g} ± {ORDER_TOLERANCE:g}"
    name = f"{question.case.id}:{question.variant.name} with {question.backend}, {stated.scheme}"
    if len(outcomes) < len(question.runs):
        why = f"{name}: {len(outcomes)} of {len(question.runs)} paths could be run"
        return CheckResult(SKIPPED, why, nan, allowed)
    for outcome in outcomes:
        if outcome.row.status != la.Status.SOLVED.label or isnan(outcome.row.path_error):
            why = f"{outcome.run.label}: {outcome.row.why}: there is no ladder without it"
            return CheckResult(FAIL, why, nan, allowed)
    counts = np.array([float(outcome.run.parameters["steps"]) for outcome in outcomes])
    errors = np.array([outcome.row.path_error for outcome in outcomes])
    fit = fit_slope(counts, errors, SOLVER, fewest=len(outcomes))
    over = f"over {counts.min():g} to {counts.max():g} steps"
    if fit.reason:
        return CheckResult(FAIL, f"{name}: no order {over}: {fit.reason}", nan, allowed)
    holds = abs(-fit.slope - expected) <= ORDER_TOLERANCE
    why = f"{name}: the error falls as steps^-{-fit.slope:.3f} {over}, expected {allowed}"
    return CheckResult(PASS if holds else FAIL, why, -fit.slope, allowed)
