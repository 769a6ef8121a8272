"""Checks of the answer of a backend to a random program."""

import time
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from math import nan
from typing import Any

import numpy as np

from lacore.coupling.claims.proving import prove_claim
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.residuals import scaled_residual
from lacore.reporting.errors import CapabilityError, LacoreError
from lacore.reporting.status import Status
from lacore.solvers.backend import (
    Backend,
    InnerSolution,
    check_capable,
    checked_answer,
    find_backend,
    read_options,
)
from lacore.solvers.child_process import ENDED
from lacore.solvers.contract import PreparedSolver, failed_answer, fault_of
from lacore.solvers.inner.preparing import preparer
from lacore.solvers.inner.rescaling import good_for
from lacore.solvers.isolation import IsolatedBackend
from lacore.solvers.registry import PROVING_BACKEND
from lacore.solvers.served_process import Replacement
from lacore_verification.fuzz.programs.drawn import Drawn

RIGHT, WRONG, NOTHING, REFUSED = "right", "wrong", "no answer", "refused"
BAR = 1e-6  # For the residuals of a certificate, and for load factors.
REFUTED = 1e-3  # A larger residual of "almost solved" is a wrong claim.
_NUMBERS = (Status.SOLVED, Status.ALMOST_SOLVED)  # Residuals decide whether "almost" is enough.
_WORDS = (Status.LOCKED, Status.UNSAFE)


@dataclass(frozen=True)
class ProgramRun:
    """Result of a backend for a program.

    Attributes:
        backend: its name.
        answer: None if it does not support such programs.
        residual: the largest, recomputed; NaN without a point.
        seconds: processor time with set-up.
        fault: an error that the backend raised, an answer that breaks the protocol, a crash, or
            remaining processes; empty if there is none.
    """

    backend: str
    answer: InnerSolution | None
    residual: float
    seconds: float
    fault: str = ""

    @property
    def solved(self) -> bool:
        """Whether it claims a number."""
        return self.answer is not None and self.answer.status is Status.SOLVED

    @property
    def holds(self) -> bool:
        """Whether it has a number that residuals prove."""
        claims = self.answer is not None and self.answer.status in _NUMBERS
        return claims and self.residual <= BAR

    @property
    def refuted(self) -> bool:
        """Whether it claims a number, if only to reduced tolerances, that residuals refute."""
        claims = self.answer is not None and self.answer.status in _NUMBERS
        return self.solved or (claims and not self.residual <= REFUTED)

    @property
    def word(self) -> Status | None:
        """LOCKED or UNSAFE, where it claims either."""
        status = None if self.answer is None else self.answer.status
        return status if status in _WORDS else None

    @property
    def load_factor(self) -> float:
        """Return the load factor that it claims."""
        point = self.answer.point if self.solved and self.answer is not None else None
        return nan if point is None else point.load_factor


def ask(backend: Backend, drawn: Drawn, options: dict[str, Any]) -> ProgramRun:
    """Solve a program once, in scaled units, as `lacore.solve` does."""
    try:
        check_capable(backend, drawn.program)
    except CapabilityError:
        return ProgramRun(backend.name, None, nan, 0.0)
    begin = _spent(backend)
    own = read_options(backend, options)
    watched = _Watched(backend)
    take_note(backend)
    try:
        with closing(preparer(watched, own, good_for(BAR))(drawn.program)) as solver:
            answer = checked_answer(drawn.program, False, solver.solve(drawn.contact))
    except Exception as error:  # An error of the backend; the other programs continue.
        text = str(error) if isinstance(error, LacoreError) else f"{type(error).__name__}: {error}"
        watched.faults.append(text)
        answer = failed_answer(text, 0.0)
    seconds = _spent(backend) - begin
    if answer.point is None:  # The time of a lost process is unknown.
        seconds = float(np.fmax(seconds, answer.solve_time))
    residual = nan if answer.point is None else recomputed(drawn, answer)
    note = take_note(backend)
    faults = [*watched.faults, *([str(note)] if note is not None and note.left_running else [])]
    return ProgramRun(backend.name, answer, residual, seconds, next(iter(faults), ""))


def take_note(backend: Backend) -> Replacement | None:
    """Return why the process of a backend was replaced, and forget it; None if it was not."""
    return backend.process.take_note() if isinstance(backend, IsolatedBackend) else None


class _Watched:
    """A backend whose answers are checked before they are repaired or replaced."""

    def __init__(self, backend: Backend) -> None:
        self._backend = backend
        self.faults: list[str] = []

    def __getattr__(self, name: str) -> Any:
        return getattr(self._backend, name)

    def prepare(self, program: KinematicProgram, options: Any) -> PreparedSolver:
        """Prepare a program."""
        return _WatchedSolver(self._backend.prepare(program, options), program, self.faults)


class _WatchedSolver:
    """A prepared solver that records the faults of its answers."""

    def __init__(
        self, solver: PreparedSolver, program: KinematicProgram, faults: list[str]
    ) -> None:
        self._solver, self._program, self._faults = solver, program, faults

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve, as the backend does."""
        answer = self._solver.solve(contact)
        fault = fault_of(self._program, False, answer)
        if not fault and answer.native_status == ENDED:
            fault = answer.message
        if fault:
            self._faults.append(fault)
        return answer

    def close(self) -> None:
        """Close the solver."""
        self._solver.close()


def _spent(backend: Backend) -> float:
    """Return the processor time of this process, and of that in which a backend works."""
    elsewhere = backend.process.processor_time if isinstance(backend, IsolatedBackend) else 0.0
    return time.process_time() + elsewhere


def recomputed(drawn: Drawn, answer: InnerSolution) -> float:
    """Return the largest residual.

    Powers relative to the total power or a small part of its scale.
    """
    assert answer.point is not None
    return scaled_residual(drawn.program, answer.point, drawn.contact)[1]


def verdict(asked: ProgramRun, drawn: Drawn, others: Sequence[ProgramRun]) -> str:
    """Judge an answer by those of others.

    A fault is always wrong. A number is right by its residuals. Another status is right if another
    backend has found the same, wrong if one has a number that its residuals prove, else right only
    by a proof.
    """
    if asked.answer is None:
        return REFUSED
    if asked.fault:
        return WRONG
    if asked.holds:
        return RIGHT
    if asked.refuted:
        return WRONG
    word = asked.word
    if word is None:
        return NOTHING
    if any(other.holds for other in others):
        return WRONG
    if any(other.word is word for other in others):
        return RIGHT
    return RIGHT if proven(word, drawn) else NOTHING


def proven(word: Status, drawn: Drawn) -> bool:
    """Return whether a mechanism of the dead loads, or reactions to the load, prove a status."""
    judge = find_backend(PROVING_BACKEND)
    prepare = preparer(judge, read_options(judge, {}))
    laws = drawn.contact, drawn.contact
    status, _, _ = prove_claim(word, drawn.program, *laws, prepare, BAR)
    return status is word
