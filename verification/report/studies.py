"""What all runs together say: regularisation, solvers side by side, cost of accuracy, loops.

Each study is a section, or None where the results hold nothing to show.
"""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from verification.analysis import (
    costs,
    costs_of_accuracy,
    efforts,
    lambda_limits,
    performance_profile,
    rates,
    regularisation_slopes,
    shifted_geometric_means,
    with_exact,
)
from verification.analysis.columns import SOLVER, groups, problem_columns, solver_columns
from verification.judging import BOUNDS, SKIPPED
from verification.report.blocks import (
    Block,
    Column,
    Details,
    Drawing,
    Gallery,
    Heading,
    Section,
    Table,
    Text,
    slug,
)
from verification.report.charts import FACTOR, SOLVE_TIME, Axis, curves, fitted, profile
from verification.report.tables import RUN

PENALTIES = {
    "option_r": "dimensionless regularisation r (T20)",
    "option_eta": "viscosity eta [Pa s]",
    "option_bulk": "penalty K_c on divergence [Pa s]",
    "option_normal": "penalty K_n on penetration [Pa/(m/s)]",
    "option_tangential": "penalty K_t on stick [Pa/(m/s)]",
}
_ERRORS = {
    "error_alpha_reg": Axis("error_alpha_reg", "|α* − α_reg|"),
    "error_lambda": Axis("error_lambda", "|α* − λ|"),
}
_SHIFT = 0.1  # s, of geometric means: faster solves count alike
_FEWEST = 3  # values that make a curve


def studies(results: pd.DataFrame) -> list[Section]:
    """All sections that there is something to show in."""
    ran = results[results["verdict"] != SKIPPED]
    if not len(ran):
        return []
    found = [regularisation(ran), side_by_side(ran), accuracy(ran), loops(ran)]
    return [section for section in found if section is not None]


def regularisation(results: pd.DataFrame) -> Section | None:
    """Errors of regularised values against r and each penalty, with slopes and floors (T19)."""
    if not results["lambda"].notna().any():
        return None
    swept = [name for name in PENALTIES if name in results and results[name].nunique() >= _FEWEST]
    joined = with_exact(results) if swept else results
    blocks: list[Block] = []
    for option in swept:
        slopes = regularisation_slopes(joined, option)
        if not len(slopes):
            continue
        blocks += [Heading(f"Against the {PENALTIES[option]}")]
        blocks += [Gallery(list(_error_charts(joined, slopes, option))), _slopes_table(slopes)]
        if option == "option_r":
            blocks += _limits(results)
    if not blocks:
        return None
    lead = (
        "α* is the exact discrete value; by (T19) α_reg errs in proportion to r and λ, at frozen"
        " reactions, with its square, down to the accuracy of the solves."
    )
    return Section("regularisation", "What regularisation costs", blocks, lead)


def _error_charts(joined: pd.DataFrame, slopes: pd.DataFrame, option: str) -> Iterator[Drawing]:
    """Two charts a problem and loop."""
    by = [*problem_columns(joined), "coupling"]
    x = Axis(option, PENALTIES[option])
    for names, part in groups(joined[joined[option].notna()], by):
        own = slopes
        for name, value in names.items():
            own = own[own[name].isna() if pd.isna(value) else own[name] == value]
        title = f"{names['case']}:{names['variant']}, {names['mesh']}, {names['coupling']}"
        for error, axis in _ERRORS.items():
            laws = own[own["error"] == error]
            if len(laws) and not laws["backend"].duplicated().any():
                name = f"{option}-{error}-{'-'.join(slug(value) for value in names.values())}"
                yield Drawing(name, title, fitted(part, laws, x, axis))


def _slopes_table(slopes: pd.DataFrame) -> Table:
    columns = (
        Column("case"),
        Column("variant"),
        Column("mesh"),
        Column("backend"),
        Column("coupling"),
        Column("error_of", "error of"),
        Column("slope", "slope", "+.3f"),
        Column("low", "from", "+.3f"),
        Column("high", "to", "+.3f"),
        Column("expected", "(T19)", "+.0f"),
        Column("start", "holds from", ".1e"),
        Column("stop", "up to", ".1e"),
        Column("points", "points", ".0f"),
        Column("floor", "floor", ".1e"),
        Column("frozen", "frozen reactions"),
        Column("reason", "why there is none", long=True),
    )
    names = {"error_alpha_reg": "α_reg", "error_lambda": "λ"}
    data = slopes.assign(
        error_of=slopes["error"].map(names), frozen=np.where(slopes["frozen"], "yes", "no")
    )
    return Table(columns, data, caption="Slopes, 95 % confidence")


def _limits(results: pd.DataFrame) -> Iterator[Block]:
    limits = lambda_limits(results)
    if len(limits):
        names = ("case", "variant", "mesh", "backend", "coupling")
        columns = (
            *(Column(name) for name in names),
            Column("r", "r", ".1e"),
            Column("lambda", "λ", ".9f"),
            Column("limit", "limit", ".9f"),
            Column("uncertainty", "±", ".1e"),
            Column("rule", "rule", long=True),
        )
        known = [column for column in columns if column.name in limits]
        yield Details("Extrapolated to r = 0", [Table(known, limits)])


