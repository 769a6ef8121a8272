"""Execution of any run: its assembled problem, its row, and the row of a lost one."""

from __future__ import annotations  # Annotations are not evaluated: their names are not loaded.

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from math import nan
from typing import Any

import lacore as la
from lacore.reporting.errors import BackendError
from lacore_verification.case.band import BRACKET
from lacore_verification.case.case import RANGE
from lacore_verification.harness.verdicts.allowed import about
from lacore_verification.harness.verdicts.words import FAIL, SKIPPED
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.row import Row
from lacore_verification.runs.run import FUZZ, Run


@dataclass(frozen=True)
class Assembled:
    """A discretised problem, and the time of its assembly, s."""

    discretisation: la.Discretisation
    build_time: float


def assemble(run: Run) -> Assembled | Exception:
    """Return the problem of a run, or its error, so that other runs continue."""
    begin = time.perf_counter()
    try:
        discretisation = la.discretise(run.problem())
    except Exception as error:
        return error
    return Assembled(discretisation, time.perf_counter() - begin)


def run_here(runs: Iterable[Run], time_limit: float | None = None) -> Iterator[Outcome]:
    """Run one after the other in this process; neighbours share their discretisation.

    `time_limit`: s, of each inner solve, as far as its backend keeps it.
    """
    key: tuple[object, ...] = ()
    assembled: Assembled | Exception = RuntimeError("nothing assembled")
    for run in runs:
        if run.problem_key != key:
            key, assembled = run.problem_key, assemble(run)
        yield outcome_of(run, assembled, time_limit)


def outcome_of(
    run: Run,
    assembled: Assembled | Exception,
    time_limit: float | None = None,
    memory: Callable[[], float] = lambda: nan,
    on_error: Callable[[Exception], object] = lambda _: None,
) -> Outcome:
    """Return one row in all cases.

    Args:
        run: the run.
        assembled: its problem, or the error.
        time_limit: s, of each inner solve, if the backend supports it.
        memory: peak memory of this process, MB.
        on_error: called with an exception that is neither bad input nor a missing capability.
    """
    names = run.names
    if run.coupling == FUZZ:
        return _random(run, names, memory)
    if isinstance(assembled, Exception):
        return (
            _skipped(run, names, run.skip) if run.skip else Outcome(run, _failed(names, assembled))
        )
    discretisation = assembled.discretisation
    names["n_elements"] = discretisation.n_elements
    names["n_dofs"] = discretisation.program.n
    names["build_time"] = assembled.build_time
    try:
        return _performed(run, names, discretisation, time_limit, memory)
    except la.CapabilityError as error:
        return _skipped(run, names, str(error))
    except la.InputError as error:
        if run.coupling == RANGE and error.field == "problem":
            return _skipped(run, names, f"no range: {error}")
        if run.coupling == BRACKET and error.field.startswith("Problem"):
            return _skipped(run, names, f"no bracket can be stated: {error}")
        return Outcome(run, _failed(names, error))
    except Exception as error:  # An error of a backend must not affect the results of others.
        on_error(error)
        return Outcome(run, _failed(names, error))


def _performed(
    run: Run,
    names: dict[str, Any],
    discretisation: la.Discretisation,
    time_limit: float | None,
    memory: Callable[[], float],
) -> Outcome:
    """Perform a run, and add its reference to `names`; other kinds of runs are not imported."""
    reference = run.case.reference_of(run.variant)
    names |= about(reference)
    band = run.case.band_of(run.variant, discretisation.n_elements)
    if run.skip:
        return _skipped(run, names, run.skip)
    if run.coupling == BRACKET:
        from lacore_verification.harness.perform.bracket import run_bracket

        return run_bracket(run, names, discretisation.problem, time_limit, memory)
    if run.coupling == RANGE:
        from lacore_verification.harness.perform.ranging import run_range

        return run_range(run, names, discretisation, reference, band, memory)
    if run.case.path is not None:
        from lacore_verification.harness.perform.path import run_path

        return run_path(run, names, discretisation, reference, band, time_limit, memory)
    from lacore_verification.harness.perform.limit_state import run_limit_state

    return run_limit_state(run, names, discretisation, reference, band, time_limit, memory)


def _random(run: Run, names: dict[str, Any], memory: Callable[[], float]) -> Outcome:
    from lacore_verification.harness.perform.random_run import run_random

    try:
        return run_random(run, names, memory)
    except Exception as error:  # The row reports an error of a check.
        return Outcome(run, _failed(names, error))


def _skipped(run: Run, names: dict[str, Any], why: str) -> Outcome:
    row = Row(**names, status="skipped", message=why, verdict=SKIPPED, why=why)
    return Outcome(run, row)


def _failed(names: dict[str, Any], error: Exception) -> Row:
    named = isinstance(error, BackendError)
    message = str(error) if named else f"{type(error).__name__}: {error}"
    return Row(
        **names,
        status="failed",
        message=message,
        verdict=FAIL,
        why=message,
        check=type(error).__name__,
    )
