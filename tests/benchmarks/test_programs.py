"""Random programs of all classes, each asked of exact backends: what performance profiles show.

Seeds and sizes are fixed, so that two runs are of the same programs. Answers are judged by
residuals that are computed anew; no time is asserted, nor how many are right: a claim that they
refute is.
"""

from dataclasses import asdict

import pytest

import lacore as la
from lacore.solvers.backend import load_backend
from lacore_verification.fuzz.programs.judge import RIGHT, WRONG
from lacore_verification.fuzz.programs.sweep import drawn_programs, in_turn, rows_of, tallied

BACKENDS = ("clarabel", "interior_point", "auto", "cvxpy", "cvxpy:ECOS", "cvxpy:QOCO")
COUNT, SEED = 72, 1  # in equal shares of all families
FIRST, THEN = "interior_point", "clarabel"
MANY, UNSEEN = 504, 31  # a seed that nothing was tuned on
MOST = 4000  # unknowns
LIMIT = 60.0  # s


@pytest.mark.slow
@pytest.mark.benchmark(group="programs")
def test_programs(benchmark, one_thread):
    """Seconds of each program, and what each answer is worth."""
    asked = [load_backend(name) for name in BACKENDS]
    asked = [backend for backend in asked if not backend.unavailable()]
    rows = benchmark.pedantic(every_row, args=(asked, COUNT, SEED), rounds=1)
    benchmark.extra_info.update(
        kind="programs",
        what=f"{COUNT} random programs, seed {SEED}",
        limit=LIMIT,
        runs=[told(asdict(row)) for row in rows],
    )
    assert {row.backend for row in rows} == {backend.name for backend in asked}
    assert any(row.verdict == RIGHT for row in rows)


@pytest.mark.dear
@pytest.mark.slow
@pytest.mark.benchmark(group="programs")
def test_robustness(benchmark, one_thread):
    """How many the interior point solves alone, and with the other one after it."""
    asked = [la.find_backend(name) for name in (FIRST, THEN)]
    rows = benchmark.pedantic(every_row, args=(asked, MANY, UNSEEN), rounds=1)
    rows += [in_turn(both) for both in zip(rows[::2], rows[1::2], strict=True)]
    counts = [one for one in tallied(rows) if one.family == "all"]
    benchmark.extra_info.update(
        kind="robustness",
        what=f"{MANY} random programs, seed {UNSEEN}",
        runs=[asdict(one) for one in counts],
    )
    assert not [row for row in rows if row.backend == FIRST and row.verdict == WRONG]


def every_row(asked, count, seed):
    """A row a program and backend; imports and compiled loops are loaded by two of no account."""
    options = {backend.name: {"time_limit": LIMIT} for backend in asked}
    for *_, drawn in drawn_programs([], 2, seed, MOST):
        rows_of("", 0, drawn, asked, options)
    return [
        row
        for family, place, drawn in drawn_programs([], count, seed, MOST)
        for row in rows_of(family, place, drawn, asked, options)
    ]


def told(row):
    """What is kept of a row."""
    names = ("family", "place", "unknowns", "backend", "iterations", "verdict")
    return {name: row[name] for name in names} | {"seconds": float(f"{row['seconds']:.3g}")}