def side_by_side(results: pd.DataFrame) -> Section | None:
    """Rates, performance profile and means of all solvers."""
    runs = results[~results["coupling"].isin(list(BOUNDS))]
    varied = [name for name in solver_columns(runs) if name not in SOLVER]
    runs = runs[runs[varied].isna().all(axis=1)]  # each with its defaults
    if runs["backend"].nunique() < 2:
        return None
    found = costs(runs, "solve_time", solved_by="verdict", unsolved="drop", solver=SOLVER)
    if len(found.cost) < 2:
        return None
    steps = performance_profile(found)
    most = float(np.nanmax(found.cost.replace(np.inf, np.nan).to_numpy(dtype=float)))
    means = shifted_geometric_means(found, _SHIFT, limit=max(most, 1.0))
    problems = len(found.cost) + found.nobody
    filters = (
        "Runs with the default options of each backend. Solved: those whose verdict is pass. Of"
        f" {problems} problems {found.nobody} that nobody solved are left out. Problems that a"
        " solver was not run on count as not solved by it."
    )
    return Section(
        "solvers",
        "Solvers side by side",
        [
            Text(filters, soft=True),
            Gallery([Drawing("profile", "Performance profile", profile(steps, FACTOR))]),
            _rates_table(rates(runs)),
            _means_table(means),
        ],
        "Who solves how much, how fast; what solvers claim beside what is right.",
    )


def _rates_table(found: pd.DataFrame) -> Table:
    columns = (
        *(Column(name) for name in SOLVER),
        Column("runs", "runs", ".0f"),
        Column("success_rate", "claimed %", ".1f", scale=100),
        Column("certified_rate", "certified %", ".1f", scale=100),
        Column("correctness_rate", "correct %", ".1f", scale=100),
        Column("wrong_claims", "claimed, not correct", ".0f"),
    )
    return Table(columns, found, caption="What solvers claim, and what is right")


def _means_table(means: pd.DataFrame) -> Table:
    columns = (
        Column("solver"),
        Column("mean", "mean time [s]", ".3g"),
        Column("ratio", "ratio to the best", ".3g"),
        Column("solved", "problems solved", ".0f"),
    )
    limit = means["limit"].iloc[0] if len(means) else np.nan
    caption = (
        f"Shifted geometric means over all problems, shift {_SHIFT:g} s; what was not solved counts"
        f" {limit:.3g} s, the slowest solved run or one second"
    )
    return Table(columns, means, caption=caption)


def accuracy(results: pd.DataFrame) -> Section | None:
    """Time to 1 %, 0.1 % and 0.01 %, of cases with an error that refinement lowers."""
    runs = results[~results["coupling"].isin(list(BOUNDS)) & (results["error"].abs() > 0)]
    meshed = runs.groupby(["case", "variant"])["n_elements"].transform("nunique") >= _FEWEST
    runs = runs[meshed.astype(bool)] if len(runs) else runs
    if not len(runs):
        return None
    table = costs_of_accuracy(runs)
    columns = (
        *(Column(name) for name in ("case", "variant", "backend", "coupling")),
        Column("level", "to", ".2%"),
        Column("cost", "seconds", ".3g", link=RUN),
        Column("mesh"),
        Column("reached", "reached", ".2e"),
        Column("reason", "", long=True),
    )
    charts = [
        Drawing(
            f"cost-{'-'.join(slug(value) for value in names.values())}",
            f"{names['case']}:{names['variant']}",
            curves(part, SOLVE_TIME, Axis("error", "relative error"), tip=("mesh",)),
        )
        for names, part in groups(runs, ["case", "variant"])
    ]
    return Section(
        "accuracy", "Cost of accuracy", [Gallery(charts), Table(columns, table)], "Certified runs."
    )


def loops(results: pd.DataFrame) -> Section:
    """Inner solves, iterations and contraction of each coupling loop."""
    columns = (
        *(Column(name) for name in ("case", "variant", "backend", "coupling")),
        Column("runs", "runs", ".0f"),
        Column("certified", "certified", ".0f"),
        Column("inner_solves", "median solves", ".3g"),
        Column("most_inner_solves", "most", ".0f"),
        Column("iterations_per_solve", "iterations a solve", ".3g"),
        Column("contraction", "contraction", ".2g"),
        Column("worst_contraction", "worst", ".2g"),
        Column("time_per_solve", "seconds a solve", ".2g"),
        Column("peak_memory_mb", "memory, MB", ".0f"),
    )
    lead = "Medians over certified runs; a contraction below 1 says that the plain loop converges."
    return Section(
        "loops",
        "Loops and iterations",
        [Details("All cases", [Table(columns, efforts(results))])],
        lead,
    )
