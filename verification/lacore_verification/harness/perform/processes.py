"""Runs in several processes at a time: one that hangs or dies affects its own row only."""

import threading
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from contextlib import ExitStack
from dataclasses import replace
from queue import SimpleQueue
from typing import Protocol

import lacore as la
from lacore.solvers.child_process import (
    GRACE,
    LONGEST,
    START,
    ChildProcess,
    LostError,
)
from lacore.solvers.isolation import release_processes
from lacore.solvers.process_log import ProcessLog
from lacore.solvers.served_process import ISOLATE, WARM_UP
from lacore_verification.case import BRACKET, Case, is_of_lacore
from lacore_verification.defaults import TIME_LIMIT
from lacore_verification.harness.verdicts.words import FAIL, NO_RESULT
from lacore_verification.runs.outcome import Evidence, Outcome
from lacore_verification.runs.row import Row
from lacore_verification.runs.run import Run

_TRACED = {"PYTHONFAULTHANDLER": "1"}  # A crash leaves a traceback in the log of its run.
_JUDGING = {ISOLATE: "all"}  # Backends only solve, each in its own process.
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""Environment of processes that share the cores."""
_WORKER = "lacore_verification.harness.perform.worker:Worker"
_ATTEMPTS = 2  # A process may have been killed externally.

OnStart = Callable[[Run], None]


class Executor(Protocol):
    """Executor of runs: `run_in_processes`, or its counterpart on other machines."""

    def __call__(
        self, runs: Sequence[Run], *, time_limit: float, on_start: OnStart
    ) -> Generator[Outcome, None, None]:
        """Yield outcomes as they come; closing the generator stops running ones."""


class RunProcess(ChildProcess):
    """A process that executes and evaluates runs, on one thread, without code of backends.

    A case of a user gets its own process, and so does the next run: it may have left any trace in
    an interpreter, from a missing path to settings that change numbers.
    """

    def __init__(self) -> None:
        self.log = ProcessLog()
        super().__init__(_WORKER, ONE_THREAD | _JUDGING | _TRACED, log=self.log)
        self._case: Case | None = None

    def ask_for(self, run: Run, limit: float, time_limit: float) -> tuple[Row, Evidence]:
        """Return row and evidence of a run by its `Worker`, within `limit` seconds.

        Raises as `ask`.
        """
        before, self._case = self._case or run.case, run.case
        if before.id != run.case.id and not all(map(is_of_lacore, (before, run.case))):
            self.close()
        if not run.skip:
            self.ask(START + WARM_UP, "open", run.backend)  # It is not part of the time limit.
        row, evidence = self.ask(limit, "row_of", run, time_limit)
        return row, evidence


def lost(run: Run, status: la.Status, message: str) -> Outcome:
    """Return the row of a lost run; a late one has no result, as in `judge`."""
    late = status is la.Status.TIME_LIMIT and run.coupling != BRACKET
    verdict = NO_RESULT if late and not run.insist else FAIL
    row = Row(
        **run.names,
        status=status.label,
        message=message,
        verdict=verdict,
        why=message,
        check=status.label,
    )
    return Outcome(run, row)


def attempt(child: RunProcess, run: Run, time_limit: float, stop: threading.Event) -> Outcome:
    """Return a run in a process, with its output; see `_attempt`."""
    child.log.take()  # Discard earlier output.
    outcome = _attempt(child, run, time_limit, stop)
    return replace(outcome, log=child.log.take())


def _attempt(child: RunProcess, run: Run, time_limit: float, stop: threading.Event) -> Outcome:
    """Return a run in a process; it is repeated if the process died, unless all are stopped."""
    for tries_left in reversed(range(_ATTEMPTS)):
        try:
            limit = min(time_limit + GRACE, LONGEST)
            row, evidence = child.ask_for(run, limit, time_limit)
        except LostError as error:
            if error.status is la.Status.TIME_LIMIT or stop.is_set() or not tries_left:
                return lost(run, error.status, str(error))
        except Exception as error:  # Errors in transfer; the other runs continue.
            return lost(run, la.Status.FAILED, f"{type(error).__name__}: {error}")
        else:
            return Outcome(run, row, evidence)
    raise AssertionError("each attempt returns, but for the last")


def run_in_processes(
    runs: Sequence[Run],
    jobs: int = 1,
    time_limit: float = TIME_LIMIT,
    on_start: OnStart = lambda _: None,
) -> Generator[Outcome, None, None]:
    """Yield outcomes as they come, of `jobs` processes; `time_limit`, s, is that of a run.

    A run that takes longer is stopped; closing the iterator stops all running ones. `on_start` is
    called from separate threads.
    """
    release_processes()  # These processes were started for the plan.
    stop = threading.Event()
    children = [RunProcess() for _ in range(max(min(jobs, len(runs)), 1))]
    idle: SimpleQueue[RunProcess] = SimpleQueue()
    for child in children:
        idle.put(child)

    def task(run: Run) -> Outcome:
        child = idle.get()
        try:
            on_start(run)
            return attempt(child, run, time_limit, stop)
        finally:
            idle.put(child)

    with ExitStack() as stack:
        for child in children:
            stack.callback(child.close)
        pool = stack.enter_context(ThreadPoolExecutor(len(children)))

        def abandon() -> None:
            stop.set()
            pool.shutdown(wait=False, cancel_futures=True)
            for child in children:
                child.kill()

        stack.callback(abandon)
        futures: list[Future[Outcome]] = [pool.submit(task, run) for run in runs]
        for future in as_completed(futures):
            yield future.result()
