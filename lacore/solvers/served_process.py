"""Interpreter in which one backend works, and its time to start.

It is started again if the backend kills it, or leaves something running in it.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from math import nan
from typing import Any, Self

from lacore.solvers.child_process import START, ChildProcess, LostError
from lacore.solvers.compilation import compiling

_WORKER = "lacore.solvers.solver_worker:SolverWorker"
_CODEC = "lacore.solvers.plain_answers:PlainAnswers"
WARM_UP = 300.0  # s, for compilation; lacore's own backends need 24 s on an idle machine
ISOLATE = "LACORE_ISOLATE_BACKENDS"
"""Environment variable of processes in which all backends are isolated, also those of lacore."""


@dataclass(frozen=True)
class Source:
    """Where a backend is found.

    Attributes:
        name: Name under which it is registered, with its variant: ``cvxpy:SCS``.
        target: ``module:attribute`` of its class.
        variant: Variant of a family; empty for the backend itself.
        file: File that registers it, for messages.
    """

    name: str
    target: str
    variant: str = ""
    file: str = ""


@dataclass(frozen=True)
class Replacement:
    """Why a process was replaced.

    Attributes:
        reason: Text.
        left_running: Whether threads or processes remained after its solver was closed.
    """

    reason: str
    left_running: bool = False

    def __str__(self) -> str:
        return f"the process of the backend was replaced: {self.reason}"


class ServedProcess:
    """Process for one backend at a time; for another one it is started again.

    A context manager: leaving it stops the process. For one thread at a time.
    """

    def __init__(self) -> None:
        self._process = ChildProcess(_WORKER, {ISOLATE: ""}, _CODEC)
        self._source: Source | None = None
        self._generation = 0
        self._count = 0
        self._replaced: Replacement | None = None
        self._warm = False
        self._to_warm_up: set[Source] = set()
        self._lost: dict[Source, LostError] = {}
        self._compile_time = nan

    def open(self, source: Source) -> Any:
        """Start the process with a backend, and return its description.

        Raises:
            LostError: It hangs or ends while it is imported.
            BackendError: It raises.
        """
        if self._process.running:
            self.close()
        self._generation += 1
        self._warm, self._compile_time = False, nan
        with compiling():
            about = self._process.ask(START, "open", source.target, source.variant)
        self._source = source
        return about

    def warm_up(self, source: Source) -> None:
        """Start the backend, compiled, and compile it again whenever the process is restarted.

        Raises:
            LostError: Its `warm_up` hangs, or ends the process; it is not called again.
            BackendError: Its `warm_up` raises. Also see `open`.
        """
        self._to_warm_up.add(source)
        self.serve(source)

    def serve(self, source: Source) -> None:
        """Start the backend in a process that nothing else uses.

        Raises:
            LostError, BackendError: See `open` and `warm_up`.
        """
        if source in self._lost:  # A warm-up that hangs costs its time only once.
            raise self._lost[source]
        if self._source == source and self._process.running and self._was_busy():
            self.replace_for(Replacement("it computed without a request"))
        if self._source != source or not self._process.running:
            self.open(source)
        if source in self._to_warm_up and not self._warm:
            self._compile(source)

    def _compile(self, source: Source) -> None:
        begin = time.perf_counter()
        try:
            with compiling():
                compiles = self._process.ask(WARM_UP, "warm_up")
        except LostError as lost:
            self._lost[source] = LostError(lost.status, lost.native, f"in warm_up(): {lost}")
            raise self._lost[source] from lost
        self._warm = True
        self._compile_time = time.perf_counter() - begin if compiles else nan

    @property
    def compile_time(self) -> float:
        """Time of `warm_up` in the running process, s; NaN without one."""
        return self._compile_time

    def _was_busy(self) -> bool:
        try:
            return bool(self._process.ask(START, "was_busy"))
        except LostError:
            return False  # It is started again in any case.

    def new_number(self) -> int:
        """Return a number for a program that is prepared here."""
        self._count += 1
        return self._count

    @property
    def generation(self) -> int:
        """Number of starts of the process."""
        return self._generation

    def replace_for(self, why: Replacement) -> None:
        """Stop the process, and note why; see `take_note`."""
        self._replaced = why
        self.close()

    def take_note(self) -> Replacement | None:
        """Return why the process was last replaced, and forget it; None if it was not."""
        note, self._replaced = self._replaced, None
        return note

    def holds(self, generation: int) -> bool:
        """Return whether the process is the one of this start."""
        return self._generation == generation and self._process.running

    @property
    def processor_time(self) -> float:
        """Processor time since its start, s; NaN if it is lost."""
        if not self._process.running:
            return 0.0
        try:
            return float(self.ask(START, "processor_time"))
        except LostError:
            return float("nan")

    def ask(self, limit: float, *request: Any) -> Any:
        """Return the answer to a request, see `ChildProcess.ask`."""
        return self._process.ask(limit, *request)

    def close(self) -> None:
        """Stop the process; the next request starts another."""
        self._source = None
        self._process.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()
