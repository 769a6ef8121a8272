"""Execution of a plan: each run is stored as soon as it is finished, even if it failed."""

from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import closing
from enum import Enum
from pathlib import Path

import lacore as la
from lacore_verification.defaults import TIME_LIMIT
from lacore_verification.harness.perform.processes import Executor, run_in_processes
from lacore_verification.harness.store.logs import with_log
from lacore_verification.harness.store.provenance import code_of, describe, solvers_of
from lacore_verification.harness.store.store import Store
from lacore_verification.harness.verdicts.words import FAIL
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.run import Run

_WITHOUT_ANSWER = (la.Status.TIME_LIMIT.label, la.Status.FAILED.label)


class Repeat(Enum):
    """Selection of the stored runs that are repeated."""

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


def run_all(
    runs: Sequence[Run],
    path: Path,
    on_start: Callable[[Run], None] = lambda _: None,
    on_finish: Callable[[Outcome], None] = lambda _: None,
    executor: Executor = run_in_processes,
    time_limit: float = TIME_LIMIT,
    repeat: Repeat = Repeat.NOTHING,
    on_found: Callable[[Sequence[Outcome]], None] = lambda _: None,
) -> list[Outcome]:
    """Return outcomes of runs, in their order; each is stored at `path` as soon as it is finished.

    Those that are stored already, computed by the same code, are not run again, whether they
    succeeded or failed, except for those that `repeat` includes; `on_found` is called with them.
    `executor` runs the others; `time_limit`, s, is that of one run; if it takes longer, or its
    process dies, only its row is lost. The output of a run is stored next to the store.

    Raises:
        InputError: the store cannot be used.
    """
    codes = {run.key: code_of(run) for run in runs}
    with Store(path, describe(name for run in runs for name in solvers_of(run))) as store:
        stored = store.finished((run, codes[run.key]) for run in runs)
        found = {key: own for key, own in stored.items() if not repeat.includes(own)}
        on_found(list(found.values()))
        for outcome in found.values():
            on_finish(outcome)
        due = list({run.key: run for run in runs if run.key not in found}.values())
        with closing(executor(due, time_limit=time_limit, on_start=on_start)) as outcomes:
            for finished in outcomes:
                outcome = with_log(finished, path.parent)
                store.append(outcome, codes[outcome.run.key])
                found[outcome.run.key] = outcome
                on_finish(outcome)
    return [found[run.key] for run in runs]
