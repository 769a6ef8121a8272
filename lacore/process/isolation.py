"""A backend in a process of its own: one that hangs, crashes or is killed becomes a status."""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import replace
from types import TracebackType
from typing import Any

from lacore.backend import Backend, InnerSolution, PreparedSolver
from lacore.process.child_process import (
    GRACE,
    LONGEST,
    START,
    ChildProcess,
    LostError,
    forget_peak_memory,
    peak_memory,
)
from lacore.program import FrozenContact, KinematicProgram

_WORKER = "lacore.process.isolation:SolverWorker"


class SolverProcess:
    """An interpreter that runs backends one after the other; started anew when one kills it.

    A context manager: leaving it stops the process. For one thread at a time: it holds one program.

    Example:
        >>> with la.SolverProcess() as process:  # a solver that crashes does not end this one
        ...     state = la.solve(la.examples.beam(), process=process)
        >>> round(state.load_factor, 3)
        2.0
    """

    def __init__(self) -> None:
        self._process = ChildProcess(_WORKER)
        self._holder: IsolatedSolver | None = None

    def load(self, backend: Backend) -> float:
        """Import a backend in this process; s, what that and the start of it took."""
        begin = time.perf_counter()
        with suppress(LostError):  # a process that is lost now is lost to the solver too
            self.ask(START, "load", backend)
        return time.perf_counter() - begin

    def prepare(self, backend: Backend, program: KinematicProgram, options: Any) -> IsolatedSolver:
        """The backend at work on one program in this process; the one before it is dropped."""
        return IsolatedSolver(self, backend, program, options)

    def hand_to(self, solver: IsolatedSolver | None) -> None:
        """What is asked from now on is about this solver."""
        self._holder = solver

    def held_by(self, solver: IsolatedSolver) -> bool:
        """Whether the process still has the program of this solver."""
        return self._holder is solver and self._process.running

    @property
    def processor_time(self) -> float:
        """What it has used since it was started, s; NaN where it is lost."""
        try:
            return float(self.ask(START, "processor_time"))
        except LostError:
            return float("nan")

    def ask(self, limit: float, *request: Any) -> Any:
        """As `ChildProcess.ask`."""
        return self._process.ask(limit, *request)

    def close(self) -> None:
        """Stop the process; the next request starts another."""
        self._holder = None
        self._process.close()

    def __enter__(self) -> SolverProcess:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


class IsolatedSolver:
    """A prepared solver whose work is done by a `SolverProcess`."""

    def __init__(
        self, process: SolverProcess, backend: Backend, program: KinematicProgram, options: Any
    ) -> None:
        self._process = process
        self._limit = min(float(options.time_limit) + GRACE, LONGEST)
        self._lost: InnerSolution | None = None
        process.hand_to(self)
        self._ask(START, "load", backend)  # imports are not to be paid from the time limit
        self._ask(self._limit, "prepare", program, options)

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """As the backend does; a process lost is a status, and final.

        Raises:
            RuntimeError: the process was closed, or given to another program, in the meantime.
        """
        if self._lost is None and not self._process.held_by(self):
            raise RuntimeError("the process of this solver was closed or given to another program")
        answer: InnerSolution = self._ask(self._limit, "solve", contact)
        return self._lost or answer

    def _ask(self, limit: float, *request: Any) -> Any:
        if self._lost is not None:
            return None
        begin = time.perf_counter()
        try:
            return self._process.ask(limit, *request)
        except LostError as lost:
            spent = time.perf_counter() - begin
            self._lost = InnerSolution(lost.status, lost.native, 0, spent, None, message=str(lost))
            return None

    def close(self) -> None:
        """Drop the solver in the process; the process stays."""
        if self._process.held_by(self):
            self._process.hand_to(None)
            self._ask(self._limit, "close")


class SolverWorker:
    """What can be asked of the process."""

    def __init__(self) -> None:
        self._backend: Backend | None = None
        self._solver: PreparedSolver | None = None

    def load(self, backend: Backend) -> None:
        """A backend to work with; unpickled, it has been imported."""
        self._backend, self._solver = backend, None
        forget_peak_memory()

    def prepare(self, program: KinematicProgram, options: Any) -> None:
        """As the backend does."""
        assert self._backend is not None
        self._solver = self._backend.prepare(program, options)

    def solve(self, contact: FrozenContact) -> Any:
        """As the solver does, with its memory."""
        assert self._solver is not None
        answer = self._solver.solve(contact)
        if isinstance(answer, InnerSolution):  # anything else is for `checked_answer`
            return replace(answer, peak_memory=peak_memory())
        return answer

    def processor_time(self) -> float:
        """Of this process, s."""
        return time.process_time()

    def close(self) -> None:
        """Drop the solver."""
        solver, self._solver = self._solver, None
        if solver is not None:
            solver.close()
