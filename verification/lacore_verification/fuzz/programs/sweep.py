"""Sweeps of random programs over several backends, and the table of results."""

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

LARGE = 1500  # Unknowns: at least half of all programs have as many.
THEN = ", then "
_SURE = (Status.SOLVED.label, Status.LOCKED.label, Status.UNSAFE.label)
_LEAST = 20
_AGREE = 0.9  # Relative to LARGE: smallest number of unknowns of a mesh for that many.


@dataclass(frozen=True)
class Row:
    """Result of one backend for one program.

    Attributes:
        family, place, unknowns: of the program.
        backend: its name.
        status, native: in words of lacore and of the solver.
        residual: the largest, recomputed; NaN without a point.
        load_factor: NaN where none is claimed.
        iterations: of the solver.
        seconds: processor time.
        verdict: ``right``, ``wrong``, ``no answer`` or ``refused``.
        message: why it is wrong, if not by its residual.
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
    """Return numbers of unknowns: every second one is at least `LARGE`."""
    rng = np.random.default_rng([seed, count])
    ends = [(_LEAST, LARGE), (int(LARGE / _AGREE), most)]
    return [int(np.exp(rng.uniform(*np.log(ends[number % 2])))) for number in range(count)]


def drawn_programs(
    families: Sequence[str], count: int, seed: int, most: int
) -> Iterator[tuple[str, int, Drawn]]:
    """Yield `count` programs of the families in turn."""
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
    """Return the result of each backend for a program, checked against the others."""
    asked = [ask(backend, drawn, options.get(backend.name, {})) for backend in backends]
    return [
        _row(family, place, drawn, one, [other for other in asked if other is not one])
        for one in asked
    ]


def in_turn(rows: Sequence[Row]) -> Row:
    """Return the result of using backends in turn, until one is certain of its answer."""
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
    """Results of a backend on a family, or on all.

    Attributes:
        backend, family: their names.
        programs, right, wrong, nothing, refused: counts.
        large, large_right: those of at least `LARGE` unknowns, and how many of them are right.
        seconds: processor time.
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
    """Return counts by backend and family, those of all families last."""
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
