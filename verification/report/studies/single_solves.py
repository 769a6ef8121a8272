"""Accuracy within one solve: residuals against time for several values of an option."""

import pandas as pd

from verification.analysis.columns import groups, problem_columns, solver_columns
from verification.analysis.ladders import LEAST, OPTION, RESIDUAL, VALUE, ladders
from verification.report.blocks import (
    Block,
    Details,
    Drawing,
    Gallery,
    Section,
    Table,
    Text,
)
from verification.report.charts import axes
from verification.report.charts.axes import Axis
from verification.report.charts.lines import LINE, with_lines
from verification.report.columns import Column
from verification.report.description import counted
from verification.report.studies.solvers import FLOOR, with_floor
from verification.report.tables import RUN, VERDICTS

MOST = 8
"""Problems that are drawn, those with the most unknowns."""
_GAP = Axis("gap", "certificate gap")
_TEXT = (
    "Each curve joins the runs of a backend that solve the same program with different values of an"
    " option, such as its tolerance, in the order of their accuracy. lacore measures the time, and"
    " it recomputes the gap and the residuals from the returned point, even if they do not prove"
    " the load factor. A small gap proves nothing if another residual is large. Only runs with a"
    f" single inner solve are shown, and only options with at least {LEAST} values. With Coulomb"
    " friction, --couplings associated gives such runs. Values below"
    f" {FLOOR:g} are drawn at {FLOOR:g}."
)


def single_solves_section(results: pd.DataFrame) -> Section | None:
    """Return the curves of accuracy against time; None if no option of a backend has enough values.

    Args:
        results: As of `load_results`.
    """
    found = ladders(results)
    if not len(found):
        return None
    names = problem_columns(found)
    problems = sorted(
        groups(found, names), key=lambda item: item[1]["n_dofs"].astype(float).max(), reverse=True
    )
    drawings = [drawing for _, own in problems[:MOST] for drawing in _drawings(own)]
    left_out = len(problems) - MOST
    blocks: list[Block] = [Text(_TEXT)]
    if left_out > 0:
        text = f"The table also lists the runs of {counted(left_out, 'smaller problem')}."
        blocks.append(Text(text, soft=True))
    blocks += [Gallery(drawings), Details("Runs of the curves", [_table(found)])]
    return Section("single-solves", "Accuracy within one solve", blocks)


def _drawings(own: pd.DataFrame) -> list[Drawing]:
    first = own.iloc[0]
    title = f"{first['case']}:{first['variant']}, {first['mesh']} mesh"
    lines = _with_lines(own)
    return [
        Drawing(
            f"{title}-{axis.column}-time",
            f"{title}: {axis.label}",
            axes.curves(
                with_floor(lines, axis.column),
                axes.SOLVE_TIME,
                axis,
                by=LINE,
                tip=(OPTION, VALUE, "iterations"),
                along=axis,
            ),
        )
        for axis in (_GAP, axes.RESIDUAL)
    ]


def _with_lines(own: pd.DataFrame) -> pd.DataFrame:
    return with_lines(own, solver_columns(own), own)


def _table(found: pd.DataFrame) -> Table:
    columns = (
        Column("verdict", moods=VERDICTS),
        Column("case"),
        Column("variant"),
        Column("mesh"),
        Column(LINE, "backend"),
        Column(OPTION, "option"),
        Column(VALUE, link=RUN),
        Column("solve_time", "solve time, s", ".3g"),
        Column("iterations", form=".0f"),
        Column("gap", form=".1e"),
        Column(RESIDUAL, "largest residual", ".1e"),
    )
    return Table(columns, _with_lines(found))
