"""Solvers side by side: profiles, means, what they claim and what is right; and what it cost."""

import numpy as np
import pandas as pd

from lacore_verification.harness.analysis.effort import costs_of_accuracy, efforts
from lacore_verification.harness.analysis.noise import noise
from lacore_verification.harness.analysis.pairs import pairwise_outcomes
from lacore_verification.harness.analysis.profiles import (
    Costs,
    costs,
    data_profile,
    performance_profile,
    rates,
    shifted_geometric_means,
)
from lacore_verification.harness.analysis.sizes import (
    RESIDUAL_SHIFT,
    RESIDUALS,
    UNKNOWNS,
    accuracies,
    answers,
    rates_by_size,
    residual_means,
    separate_residual_means,
)
from lacore_verification.report.blocks import (
    Block,
    Columns,
    Details,
    Drawing,
    Gallery,
    Section,
    Table,
    Text,
)
from lacore_verification.report.charts import axes
from lacore_verification.report.columns import RUN, Anchor, Column, columns

_DATA_PROFILE = (
    "This data profile counts the same problems as solved. It divides each solve time by the number"
    " of unknowns plus one, so that the profile of a solver does not depend on the other solvers."
)
SHIFT = 0.1  # s: solves that take much less are equivalent
_TITLE = "Solvers side by side"
_SOLVER = columns("backend", "coupling")


def solvers_section(results: pd.DataFrame, solved_by: str, unsolved: str, limit: float) -> Section:
    """Compare the speed of solvers.

    Args:
        results: see `load_results`; one row for each problem, backend and coupling.
        solved_by: criterion for solved problems: ``claim``, ``certificate`` or ``verdict``.
        unsolved: problems that no solver solved: ``keep`` or ``drop``.
        limit: s, time of an unsolved problem in the means.

    Raises:
        InputError: several runs of one solver on one problem, or no such filter.
    """
    found = costs(results, "solve_time", solved_by, unsolved, per="n_dofs")
    filters = (
        f"Whether a run counts as solved is decided by its {solved_by}; a missing run does not."
        f" Of the {len(found.cost)} problems shown, those that no solver solved"
        f" ({found.nobody} in all) are {'kept' if unsolved == 'keep' else 'left out'}."
    )
    if not np.isfinite(found.cost.to_numpy(dtype=float)).any():  # The charts would be empty.
        return Section("solvers", _TITLE, [Text("No run is solved.")])
    chart = axes.profile(performance_profile(found), axes.FACTOR)
    caption = "Share of problems solved within a multiple of the time of the fastest solver"
    means = _means_table(shifted_geometric_means(found, SHIFT, limit))
    profile = Drawing("profile", caption, chart, filters)
    return Section("solvers", _TITLE, [means, Columns([profile], [_data_profile(found)])])


def _data_profile(found: Costs) -> Drawing:
    steps = data_profile(found)
    # A logarithmic axis has no zero: profiles start at half the smallest budget.
    start = float(steps["budget"][steps["budget"] > 0].min()) / 2
    chart = axes.profile(steps.assign(budget=steps["budget"].clip(lower=start)), axes.BUDGET)
    caption = "Share of problems solved within a time per unknown"
    return Drawing("data-profile", caption, chart, _DATA_PROFILE)


def effort_section(results: pd.DataFrame) -> Section:
    """Return the cost of accuracy for each problem, and the amount of work."""
    title = "Cost of accuracy, by problem"
    blocks = [_accuracy_table(results), _efforts_table(efforts(results))]
    return Section("effort", title, blocks)


def _means_table(means: pd.DataFrame) -> Table:
    shown = columns(
        "solver",
        Column("mean", "mean, s", ".3g"),
        Column("ratio", "relative to the fastest", ".2f"),
        Column("solved", form=".0f"),
        Column("shift", "shift, s", "g"),
        Column("limit", "unsolved counts as, s", ".3g"),
    )
    return Table(
        shown, means, "Solve time: shifted geometric means over the problems of the profile"
    )


_RATES = columns("success_rate", "certified_rate", "correctness_rate", "wrong_claims")


def rates_table(results: pd.DataFrame) -> Table:
    """Return a table of claimed, certified and correct runs, with the origin of results."""
    found = rates(results).merge(answers(results).drop(columns="runs"), on=["backend", "coupling"])
    shown = columns(
        *_SOLVER,
        "runs",
        *_RATES,
        Column("alone", "answered by the backend", ".0f"),
        Column("with_lacore", "with path following", ".0f"),
        Column("unanswered", "without an answer", ".0f"),
    )
    return Table(shown, found, "Claimed and proven success of the solvers")


def sizes_table(results: pd.DataFrame) -> Table:
    """Return a table of the rates for each class of problem sizes."""
    shown = columns(*_SOLVER, Column(UNKNOWNS, "number of unknowns"), "runs", *_RATES)
    return Table(shown, rates_by_size(results), "Success by size of the problem")


