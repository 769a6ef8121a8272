"""Check of the order of convergence: a regression over a ladder of meshes."""

from collections.abc import Sequence
from math import nan

import numpy as np

import lacore as la
from lacore_verification.case import SOLVER
from lacore_verification.harness.verdicts.allowed import distance
from lacore_verification.harness.verdicts.words import FAIL, PASS, SKIPPED
from lacore_verification.harness.verify.finding import CheckResult
from lacore_verification.harness.verify.questions import Question
from lacore_verification.runs.outcome import Outcome


def order(question: Question, outcomes: Sequence[Outcome]) -> CheckResult:
    """Return whether the error falls as ``elements**-p`` over the whole ladder with the expected p.

    p must lie within the tolerance of the case, and its 95 % confidence interval must be no wider,
    as a wide one would contain any order.
    """
    # Imported here, because it takes most of a second that other commands do not need.
    from lacore_verification.harness.analysis.slope_fits import fit_slope

    stated = question.case.order_of(question.variant)
    assert stated is not None
    allowed = f"{stated.expected:g} ± {stated.tolerance:g}"
    name = f"{question.case.id}:{question.variant.name} with {question.backend}"
    if len(outcomes) < len(question.runs):
        why = f"{name}: {len(outcomes)} of {len(question.runs)} meshes could be run"
        return CheckResult(SKIPPED, why, nan, allowed)
    for outcome in outcomes:
        if outcome.row.status != la.Status.SOLVED.label:
            why = f"{outcome.run.label}: {outcome.row.why}: there is no ladder without it"
            return CheckResult(FAIL, why, nan, allowed)
    elements = [outcome.row.n_elements for outcome in outcomes]
    errors = [_error(question, outcome) for outcome in outcomes]
    fit = fit_slope(np.array(elements), np.array(errors), SOLVER, fewest=len(outcomes))
    over = f"over {len(elements)} meshes of {min(elements):g} to {max(elements):g} elements"
    if fit.reason:
        return CheckResult(FAIL, f"{name}: no order {over}: {fit.reason}", nan, allowed)
    measured, half = -fit.slope, (fit.high - fit.low) / 2
    holds = stated.holds(measured) and half <= stated.tolerance
    why = (
        f"{name}: the error falls as elements^-{measured:.3f} ± {half:.3f} (95 %) {over}, expected"
        f" {allowed}"
    )
    return CheckResult(PASS if holds else FAIL, why, measured, allowed)


def _error(question: Question, outcome: Outcome) -> float:
    band = question.case.band_of(question.variant, int(outcome.row.n_elements))
    return distance(outcome.row.load_factor, question.reference, band)
