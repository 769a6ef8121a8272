"""Verdicts on ranges: both ends must be right, and within the proven bounds of the mesh."""

from math import isfinite

import lacore as la
from lacore_verification.case import Band, Reference
from lacore_verification.harness.verdicts.allowed import Allowed, allowed_values, cannot_judge
from lacore_verification.harness.verdicts.words import FAIL, NO_REFERENCE, PASS
from lacore_verification.runs.row import Row

_SOLVED = la.Status.SOLVED.label
_BEYOND = 1e-6  # Relative to the larger load factor: the round-off of two solves.


def judge_range(row: Row, reference: Reference, band: Band) -> tuple[str, str]:
    """Return the verdict on the lowest and the highest load factor found, with its reason.

    Args:
        row: both, the proven bounds of all load factors of its mesh, status, gap and message.
        reference, band: of each load factor.
    """
    if why := cannot_judge(reference, band):
        return FAIL, why
    if row.status != _SOLVED or not (isfinite(row.lowest) and isfinite(row.highest)):
        return FAIL, f"no load factor is certified: {row.message}"
    found = f"{row.lowest:.6g} to {row.highest:.6g}, gaps at most {row.gap:.1e}"
    slack = _BEYOND * max(abs(row.lowest), abs(row.highest))
    proven = Allowed(row.lower - slack, row.upper + slack)
    if not (row.lowest <= row.highest and proven.holds(row.lowest) and proven.holds(row.highest)):
        told = f"[{row.lower:.6g}, {row.upper:.6g}]"
        return FAIL, f"{found}: not between the associated load factors of the mesh, {told} (T54)"
    if reference.unknown:
        return NO_REFERENCE, f"{found}; there is nothing to compare with"
    allowed = allowed_values(reference, band)
    right = allowed.holds(row.lowest) and allowed.holds(row.highest)
    told = f"{found}, {'in' if right else 'not in'} {allowed}: {reference.formula}"
    return PASS if right else FAIL, told
