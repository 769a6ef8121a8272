"""Methods of the process of one backend: it describes itself, prepares and solves.

The other side trusts nothing here, because code of the backend runs in the same interpreter.
"""

from __future__ import annotations

import threading
import time
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

from lacore.numerics.read_only import changed, digests, make_read_only
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.solvers.child_process import forget_peak_memory, peak_memory
from lacore.solvers.contract import (
    Backend,
    Family,
    InnerSolution,
    PreparedSolver,
    WarmsUp,
    Writes,
    failed_answer,
)
from lacore.solvers.description import describe
from lacore.solvers.plain_answers import pack_answer

_BUSY = 0.5  # share of a processor that shows that an idle process works
_IDLE = 0.3  # s of idling before this is checked: MKL's threads wait actively for 0.2 s


class SolverWorker:
    """One backend in this process, for any number of programs."""

    def __init__(self) -> None:
        self._backend: Backend | None = None
        self._solvers: dict[int, tuple[PreparedSolver, KinematicProgram, dict[str, str]]] = {}
        self._threads = frozenset(threading.enumerate())
        self._rest = time.perf_counter(), time.process_time()

    def open(self, target: str, variant: str) -> dict[str, Any]:
        """Import a backend, and return its description.

        Args:
            target: ``module:attribute`` of its class.
            variant: Variant of a family; empty for the backend itself.
        """
        backend: Backend = resolve_name(target)()
        if variant:
            if not isinstance(backend, Family):
                raise TypeError(f"{target} has no variants")
            backend = backend.variant(variant)
        self._backend = backend
        about = describe(backend)
        self._idle_from_now()
        return about

    def warm_up(self) -> bool:
        """Let the backend compile, see `WarmsUp`; return whether it has anything to compile."""
        backend = self._own
        if not isinstance(backend, WarmsUp):
            return False
        try:
            backend.warm_up()
        except Exception as error:
            raise RuntimeError(f"warm_up() raised {type(error).__name__}: {error}") from error
        self._idle_from_now()
        return True

    def check_options(self, values: dict[str, Any]) -> None:
        """Let the backend check options; it raises `InputError` for values out of range."""
        self._own.Options(**values)
        self._idle_from_now()

    def prepare(self, number: int, program: KinematicProgram, values: dict[str, Any]) -> None:
        """Prepare a program, which the backend can only read."""
        forget_peak_memory()
        make_read_only(program)
        before = digests(program)
        solver = self._own.prepare(program, self._own.Options(**values))
        for method in ("solve", "close"):
            if not callable(getattr(solver, method, None)):
                raise TypeError(
                    f"prepare() returned {str(solver)[:60]!r}, which has no method {method}:"
                    " return a prepared solver with the methods solve(contact) and close()"
                )
        self._solvers[number] = solver, program, before
        self._idle_from_now()

    def solve(self, number: int, contact: FrozenContact) -> dict[str, Any]:
        """Return the answer for a frozen contact, with data on this process."""
        solver, program, before = self._solvers[number]
        make_read_only(contact)
        frozen = digests(contact, "contact")
        answer: object = solver.solve(contact)
        if names := changed(before, program) + changed(frozen, contact, "contact"):
            seconds = answer.solve_time if isinstance(answer, InnerSolution) else 0.0
            answer = failed_answer(
                f"the backend changed the program that it was given ({', '.join(names)}): copy"
                " arrays before scaling them",
                seconds,
            )
        sent = {"answer": pack_answer(answer), "memory": peak_memory()}
        self._idle_from_now()  # Another program may be closed, or started, before this one.
        return sent

    def close(self, number: int) -> None:
        """Drop a solver."""
        solver, _, _ = self._solvers.pop(number)
        solver.close()

    def write(
        self, ending: str, program: KinematicProgram, contact: FrozenContact, path: str
    ) -> None:
        """Write a program to a file, see `Writes`."""
        backend = self._own
        assert isinstance(backend, Writes)
        backend.writers[ending](program, contact, Path(path))
        self._idle_from_now()

    def rest(self) -> str:
        """Return what the backend has left running; empty if nothing. Idling begins here.

        Nothing is left as long as a solver is prepared: what runs may belong to it.
        """
        self._idle_from_now()
        if self._solvers:
            return ""
        threads = [thread.name for thread in set(threading.enumerate()) - self._threads]
        found = []
        if threads:
            found.append(f"{len(threads)} threads ({', '.join(sorted(threads)[:4])})")
        if names := _children():
            found.append(f"{len(names)} child processes ({', '.join(sorted(names)[:4])})")
        return " and ".join(found)

    def _idle_from_now(self) -> None:
        """Begin to count processor time between requests."""
        self._rest = time.perf_counter(), time.process_time()

    def was_busy(self) -> bool:
        """Return whether the process computed between requests, as native threads may.

        As long as a solver is prepared it may, and the process has to be kept for it.
        """
        if self._solvers:
            return False
        idle, used = (
            now - then
            for now, then in zip(
                (time.perf_counter(), time.process_time()), self._rest, strict=True
            )
        )
        return idle > _IDLE and used > _BUSY * idle

    def processor_time(self) -> float:
        """Return the processor time of this process, s."""
        return time.process_time()

    @property
    def _own(self) -> Backend:
        assert self._backend is not None
        return self._backend


def _children() -> list[str]:
    """Return the names of the running child processes; empty where the system lists none."""
    found = []
    for task in Path("/proc/self/task").glob("*/children"):
        try:
            numbers = task.read_text().split()
        except OSError:
            continue
        for number in numbers:
            try:
                about = Path(f"/proc/{number}/stat").read_text()
            except OSError:
                continue  # It has ended meanwhile.
            name, _, rest = about.partition("(")[2].rpartition(")")
            # A zombie has ended, and only waits for its status to be read.
            if rest.split()[0] != "Z":
                found.append(name)
    return found
