"""Many random programs, each asked of several backends, and the table of what came."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lacore.reporting.status import Status
from lacore.solvers.backend import Backend
from lacore_verification.fuzz.programs.drawn import DRAWN, Drawn, draw_program
from lacore_verification.fuzz.programs.judge import (
    NOTHING,
    REFUSED,
    RIGHT,
    WRONG,
    ProgramRun,
    ask,
    verdict,
)

LARGE = 1500  # unknowns: at least half of all programs have as many
THEN = ", then "
_SURE = (Status.SOLVED.label, Status.LOCKED.label, Status.UNSAFE.label)
_LEAST = 20
_AGREE = 0.9  # of LARGE: what a mesh that is asked for that many may have


@dataclass(frozen=True)
class Row:
    """One answer to one program.

    Attributes:
        family, place, unknowns: of the program.
        backend: who was asked.
        status, native: its words.
        residual: the worst, recomputed; NaN without a point.
        load_factor: NaN where none is claimed.
        iterations: of the solver.
        seconds: of processor time.
        verdict: ``right``, ``wrong``, ``no answer`` or ``refused``.
        message: Why it is wrong, if not by its residual.
    """

    family: str
    place: int
    unknowns: int
    backend: str
    status: str
    native: str
    residual: float
    load_factor: float
    iterations: int
    seconds: float
    verdict: str
    message: str = ""


def sizes(count: int, seed: int, most: int) -> list[int]:
    """Unknowns that are asked for: every other time at least `LARGE`."""
    rng = np.random.default_rng([seed, count])
    ends = [(_LEAST, LARGE), (int(LARGE / _AGREE), most)]
    return [int(np.exp(rng.uniform(*np.log(ends[number % 2])))) for number in range(count)]


def drawn_programs(
    families: Sequence[str], count: int, seed: int, most: int
) -> Iterator[tuple[str, int, Drawn]]:
    """`count` programs, family after family in turn."""
    names = list(families) or list(DRAWN)
    for number, size in enumerate(sizes(count, seed, most)):
        turn, which = divmod(number // 2, len(names))
        place = 2 * turn + number % 2
        yield names[which], place, draw_program(names[which], seed, place, size)


def rows_of(
    family: str,
    place: int,
    drawn: Drawn,
    backends: Sequence[Backend],
    options: Mapping[str, dict[str, Any]],
) -> list[Row]:
    """What each backend says of a program, judged beside the others."""
    asked = [ask(backend, drawn, options.get(backend.name, {})) for backend in backends]
    return [
        _row(family, place, drawn, one, [other for other in asked if other is not one])
        for one in asked
    ]


def in_turn(rows: Sequence[Row]) -> Row:
    """What comes of asking one backend after the other, until one is sure of its answer."""
    sure = [number for number, row in enumerate(rows) if row.status in _SURE]
    last = sure[0] if sure else len(rows) - 1
    seconds = sum(row.seconds for row in rows[: last + 1])
    return replace(rows[last], backend=THEN.join(row.backend for row in rows), seconds=seconds)


def _row(
    family: str, place: int, drawn: Drawn, one: ProgramRun, others: Sequence[ProgramRun]
) -> Row:
    answer = one.answer
    return Row(
        family=family,
        place=place,
        unknowns=drawn.program.n,
        backend=one.backend,
        status="" if answer is None else answer.status.label,
        native="" if answer is None else answer.native_status,
        residual=one.residual,
        load_factor=one.load_factor,
        iterations=0 if answer is None else answer.iterations,
        seconds=one.seconds,
        verdict=verdict(one, drawn, others),
        message=one.fault,
    )


@dataclass(frozen=True)
class Tally:
    """What a backend did on a family, or on all.

    Attributes:
        backend, family: who, on what.
        programs, right, wrong, nothing, refused: how many.
        large, large_right: those of at least `LARGE` unknowns, and how many of them it has right.
        seconds: of processor time.
    """

    backend: str
    family: str
    programs: int
    right: int
    wrong: int
    nothing: int
    refused: int
    large: int
    large_right: int
    seconds: float


def tallied(rows: Sequence[Row]) -> list[Tally]:
    """Counts by backend and family, those of all families last."""
    found = []
    for backend in dict.fromkeys(row.backend for row in rows):
        own = [row for row in rows if row.backend == backend]
        for family in dict.fromkeys(row.family for row in own):
            found.append(_tally(backend, family, [row for row in own if row.family == family]))
        found.append(_tally(backend, "all", own))
    return found


def _tally(backend: str, family: str, rows: Sequence[Row]) -> Tally:
    def count(what: str, among: Sequence[Row] = rows) -> int:
        return sum(row.verdict == what for row in among)

    large = [row for row in rows if row.unknowns >= LARGE and row.verdict != REFUSED]
    return Tally(
        backend=backend,
        family=family,
        programs=len(rows),
        right=count(RIGHT),
        wrong=count(WRONG),
        nothing=count(NOTHING),
        refused=count(REFUSED),
        large=len(large),
        large_right=count(RIGHT, large),
        seconds=sum(row.seconds for row in rows),
    )
