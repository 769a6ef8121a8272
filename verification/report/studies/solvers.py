"""Solvers side by side: profiles, means, what they claim and what is right; and what it cost."""

import numpy as np
import pandas as pd

from verification.analysis import (
    costs,
    costs_of_accuracy,
    efforts,
    performance_profile,
    rates,
    shifted_geometric_means,
)
from verification.report.blocks import Anchor, Column, Columns, Drawing, Section, Table, Text
from verification.report.charts import axes
from verification.report.tables import RUN

SHIFT = 0.1  # s: solves that take much less count alike
_TITLE = "Solvers side by side"
_SOLVER = (Column("backend"), Column("coupling"))


def solvers_section(results: pd.DataFrame, solved_by: str, unsolved: str, limit: float) -> Section:
    """How fast solvers are.

    Args:
        results: as of `load_results`, one row for each problem, backend and coupling.
        solved_by: what counts as solved: ``claim``, ``certificate`` or ``verdict``.
        unsolved: problems that nobody solved: ``keep`` or ``drop``.
        limit: s, what an unsolved problem counts in the means.

    Raises:
        InputError: several runs of one solver on one problem, or no such filter.
    """
    found = costs(results, "solve_time", solved_by, unsolved)
    filters = (
        f"Whether a run counts as solved is decided by its {solved_by}; a missing run does not."
        f" Of the {len(found.cost)} problems shown, those that no solver solved"
        f" ({found.nobody} in all) are {'kept' if unsolved == 'keep' else 'left out'}."
    )
    if not np.isfinite(found.cost.to_numpy(dtype=float)).any():  # charts would be empty
        return Section("solvers", _TITLE, [Text("No run is solved.")])
    chart = axes.profile(performance_profile(found), axes.FACTOR)
    caption = "Share of problems solved within a multiple of the time of the fastest solver"
    means = _means_table(shifted_geometric_means(found, SHIFT, limit))
    profile = Drawing("profile", caption, chart, filters)
    return Section("solvers", _TITLE, [Columns([means], [profile])])


def effort_section(results: pd.DataFrame) -> Section:
    """What accuracy costs on each problem, and how much work it was."""
    title = "Cost of accuracy, by problem"
    blocks = [_accuracy_table(results), _efforts_table(efforts(results))]
    return Section("effort", title, blocks)


def _means_table(means: pd.DataFrame) -> Table:
    columns = (
        Column("solver"),
        Column("mean", "mean, s", ".3g"),
        Column("ratio", "relative to the fastest", ".2f"),
        Column("solved", form=".0f"),
        Column("shift", "shift, s", "g"),
        Column("limit", "unsolved counts as, s", "g"),
    )
    return Table(
        columns, means, "Solve time: shifted geometric means over the problems of the profile"
    )


def rates_table(results: pd.DataFrame) -> Table:
    """How often solvers claim success, and how often they are right."""
    columns = (
        *_SOLVER,
        Column("runs", form=".0f"),
        Column("success_rate", "claimed %", ".1f", scale=100),
        Column("certified_rate", "certified %", ".1f", scale=100),
        Column("correctness_rate", "correct %", ".1f", scale=100),
        Column("wrong_claims", form=".0f"),
    )
    return Table(columns, rates(results), "Claimed and proven success of the solvers")


def _accuracy_table(results: pd.DataFrame) -> Table:
    """Least times, one column a level of error; each links to the row of its run."""
    found = costs_of_accuracy(results)
    names = ["case", "variant", "backend", "coupling"]
    levels = list(dict.fromkeys(found["level"]))
    shown = found.drop_duplicates(names)[[*names, "closest"]]
    columns = [Column("case"), Column("variant"), *_SOLVER]
    for level in levels:
        cost, run = f"{100 * level:g} %", f"run {level:g}"
        own = found[found["level"] == level].rename(columns={"cost": cost, "run": run})
        shown = shown.merge(own[[*names, cost, run]], on=names)
        columns.append(Column(cost, form=".3g", link=Anchor(RUN.prefix, run)))
    columns.append(Column("closest", "smallest error, %", ".2g", scale=100))
    caption = "Solve time (s) of the fastest mesh whose error is at most the given value"
    return Table(columns, shown, caption)


def _efforts_table(found: pd.DataFrame) -> Table:
    columns = (
        Column("case"),
        Column("variant"),
        *_SOLVER,
        Column("certified", form=".0f"),
        Column("runs", "runs", ".0f"),
        Column("inner_solves", "inner solves", "g"),
        Column("most_inner_solves", "maximum", "g"),
        Column("iterations_per_solve", "iterations per solve", ".1f"),
        Column("contraction", form=".3f"),
        Column("worst_contraction", "worst contraction", ".3f"),
        Column("time_per_solve", "time per solve, s", ".3g"),
    )
    return Table(
        columns, found, "Inner solves, iterations and contraction: medians of certified runs"
    )
