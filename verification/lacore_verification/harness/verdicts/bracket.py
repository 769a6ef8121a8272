"""Verdicts on brackets: they must contain the reference, and be as narrow as the case requires."""

from dataclasses import replace
from math import inf, isfinite

from lacore.bounds.bracket.bracket import width
from lacore_verification.case import Band, Reference
from lacore_verification.case.band import PROVEN, Bracketing
from lacore_verification.harness.verdicts.allowed import cannot_judge
from lacore_verification.harness.verdicts.words import FAIL, NO_REFERENCE, PASS, SKIPPED
from lacore_verification.runs.row import STRICT, Row


def between(reference: Reference, coulomb: bool) -> Reference:
    """Return the reference that a bracket must contain.

    If Coulomb friction was made associated this is its load factor, or if that is not known
    anything that is no smaller than the Coulomb ones (T14).
    """
    if not coulomb:
        return reference
    if reference.associated is not None:
        return reference.of_associated()
    return replace(
        reference,
        value=reference.low if reference.up_to is None else reference.up_to,
        half_width=0.0,
        up_to=inf,
        formula=f"associated friction carries no less than: {reference.formula}",
    )


def judge_bracket(
    row: Row, reference: Reference, stated: Bracketing, band: Band
) -> tuple[str, str]:
    """Return the verdict on a bracket, with its reason.

    Args:
        row: its bounds, width, rigor and message.
        reference: of the problem that was bracketed, see `between`.
        stated: target, and the effect of straight edges.
        band: gives the size of the dead loads.
    """
    if why := cannot_judge(reference, band):
        return FAIL, why
    if not (isfinite(row.lower) and isfinite(row.upper)):
        return FAIL, f"no bracket: {row.message}"
    found = f"[{row.lower:.7g}, {row.upper:.7g}], {100 * row.width:.2g} % wide"
    slack = PROVEN * band.size(max(abs(row.lower), abs(row.upper)))
    if not row.lower <= row.upper + slack:
        return FAIL, f"{found}: the lower bound is above the upper one"
    if row.rigor != STRICT and not stated.straightened:
        return SKIPPED, (
            f"{found}, of straight edges instead of curved boundaries: say what these do in"
            " Case.bracket, Bracketing(below=..., above=..., reason=...)"
        )
    told = f"the reference {reference.text}, {reference.formula}"
    low = reference.low - stated.below * band.size(reference.low)
    high = reference.high + stated.above * band.size(reference.high)
    encloses = row.lower <= high + slack and row.upper >= low - slack
    if not (encloses or reference.unknown):
        return FAIL, f"{found}: {told}, lies outside of what is proven"
    if not (row.width <= stated.target_width and width(row.lower, row.upper) <= row.width + PROVEN):
        return FAIL, f"{found}, not {100 * stated.target_width:.2g} %: {row.message}"
    if reference.unknown:
        return NO_REFERENCE, f"{found}; there is nothing to compare with"
    widened = f" (straight edges: {stated.reason})" if stated.straightened else ""
    return PASS, f"{found}, with {told}, in it{widened}"
