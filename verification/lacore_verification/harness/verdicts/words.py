"""Texts of verdicts in rows and findings, and counts of runs by verdict."""

from collections.abc import Sequence
from dataclasses import dataclass

from lacore_verification.runs.outcome import Outcome

PASS, FAIL, SKIPPED, NO_RESULT = "pass", "FAIL", "skipped", "no result"
NO_REFERENCE = "no reference"
"""Verdict on a proven result without a reference: neither right nor wrong."""
BOUND_ONLY = "bound only"
""" Verdict on a result of another model than that of the case, on the right side of the reference.

Its own load factor is not known, so that it may be far from the reference: a comparison of models,
not a check of a number.
"""


@dataclass(frozen=True)
class Tally:
    """Counts of runs by verdict."""

    passed: int
    failed: int
    skipped: int
    no_result: int
    no_reference: int
    bound_only: int = 0

    @property
    def text(self) -> str:
        """One line."""
        rare = {
            BOUND_ONLY: self.bound_only,
            NO_RESULT: self.no_result,
            NO_REFERENCE: self.no_reference,
        }
        parts = [f"{self.passed} pass", f"{self.failed} FAIL", f"{self.skipped} skipped"]
        return ", ".join(parts + [f"{count} {kind}" for kind, count in rare.items() if count])


def tally(outcomes: Sequence[Outcome]) -> Tally:
    """Count verdicts."""
    verdicts = [outcome.row.verdict for outcome in outcomes]
    kinds = (PASS, FAIL, SKIPPED, NO_RESULT, NO_REFERENCE, BOUND_ONLY)
    return Tally(*(verdicts.count(kind) for kind in kinds))
