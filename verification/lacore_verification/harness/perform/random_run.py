"""The row of one random problem."""

from collections.abc import Callable, Mapping
from math import isnan, nan
from typing import Any

import lacore as la
from lacore.solvers.compilation import SolveClock
from lacore_verification.fuzz.checks.verdict import Judgement
from lacore_verification.fuzz.drawn.cases import kind_of, random_numbers, recipe_of
from lacore_verification.fuzz.examine import examine
from lacore_verification.harness.verdicts.words import FAIL, NO_RESULT, PASS, SKIPPED
from lacore_verification.runs.outcome import NO_EVIDENCE, Outcome
from lacore_verification.runs.row import Row
from lacore_verification.runs.run import Run

LOAD, NO_LOAD, UNKNOWN = "a load", "no load", "unknown"
_RIGHT = (la.Status.SOLVED, la.Status.LOCKED, la.Status.UNSAFE, la.Status.FREE)


def run_random(run: Run, names: Mapping[str, Any], memory: Callable[[], float]) -> Outcome:
    """Solve and evaluate a random problem.

    Args:
        run: the run.
        names: columns that are known already.
        memory: peak memory of this process, MB.
    """
    clock = SolveClock()
    kind = kind_of(run)
    found = examine(recipe_of(kind, **run.parameters), random_numbers(kind, **run.parameters))
    verdict, check, why = _verdict(found)
    row = Row(
        **{**names, "coupling": run.coupling},
        load_factor=found.load_factor,
        rigor=found.rigor,
        status=found.status,
        expected={True: LOAD, False: NO_LOAD, None: UNKNOWN}[found.has_load],
        lower=found.lower,
        upper=found.upper,
        message=found.message,
        verdict=verdict,
        why=why,
        check=check,
        solve_time=clock.seconds,
        peak_memory_mb=memory(),
    )
    return Outcome(run, row, NO_EVIDENCE)


def _verdict(found: Judgement) -> tuple[str, str, str]:
    """Return the verdict, the check that fails, and why."""
    if found.wrong is not None:
        return FAIL, found.wrong.check, str(found.wrong)
    if found.status == "refused":
        return SKIPPED, "", found.message
    right = found.status in [status.label for status in _RIGHT]
    if found.status == la.Status.SOLVED.label and isnan(found.load_factor):
        return FAIL, "number", f"number: solved, and the load factor is {nan}"
    return (PASS, "", "") if right else (NO_RESULT, "", found.status)
