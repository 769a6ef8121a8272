"""What the answer of a backend to a random program is worth."""

import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import inf, nan
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
from lacore.certificate import certify
from lacore.claims.judged import judged_claim
from lacore.errors import CapabilityError
from lacore.inner.preparing import JUDGE, preparing
from lacore.program import KinematicProgram
from lacore.status import Status
from verification.fuzz.programs.drawn import Drawn

RIGHT, WRONG, NOTHING, REFUSED = "right", "wrong", "no answer", "refused"
BAR = 1e-6  # of the residuals of a certificate, and of load factors
_POWERS = ("flow", "slip", "gap", "load")
_POSSIBLE = ("penetration", "divergence", "normalisation")
_IDLE = 1e-3  # of what all cones would turn over at the largest speed: a power to be compared with
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
    """One solve of a program."""
    begin = time.process_time()
    try:
        check_capable(backend, drawn.program)
    except CapabilityError:
        return Asked(backend.name, None, nan, 0.0)
    solver = backend.prepare(drawn.program, read_options(backend, options))
    try:
        answer = checked_answer(drawn.program, False, solver.solve(drawn.contact))
    finally:
        solver.close()
    seconds = time.process_time() - begin
    residual = nan if answer.point is None else recomputed(drawn, answer)
    return Asked(backend.name, answer, residual, seconds)


def recomputed(drawn: Drawn, answer: InnerSolution) -> float:
    """The worst residual; powers per what is turned over, or per a little of what could be.

    Of a motion that turns over nothing no residual is small per power.
    """
    point = answer.point
    assert point is not None
    found = certify(drawn.program, point, drawn.contact)
    power = _turned_over(drawn, point.velocity)
    least = _IDLE * _possible(drawn.program, point.velocity)
    share = power / max(power, least) if max(power, least) > 0 else 1.0
    kinds = asdict(found)
    if not np.any(drawn.program.dead_load) and power <= BAR * least:
        # No stress at all is in equilibrium: the load factor is between zero and this power.
        kinds = {name: kinds[name] for name in _POSSIBLE}
    worst = [share * kinds[name] if name in _POWERS else kinds[name] for name in kinds]
    return float(np.max(worst)) if np.all(np.isfinite(worst)) else inf


def _turned_over(drawn: Drawn, velocity: Any) -> float:
    """What certificates measure powers by, but for what dilating friction lifts."""
    program = drawn.program.hardened(velocity)
    friction = program.friction_dissipation(velocity, drawn.contact.bound)
    dead = abs(float(program.dead_load @ velocity))
    return program.plastic_dissipation(velocity) + friction + dead


def _possible(program: KinematicProgram, velocity: Any) -> float:
    """What all cones, and the dead loads, would turn over at the largest speed."""
    total = float(np.abs(program.dead_load).sum())
    for group in program.groups:
        squares = np.asarray(group.rows.multiply(group.rows).sum(axis=1)).reshape(-1, group.dim)
        strength = group.bound
        if group.surfaces is not None:  # of soils each cone has that of its strongest surface
            strength = group.surfaces.strength.max(axis=1)
        total += float((group.weights * strength) @ np.sqrt(squares.sum(axis=1)))
    return total * float(np.abs(velocity).max(initial=0.0))


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
    with preparing(judge, read_options(judge, {})) as prepare:
        laws = drawn.contact, drawn.contact
        status, _ = judged_claim(word, drawn.program, *laws, prepare, BAR)
    return status is word
