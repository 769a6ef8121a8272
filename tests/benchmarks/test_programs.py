"""Random programs of all classes, each asked of exact backends: what performance profiles show.

Seeds and sizes are fixed, so that two runs are of the same programs. Answers are judged by
residuals that are computed anew; no time is asserted.
"""

from dataclasses import asdict

import pytest

import lacore as la
from verification.fuzz.programs.judge import RIGHT
from verification.fuzz.programs.sweep import drawn_programs, rows_of

BACKENDS = ("clarabel", "interior_point", "auto", "cvxpy", "cvxpy:ECOS", "cvxpy:QOCO")
COUNT, SEED = 72, 1  # in equal shares of all families
MOST = 4000  # unknowns
LIMIT = 60.0  # s


@pytest.mark.slow
@pytest.mark.benchmark(group="programs")
def test_programs(benchmark, one_thread):
    """A record a backend: seconds of each program, and what its answer is worth."""
    asked = [la.find_backend(name) for name in BACKENDS]
    asked = [backend for backend in asked if not backend.unavailable()]
    options = {backend.name: {"time_limit": LIMIT} for backend in asked}
    for _ in drawn_and_asked(asked, options, 2):
        pass  # imports and compiled loops are loaded by programs of no account

    def run():
        return [row for rows in drawn_and_asked(asked, options, COUNT) for row in rows]

    rows = benchmark.pedantic(run, rounds=1)
    benchmark.extra_info.update(
        kind="programs",
        what=f"{COUNT} random programs, seed {SEED}",
        limit=LIMIT,
        runs=[told(asdict(row)) for row in rows],
    )
    assert {row.backend for row in rows} == {backend.name for backend in asked}
    assert any(row.verdict == RIGHT for row in rows)


def drawn_and_asked(asked, options, count):
    for family, place, drawn in drawn_programs([], count, SEED, MOST):
        yield rows_of(family, place, drawn, asked, options)


def told(row):
    """What is kept of a row."""
    names = ("family", "place", "unknowns", "backend", "iterations", "verdict")
    return {name: row[name] for name in names} | {"seconds": float(f"{row['seconds']:.3g}")}
