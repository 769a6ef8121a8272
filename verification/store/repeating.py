"""Failures are results like all others: which stored runs are repeated, and which are not."""

from collections import Counter
from collections.abc import Sequence
from enum import Enum

import lacore as la
from verification.runs.outcome import Outcome
from verification.verdicts.words import FAIL

_WITHOUT_ANSWER = (la.Status.TIME_LIMIT.label, la.Status.FAILED.label)


class Repeat(Enum):
    """Which of the runs that are stored are repeated."""

    NOTHING = "nothing"
    FAILURES = "failures"
    EVERYTHING = "everything"

    def includes(self, outcome: Outcome) -> bool:
        """Return whether a stored run is repeated."""
        return self is Repeat.EVERYTHING or (self is Repeat.FAILURES and is_failure(outcome))


def is_failure(outcome: Outcome) -> bool:
    """Return whether a run failed, was stopped by its time limit, or ended with an error."""
    return outcome.row.verdict == FAIL or outcome.row.status in _WITHOUT_ANSWER


def describe_failures(outcomes: Sequence[Outcome]) -> str:
    """Report how many stored runs are failures, and how to repeat them; empty without any."""
    statuses = Counter(outcome.row.status for outcome in outcomes if is_failure(outcome))
    if not statuses:
        return ""
    count = statuses.total()
    used = "stored failure is used" if count == 1 else "stored failures are used"
    kinds = ", ".join(f"{number} {status}" for status, number in sorted(statuses.items()))
    again = "it" if count == 1 else "them"
    return f"{count} {used} ({kinds}); --retry failed repeats {again}"
