"""The part of a comparison that executes runs, in a separate process."""

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from math import inf, nan
from traceback import print_exception

import lacore as la
from lacore.program.kinematic import associated_contact, dimensionless
from lacore.solvers.child_process import forget_peak_memory, peak_memory
from lacore.solvers.isolation import IsolatedBackend
from lacore.solvers.registry import CALIBRATION, load_backend, own_backend
from lacore_verification.harness.perform.one_run import Assembled, assemble, outcome_of
from lacore_verification.runs.outcome import Evidence
from lacore_verification.runs.row import Row
from lacore_verification.runs.run import FUZZ, Run

# Relative to its own time, between two of these solves: they take at most 1 %.
_LEAST_PAUSE = 100.0


class Worker:
    """Worker process: it executes runs in turn.

    Consecutive runs of one problem share its assembly.
    """

    def __init__(self) -> None:
        self._key: tuple[object, ...] = ()
        self._assembled: Assembled | Exception = RuntimeError("nothing assembled")
        self._calibration = Calibration()
        self._calibrated = nan

    def open(self, backend: str) -> None:
        """Start the process of a backend, which imports and compiles it.

        Errors are reported by `row_of`.
        """
        with suppress(la.LacoreError):
            found = load_backend(backend)
            if isinstance(found, IsolatedBackend):
                found.start()
        self._calibrated = self._calibration.seconds()

    def row_of(self, run: Run, time_limit: float) -> tuple[Row, Evidence]:
        """Return row and evidence of a run; `time_limit`, s, is that of each inner solve."""
        forget_peak_memory()
        if run.coupling != FUZZ and run.problem_key != self._key:
            self._key, self._assembled = run.problem_key, assemble(run)
        if run.skip:  # Its backend may hang while it is loaded.
            skipped = outcome_of(run, self._assembled)
            return skipped.row, skipped.evidence
        outcome = outcome_of(run, self._assembled, time_limit, peak_memory, print_exception)
        row, note = _with_compile_time(outcome.row), _note(run.backend)
        row = replace(
            row,
            calibration_before=self._calibrated,
            calibration_after=self._calibration.seconds(),
        )
        if note:
            row = replace(row, message="; ".join(filter(None, (row.message, note))))
        return row, outcome.evidence


def _note(backend: str) -> str:
    """Return why the process of a backend was replaced during a run; empty if it was not."""
    try:
        found = load_backend(backend)
    except la.CapabilityError:  # The row reports it.
        return ""
    note = found.process.take_note() if isinstance(found, IsolatedBackend) else None
    return "" if note is None else str(note)


def _with_compile_time(row: Row) -> Row:
    """Return a row with the time of the warm-up in the process of its backend.

    Rows of a backend that cannot be loaded, or works in this process, stay as they are.
    """
    try:
        found = load_backend(row.backend)
    except la.CapabilityError:  # The row reports it.
        return row
    if not isinstance(found, IsolatedBackend):
        return row
    return replace(row, compile_time=found.process.compile_time)


class Calibration:
    """The solve, repeated at intervals in one process; it is prepared when it is first needed."""

    def __init__(self) -> None:
        self._solve: Callable[[], object] | None = None
        self._due = -inf

    def seconds(self) -> float:
        """Solve again; return the time that it took, s, or NaN if it was done a short time ago."""
        if time.perf_counter() < self._due:
            return nan
        if self._solve is None:
            self._solve = _prepared()
            self._solve()  # The first one loads libraries and fills caches.
        begin = time.perf_counter()
        self._solve()
        end = time.perf_counter()
        self._due = end + _LEAST_PAUSE * (end - begin)
        return end - begin


def _prepared() -> Callable[[], object]:
    """Return a footing on clay with a backend of lacore, in this process."""
    backend = own_backend(CALIBRATION)
    discretisation = la.discretise(la.examples.footing())
    program = dimensionless(discretisation.program, discretisation.natural).associated()
    contact = associated_contact(program.contact)
    solver = backend.prepare(program, backend.Options())
    return lambda: solver.solve(contact)
