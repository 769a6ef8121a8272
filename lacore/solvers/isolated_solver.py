"""Prepared solver that works in the process of its backend."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from typing import Any

from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.reporting.errors import BackendError
from lacore.solvers.child_process import GRACE, LONGEST, START, LostError
from lacore.solvers.contract import InnerSolution, failed_answer
from lacore.solvers.plain_answers import read_answer
from lacore.solvers.served_process import Replacement, ServedProcess, Source

_READ_ONLY = ("is read-only", "cannot set WRITEABLE flag")  # messages of NumPy


class IsolatedSolver:
    """Prepared solver whose work is done by a `ServedProcess`."""

    def __init__(
        self, process: ServedProcess, source: Source, program: KinematicProgram, options: Any
    ) -> None:
        self._process = process
        self._limit = min(float(options.time_limit) + GRACE, LONGEST)
        self._lost: InnerSolution | None = None
        self._number = process.new_number()
        self._name = source.name
        self._closed = False
        self._asked(partial(process.serve, source))  # Imports do not count to the time limit.
        self._generation = process.generation
        self._asked(
            partial(process.ask, self._limit, "prepare", self._number, program, asdict(options))
        )

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve in the process; if the process is lost, this is the final status.

        Raises:
            RuntimeError: The process was closed, or given to another backend, in the meantime.
            BackendError: The backend raised an error.
        """
        if self._lost is None and not self._process.holds(self._generation):
            raise RuntimeError("the process of this solver was closed or given to another backend")
        begin = time.perf_counter()
        sent = self._asked(partial(self._process.ask, self._limit, "solve", self._number, contact))
        if self._lost is not None:
            return self._lost
        return _read(sent, time.perf_counter() - begin)

    def _asked(self, ask: Callable[[], Any]) -> Any:
        if self._lost is not None:
            return None
        begin = time.perf_counter()
        try:
            return ask()
        except LostError as lost:
            spent = time.perf_counter() - begin
            self._lost = InnerSolution(lost.status, lost.native, 0, spent, None, message=str(lost))
            return None
        except BackendError as error:
            text = f"backend {self._name!r} raised {error}"
            if any(words in str(error) for words in _READ_ONLY):
                text += ": the arrays of a program cannot be changed; copy them before scaling"
            named = BackendError(text)
            for note in getattr(error, "__notes__", ()):
                named.add_note(note)
            raise named from error

    def close(self) -> None:
        """Drop the solver in the process; a process in which something is left running ends."""
        if self._closed or self._lost is not None or not self._process.holds(self._generation):
            return
        self._closed = True
        self._asked(partial(self._process.ask, self._limit, "close", self._number))
        left = self._asked(partial(self._process.ask, START, "rest"))
        if left:
            self._process.replace_for(Replacement(f"it was left with {left}", left_running=True))


def _read(sent: Any, seconds: float) -> InnerSolution:
    try:
        return read_answer(sent["answer"], seconds, float(sent["memory"]))
    except (KeyError, TypeError, ValueError) as error:
        return failed_answer(f"its process sent no answer: {error}", seconds)
