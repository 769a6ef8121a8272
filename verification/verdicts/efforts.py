"""What couplings come to with each backend: how many are certified, in how many inner solves."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, isinf, isnan, nan
from statistics import median

import lacore as la
from verification.case.bracketing import BRACKET
from verification.runs.outcome import Outcome
from verification.runs.row import Row
from verification.verdicts.load_factor import FAIL, SKIPPED


@dataclass(frozen=True)
class Effort:
    """What a coupling came to with one backend.

    Attributes:
        backend, coupling: names.
        cases: runs that were to end with a number.
        solved: how many of them ended with a certified one.
        median, most: inner solves of these; NaN without any.
        failed: runs judged wrong.
    """

    backend: str
    coupling: str
    cases: int
    solved: int
    median: float
    most: float
    failed: int


def efforts(outcomes: Sequence[Outcome]) -> list[Effort]:
    """Each coupling with each backend, over all variants that have a load factor.

    That is known, or some coupling has found one. Brackets are no couplings.
    """
    outcomes = [outcome for outcome in outcomes if outcome.row.coupling != BRACKET]
    solved = la.Status.SOLVED.label
    finite_ones = {
        (row.case, row.variant)
        for row in (outcome.row for outcome in outcomes)
        if isfinite(row.reference) or (isnan(row.reference) and row.status == solved)
    }
    by_pair: dict[tuple[str, str], list[Row]] = {}
    for row in (outcome.row for outcome in outcomes):
        if row.verdict != SKIPPED:
            by_pair.setdefault((row.backend, row.coupling), []).append(row)
    found = []
    for (backend, coupling), rows in by_pair.items():
        finite = [
            row
            for row in rows
            if (row.case, row.variant) in finite_ones and not isinf(row.reference)
        ]
        solves = [row.outer_iterations for row in finite if row.status == solved]
        found.append(
            Effort(
                backend,
                coupling,
                cases=len(finite),
                solved=len(solves),
                median=median(solves) if solves else nan,
                most=max(solves, default=nan),
                failed=sum(row.verdict == FAIL for row in rows),
            )
        )
    return found
