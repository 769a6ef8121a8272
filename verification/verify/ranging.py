"""Checks of ranges: both ends are certified, and where they may be (T54, T59)."""

from collections.abc import Sequence
from math import nan

from verification.case import Reference
from verification.runs.outcome import Outcome
from verification.verdicts.ranging import judge_range
from verification.verify.finding import Answer


def ranged(outcomes: Sequence[Outcome], reference: Reference) -> Answer:
    """Whether what was found is right; measured is the width, ``(highest - lowest)/mean``.

    NaN around zero. Judged afresh: the row of a store may be older than the reference.

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
    return Answer(verdict, f"{run.label}: {why}", width)
