"""What the answer of a backend to a random program is worth."""

import time
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from math import nan
from typing import Any

import numpy as np

from lacore.backend import (
    Backend,
    InnerSolution,
    check_capable,
    checked_answer,
    find_backend,
    read_options,
)
from lacore.claims.judged import judged_claim
from lacore.errors import CapabilityError
from lacore.inner.left_over import left_over
from lacore.inner.preparing import JUDGE, preparing
from lacore.inner.rescaling import good_for
from lacore.solvers.isolation import IsolatedBackend
from lacore.status import Status
from verification.fuzz.programs.drawn import Drawn

RIGHT, WRONG, NOTHING, REFUSED = "right", "wrong", "no answer", "refused"
BAR = 1e-6  # of the residuals of a certificate, and of load factors
_NUMBERS = (Status.SOLVED, Status.ALMOST_SOLVED)  # residuals decide whether "almost" is enough
_WORDS = (Status.LOCKED, Status.UNSAFE)


@dataclass(frozen=True)
class Asked:
    """What a backend said of a program.

    Attributes:
        backend: its name.
        answer: None where it does not take such programs.
        residual: the worst, recomputed; NaN without a point.
        seconds: of processor time, set-up included.
    """

    backend: str
    answer: InnerSolution | None
    residual: float
    seconds: float

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
    def word(self) -> Status | None:
        """LOCKED or UNSAFE, where it claims either."""
        status = None if self.answer is None else self.answer.status
        return status if status in _WORDS else None

    @property
    def load_factor(self) -> float:
        """That which it claims."""
        point = self.answer.point if self.solved and self.answer is not None else None
        return nan if point is None else point.load_factor


def ask(backend: Backend, drawn: Drawn, options: dict[str, Any]) -> Asked:
    """One solve of a program, in good units, as `lacore.solve` asks for it."""
    try:
        check_capable(backend, drawn.program)
    except CapabilityError:
        return Asked(backend.name, None, nan, 0.0)
    begin = _spent(backend)
    own = read_options(backend, options)
    with closing(preparing(backend, own, good_for(BAR))(drawn.program)) as solver:
        answer = checked_answer(drawn.program, False, solver.solve(drawn.contact))
    seconds = _spent(backend) - begin
    if answer.point is None:  # a process that is lost took its count with it
        seconds = float(np.fmax(seconds, answer.solve_time))
    residual = nan if answer.point is None else recomputed(drawn, answer)
    return Asked(backend.name, answer, residual, seconds)


def _spent(backend: Backend) -> float:
    """Processor time of this process, and of that in which a backend works."""
    elsewhere = backend.process.processor_time if isinstance(backend, IsolatedBackend) else 0.0
    return time.process_time() + elsewhere


def recomputed(drawn: Drawn, answer: InnerSolution) -> float:
    """The worst residual; powers per what is turned over, or per a little of what could be."""
    assert answer.point is not None
    return left_over(drawn.program, answer.point, drawn.contact)[1]


def verdict(asked: Asked, drawn: Drawn, others: Sequence[Asked]) -> str:
    """What an answer is worth, beside those of others.

    A number is right by its residuals. A word is right where another backend has found the same,
    wrong where one has a number that its residuals prove, else right only by a proof.
    """
    if asked.answer is None:
        return REFUSED
    if asked.holds:
        return RIGHT
    if asked.solved:
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
    """Whether a mechanism of the dead loads, or reactions to the load, prove a word."""
    judge = find_backend(JUDGE)
    prepare = preparing(judge, read_options(judge, {}))
    laws = drawn.contact, drawn.contact
    status, _, _ = judged_claim(word, drawn.program, *laws, prepare, BAR)
    return status is word
