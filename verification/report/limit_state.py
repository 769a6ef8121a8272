"""Limit states on a page: each run with its load factor and the reference."""

import pandas as pd

import lacore as la
from verification.report.blocks import Table
from verification.report.columns import Column
from verification.report.tables import (
    CERTIFICATE,
    HOW,
    RUN,
    VERDICTS,
    WHO,
    varied,
    with_certificates,
)


def results_table(results: pd.DataFrame) -> Table:
    """Return all runs; load factors link to their certificates."""
    solved = results["status"] == la.Status.SOLVED.label
    outcome = results["rigor"].where(solved, results["status"])
    columns = (
        Column("verdict", moods=VERDICTS, hover="why"),
        *WHO,
        Column("load_factor", "load factor", ".7f", link=CERTIFICATE),
        Column("error", "error %", "+.4f", scale=100),
        Column("expected", "reference", "g", order="reference"),
        *HOW,
        *_answers(results),
        *_models(results),
        Column("n_elements", "elements", ".0f"),
        *varied(results),
        Column("energy", "energy C", ".2g"),
        Column("outcome", "rigour, status"),
        *_standing(results),
        Column("outer_iterations", "inner solves", ".0f"),
        Column("solve_time", "solve time, s", ".2f"),
    )
    return Table(columns, with_certificates(results).assign(outcome=outcome), anchor=RUN)


def times_table(results: pd.DataFrame) -> Table:
    """Return the times to build and to solve, next to those that solvers report."""
    build = Column("build_time", "build time, s", ".2f")
    solve = Column("solve_time", "solve time, s", ".3g")
    return Table((*WHO, *HOW, build, solve, *_solver_times(results)), results)


def _solver_times(results: pd.DataFrame) -> tuple[Column, ...]:
    """Return the columns of times of the backend alone; older results have none."""
    columns = (
        Column("solver_time", "in the solver, s", ".3g"),
        Column("reported_time", "as the solver reports, s", ".3g"),
        Column("compile_time", "compilation, s", ".2g"),
    )
    return tuple(own for own in columns if own.name in results and results[own.name].notna().any())


def _answers(results: pd.DataFrame) -> tuple[Column, ...]:
    """Return the column of who answered, where results state it."""
    stated = "answered_by" in results and results["answered_by"].fillna("").ne("").any()
    return (Column("answered_by", "answered by"),) if stated else ()


def _models(results: pd.DataFrame) -> tuple[Column, ...]:
    """Return the column of models other than that of the case, where there are any."""
    named = "model" in results and results["model"].fillna("").ne("").any()
    return (Column("model", "model compared"),) if named else ()


def _standing(results: pd.DataFrame) -> tuple[Column, ...]:
    """Return the columns of stability under dead loads, if it was requested."""
    if "standing" not in results or not results["standing"].fillna("").ne("").any():
        return ()
    return Column("standing", "dead loads"), Column("side", "loads carried")