def pairs_table(results: pd.DataFrame, measured: pd.DataFrame) -> Details:
    """Return a table of the outcomes of each pair of solvers.

    Args:
        results: One row for each problem, backend and coupling.
        measured: All runs of the comparison, whose calibrations show the noise of the machine.
    """
    shown = (
        Column("first", "solver A"),
        Column("second", "solver B"),
        Column("problems", "problems run by both", ".0f"),
        Column("both", "solved by both", ".0f"),
        Column("first_faster", "A faster", ".0f"),
        Column("tie", "tie", ".0f"),
        Column("second_faster", "B faster", ".0f"),
        Column("only_first", "only A solved", ".0f"),
        Column("only_second", "only B solved", ".0f"),
        Column("neither", "neither solved", ".0f"),
    )
    found = noise(measured)
    tie = (
        f"Times whose ratio is at most {found.factor:.3g} tie, because the noise of the machine can"
        " explain the difference."
        if np.isfinite(found.factor)
        else "The noise of the machine is unknown, so no solver counts as faster."
    )
    text = Text(f"A problem is solved if the verdict confirms what the backend answered. {tie}")
    outcomes = Table(shown, pairwise_outcomes(results, found))
    return Details("Outcomes of each pair of solvers", [text, outcomes])


def accuracy_blocks(results: pd.DataFrame) -> list[Block]:
    """Return charts of error and residual against time, and a table of the residuals.

    Values below `FLOOR` are drawn at it, because an exact result has no place on a logarithmic
    axis.
    """
    found = accuracies(results)
    if not len(found):
        return []
    tip = ("case", "variant", "coupling", "mesh")
    charts = [
        Drawing(
            f"{axis.column}-time",
            title,
            axes.scatter(with_floor(found, axis.column), axes.SOLVE_TIME, axis, tip=tip),
            f"{note} Values below {FLOOR:g} are drawn at {FLOOR:g}. Only runs that a backend"
            " answered itself are shown.",
        )
        for axis, title, note in (
            (axes.ERROR, "Error of the load factor against time", _ERROR_NOTE),
            (axes.RESIDUAL, "Residual against time", _RESIDUAL_NOTE),
        )
        if np.isfinite(found[axis.column].to_numpy(dtype=float, na_value=np.nan)).any()
    ]
    shown = columns(
        *_SOLVER,
        Column("measured", "certified runs", ".0f"),
        Column("mean_residual", "residual, geometric mean", ".1e"),
        Column("worst_residual", "largest residual", ".1e"),
        "worst_error",
        *(Column(f"mean_{name}", name.replace("_", " "), ".1e") for name in RESIDUALS),
    )
    separate = separate_residual_means(results)
    joined = residual_means(results).merge(separate, on=["backend", "coupling"])
    means = Table(shown, joined, "Accuracy of certified results")
    return [*([Gallery(charts)] if charts else []), means, Text(_MEANS_NOTE, soft=True)]


FLOOR = 1e-12
"""Smallest error and residual that charts show."""
_ERROR_NOTE = (
    "The error is relative to the reference. It contains the error of the mesh, which is the same"
    " for all exact backends."
)
_RESIDUAL_NOTE = "The residual is the largest one that is recomputed from the returned point."


_MEANS_NOTE = (
    "The last columns are geometric means of the separate residuals of the certificate, shifted by"
    f" {RESIDUAL_SHIFT:g}: first those of forces, from divergence to slip those of velocities, then"
    " the gap."
)


def with_floor(found: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return rows in which the values of a column are at least `FLOOR`."""
    values = found[column].to_numpy(dtype=float, na_value=np.nan)
    return found.assign(**{column: np.maximum(values, FLOOR)})


def _accuracy_table(results: pd.DataFrame) -> Table:
    """Return the smallest times, one column per level of error.

    Each links to the row of its run.
    """
    found = costs_of_accuracy(results)
    names = ["case", "variant", "backend", "coupling"]
    levels = list(dict.fromkeys(found["level"]))
    shown = found.drop_duplicates(names)[[*names, "closest"]]
    own_columns = [*columns("case", "variant"), *_SOLVER]
    for level in levels:
        cost, run = f"{100 * level:g} %", f"run {level:g}"
        own = found[found["level"] == level].rename(columns={"cost": cost, "run": run})
        shown = shown.merge(own[[*names, cost, run]], on=names)
        own_columns.append(Column(cost, form=".3g", link=Anchor(RUN.prefix, run)))
    own_columns.append(Column("closest", "smallest error, %", ".2g", scale=100))
    caption = "Solve time (s) of the fastest mesh whose error is at most the given value"
    return Table(own_columns, shown, caption)


def _efforts_table(found: pd.DataFrame) -> Table:
    shown = columns(
        *("case", "variant"),
        *_SOLVER,
        Column("certified", form=".0f"),
        "runs",
        Column("inner_solves", "inner solves", "g"),
        Column("most_inner_solves", "maximum", "g"),
        Column("iterations_per_solve", "iterations per solve", ".1f"),
        Column("contraction", form=".3f"),
        Column("worst_contraction", "worst contraction", ".3f"),
        Column("time_per_solve", "time per solve, s", ".3g"),
    )
    return Table(
        shown, found, "Inner solves, iterations and contraction: medians of certified runs"
    )
