"""Checks of brackets (T26) and of ranges (T54, T59): their reference, and the sum of the gap."""

from collections.abc import Sequence
from math import inf, isclose, isfinite, nan

import lacore as la
from lacore_verification.case import Reference
from lacore_verification.case.band import Bracketing
from lacore_verification.harness.evidence.bracket import Shares, unpacked_shares
from lacore_verification.harness.verdicts.bracket import judge_bracket
from lacore_verification.harness.verdicts.ranging import judge_range
from lacore_verification.harness.verdicts.words import FAIL, PASS, SKIPPED
from lacore_verification.harness.verify.finding import CheckResult
from lacore_verification.runs.outcome import Outcome

DEFECT = 1e-5
"""Allowed difference between the sum of shares and the gap, relative to it."""
NEGATIVE = 1e-9
"""Allowed negative share, relative to `Shares.scale`, from the round-off of two solves."""
_SAME = 1e-12  # Relative to a load factor that is stored twice.
_LEAST = 1e-6  # Relative to `Shares.scale`: smaller gaps are round-off, 1e-11 of the load.
_SOLVED = la.Status.SOLVED.label
_ADAPTED = {"upper", "lower"}


def bracket(outcomes: Sequence[Outcome], reference: Reference) -> CheckResult:
    """Return whether proven load factors enclose the reference, and are close enough for the case.

    The verdict is recomputed: the row of a store may be older than the reference.

    Args:
        outcomes: one.
        reference: of the problem that was bracketed.
    """
    (outcome,) = outcomes
    run, row = outcome.run, outcome.row
    stated = run.case.bracket or Bracketing()
    allowed = f"<= {stated.target_width:g}"
    if row.status == _SOLVED and isfinite(row.n_elements):
        band = run.case.band_of(run.variant, int(row.n_elements))
        verdict, why = judge_bracket(row, reference, stated, band)
    else:
        verdict, why = FAIL, row.why
    return CheckResult(verdict, f"{run.label}: {why}", row.width, allowed)


def gap(outcomes: Sequence[Outcome]) -> CheckResult:
    """Return whether ``upper - lower`` is the sum of shares, none below 0, on every mesh.

    The sum is recomputed from stored values.

    Args:
        outcomes: one.
    """
    (outcome,) = outcomes
    run, row = outcome.run, outcome.row
    allowed = f"<= {DEFECT:g}"
    if row.status != _SOLVED:
        return CheckResult(SKIPPED, f"{run.label}: there is no bracket: {row.why}", nan, allowed)
    try:
        found = unpacked_shares(outcome.evidence.arrays)
    except ValueError as error:
        return CheckResult(FAIL, f"{run.label}: {error}", nan, allowed)
    by_mesh = {one.mesh: one for one in found}
    missing = _ADAPTED - set(by_mesh)
    if missing:
        why = f"{run.label}: no gap of the mesh of the {' and the '.join(sorted(missing))} bound"
        return CheckResult(FAIL, why, nan, allowed)
    bounds = (by_mesh["lower"].lower, row.lower), (by_mesh["upper"].upper, row.upper)
    if not all(isclose(stored, said, rel_tol=_SAME) for stored, said in bounds):
        why = f"{run.label}: the row says [{row.lower:.9g}, {row.upper:.9g}], the stored meshes"
        why += f" [{bounds[0][0]:.9g}, {bounds[1][0]:.9g}]"
        return CheckResult(FAIL, why, nan, allowed)
    defects = {one.mesh: _defect(one) for one in found}
    failed = [one for one in found if not (defects[one.mesh] <= DEFECT and _none_negative(one))]
    worst = failed[0] if failed else max(found, key=lambda one: defects[one.mesh])
    why = (
        f"{run.label}: on {len(found)} meshes ({', '.join(defects)}), the worst {worst.mesh}:"
        f" shares add up to {worst.total:.6g}, the gap is {worst.upper - worst.lower:.6g}, the"
        f" least share {worst.least / worst.scale:.1e} of the load"
    )
    return CheckResult(FAIL if failed else PASS, why, defects[worst.mesh], allowed)


def _defect(one: Shares) -> float:
    """Return the difference from the sum, per gap; NaN for NaN and without a scale."""
    gap = one.upper - one.lower
    size = max(abs(gap), _LEAST * one.scale)
    return abs(one.total - gap) / size if 0 < size < inf else nan


def _none_negative(one: Shares) -> bool:
    return one.shares.size > 0 and one.least >= -NEGATIVE * one.scale


def ranged(outcomes: Sequence[Outcome], reference: Reference) -> CheckResult:
    """Return whether the range is right; measured is the width, ``(highest - lowest)/mean``.

    It is NaN around zero. The verdict is recomputed: the row of a store may be older than the
    reference.

    Args:
        outcomes: one.
        reference: of each load factor.
    """
    (outcome,) = outcomes
    run, row = outcome.run, outcome.row
    verdict, why = row.verdict, row.why
    if row.n_elements == row.n_elements:
        verdict, why = judge_range(
            row, reference, run.case.band_of(run.variant, int(row.n_elements))
        )
    middle = (row.highest + row.lowest) / 2
    width = (row.highest - row.lowest) / middle if middle else nan
    return CheckResult(verdict, f"{run.label}: {why}", width)
