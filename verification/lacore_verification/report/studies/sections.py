"""Studies of all runs together, if there is anything to show."""

from dataclasses import replace

import numpy as np
import pandas as pd

from lacore_verification.harness.analysis.columns import numbers, problem_columns, solver_columns
from lacore_verification.harness.analysis.extrapolation import lambda_limits
from lacore_verification.harness.analysis.settings import with_settings
from lacore_verification.harness.verdicts.limit_state import FINDS_NONE
from lacore_verification.harness.verdicts.words import SKIPPED
from lacore_verification.report.blocks import Block, Details, Section, Table, Text
from lacore_verification.report.columns import Column
from lacore_verification.report.studies.convergence import (
    refinement_section,
    regularisation_section,
    steps_section,
)
from lacore_verification.report.studies.single_solves import single_solves_section
from lacore_verification.report.studies.solvers import (
    accuracy_blocks,
    effort_section,
    pairs_table,
    rates_table,
    sizes_table,
    solvers_section,
)

PENALTIES = ("option_r", "option_eta", "option_bulk", "option_normal", "option_tangential")
_COMPARABLE = (
    "Times refer to the problems that all listed solvers were run on."
    " Solvers that were run on fewer than half of all problems are left out."
)
_RATES = (
    "Claimed: the solver reports success. Certified: the residuals that lacore recomputes prove the"
    " value. Correct: certificate and reference agree, of the runs that have a reference. Certified"
    " and correct count only what a backend answered itself, and not what lacore found by following"
    " a path."
)
_LEAST = 1.0  # s, time of an unsolved problem in means of quick ones


def studies(results: pd.DataFrame) -> list[Section]:
    """Return sections on regularisation, extrapolation, refinement, steps and cost of accuracy."""
    ran = results[results["verdict"] != SKIPPED]
    if not len(ran):
        return []
    sections = [
        *(regularisation_section(ran, option) for option in PENALTIES if option in ran),
        _extrapolation(ran),
        refinement_section(ran),
        steps_section(ran),
        single_solves_section(ran),
        _efforts(ran),
    ]
    return [section for section in sections if section is not None]


def _extrapolation(results: pd.DataFrame) -> Section | None:
    """Return lambda extrapolated to r = 0."""
    limits = lambda_limits(results) if "option_r" in results else pd.DataFrame()
    if not len(limits):
        return None
    names = ("case", "variant", "mesh", "backend", "coupling")
    columns = (
        *(Column(name) for name in names),
        Column("r", "r", ".1e"),
        Column("lambda", "λ", ".9f"),
        Column("limit", "limit", ".9f"),
        Column("uncertainty", "±", ".1e"),
        Column("rule", "rule", long=True),
    )
    blocks: list[Block] = [Details("Limits", [Table(columns, limits)])]
    lead = "Two solves, with λ and its derivative, give a limit of higher order than either (T19)."
    return Section("extrapolation", "Regularised values extrapolated to r = 0", blocks, lead)


def solvers(results: pd.DataFrame) -> Section | None:
    """Compare backends with default options: how often they are correct, and how fast."""
    plain = _plain(results)
    if plain["backend"].nunique() < 2:
        return None
    blocks: list[Block] = [Text(_RATES), rates_table(plain), sizes_table(plain)]
    blocks += accuracy_blocks(plain)
    runs = _common(plain)
    if runs["backend"].nunique() > 1:
        slowest = float(np.nanmax(numbers(runs, "solve_time"), initial=_LEAST))
        section = solvers_section(runs, solved_by="verdict", unsolved="drop", limit=slowest)
        blocks += [Text(_COMPARABLE), *section.blocks]
    blocks.append(pairs_table(plain, results))
    return Section("solvers", "Backends side by side", blocks)


def _efforts(results: pd.DataFrame) -> Section | None:
    runs = _common(_plain(results))
    if runs["backend"].nunique() < 2:
        return None
    return replace(effort_section(runs), lead=_COMPARABLE)


def _plain(results: pd.DataFrame) -> pd.DataFrame:
    """Return runs with the default loop; a backend with different settings counts as several."""
    results = with_settings(results)
    runs = results[(results["verdict"] != SKIPPED) & ~results["coupling"].isin(FINDS_NONE)]
    varied = [name for name in solver_columns(runs) if name not in ("backend", "coupling")]
    return runs[runs[varied].isna().all(axis=1)]


def _common(runs: pd.DataFrame) -> pd.DataFrame:
    """Return runs of solvers that were run on most problems, on their common problems.

    A solver that was only run on other problems cannot be compared.
    """
    if not len(runs):
        return runs
    problem = runs.groupby(problem_columns(runs), dropna=False, sort=False).ngroup()
    solver = runs["backend"] + " " + runs["coupling"]
    tried = problem.groupby(solver).nunique()
    often = solver.isin(tried.index[tried * 2 >= problem.nunique()])
    shared = solver[often].groupby(problem[often]).nunique() == solver[often].nunique()
    return runs[often & problem.isin(shared.index[shared])]
