"""Charts and tables of paths: loads against the travel, and other results."""

from collections.abc import Sequence
from math import isfinite

import numpy as np
import pandas as pd

from lacore.paths.control import unit_of
from lacore_verification.case import Case
from lacore_verification.harness.verdicts.path import exact_loads
from lacore_verification.report.blocks import Drawing, Table
from lacore_verification.report.charts.axes import figure_axes, labelled, legend
from lacore_verification.report.charts.svg import Chart, Tip
from lacore_verification.report.charts.theme import INK, MARKERS, SERIES, styled
from lacore_verification.report.columns import RUN, Column, column, columns
from lacore_verification.report.tables import HOW
from lacore_verification.runs.outcome import Outcome

_POINTS = 101  # points of an exact curve


def path_chart(case: Case, outcomes: Sequence[Outcome]) -> Drawing | None:
    """Draw computed and exact loads along the paths of a case; return None without a path.

    For each variant the finest mesh of its first backend is used.
    """
    shown = _shown(outcomes)
    if not shown:
        return None
    tips: list[Tip] = []
    label: str | None = "exact"
    with styled():
        figure, axes = figure_axes()
        for number, outcome in enumerate(shown):
            run = outcome.run
            steps = pd.DataFrame([dict(step) for step in outcome.evidence.history])
            colour, name = SERIES[number % len(SERIES)], run.variant.name
            stated = case.following_of(run.variant)
            if stated.exact is not None:
                places = np.linspace(0, stated.travel, _POINTS)
                loads = exact_loads(stated, places)
                axes.plot(places, loads, color=INK, lw=1.0, zorder=1, label=label)
                label = None
            axes.plot(
                steps["travel"],
                steps[stated.load],
                color=colour,
                ls="-" if stated.exact is None else "none",
                marker=MARKERS[number % len(MARKERS)],
                ms=4.5,
                mfc="none",
                label=labelled(name),
            )
            for travel, value, exact in zip(
                steps["travel"], steps[stated.load], steps["exact"], strict=True
            ):
                words = f"{name}\ntravel: {travel:.4g}\nload: {value:.6g}"
                more = f"\nexact: {exact:.6g}" if isfinite(exact) else ""
                tips.append(Tip(axes, travel, value, words + more))
        axes.set_xlabel(_travel(case, shown))
        axes.set_ylabel(f"load [{case.unit}]")
        legend(figure, axes)
    chart = Chart(figure, f"{case.title}: computed and exact loads along the paths", tips)
    return Drawing(f"{case.id}-paths", "Load against travel", chart)


def paths_table(results: pd.DataFrame) -> Table:
    """Return the results of each path."""
    shown = columns(
        column("verdict", hover="why"),
        Column("variant", link=RUN),
        *(HOW[0], "backend"),
        Column("param_steps", "steps", ".0f"),
        Column("param_scheme", "scheme"),
        *("ending", "path_error"),
        Column("volume_change", "volume change per step", ".1e"),
        Column("lower", "initial lower bound", ".5f"),
        Column("start", "initial load", ".5f"),
        Column("upper", "initial upper bound", ".5f"),
        Column("reading", "reading", ".4g"),
        "outer_iterations",
    )
    return Table(shown, results, caption="Paths")


def _travel(case: Case, shown: Sequence[Outcome]) -> str:
    """Return the label of the axis, with the unit if all controls have the same."""
    units = {unit_of(case.following_of(outcome.run.variant).control) for outcome in shown}
    unit = units.pop() if len(units) == 1 else ""
    return f"travel [{unit}]" if unit else "travel"


def _shown(outcomes: Sequence[Outcome]) -> list[Outcome]:
    found: dict[str, Outcome] = {}
    for outcome in outcomes:
        name, before = outcome.run.variant.name, found.get(outcome.run.variant.name)
        if not outcome.row.ending or not outcome.evidence.history:
            continue
        if before is None or (
            outcome.run.backend == before.run.backend
            and outcome.row.n_elements > before.row.n_elements
        ):
            found[name] = outcome
    return list(found.values())
