"""Accuracy within one solve: residuals against time for several values of an option."""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from lacore_verification.harness.analysis.columns import (
    answered_itself,
    groups,
    numbers,
    problem_columns,
    says,
    solver_columns,
    with_prefix,
)
from lacore_verification.harness.analysis.sizes import largest_residuals
from lacore_verification.harness.verdicts.words import SKIPPED
from lacore_verification.report.blocks import (
    Block,
    Details,
    Drawing,
    Gallery,
    Section,
    Table,
    Text,
)
from lacore_verification.report.charts import axes
from lacore_verification.report.charts.axes import Axis
from lacore_verification.report.charts.lines import LINE, with_lines
from lacore_verification.report.columns import RUN, Column, column, columns
from lacore_verification.report.description import counted
from lacore_verification.report.studies.solvers import FLOOR, with_floor

LEAST = 3
"""Values of an option that make a curve, at least."""
OPTION, VALUE, RESIDUAL = "ladder", "value", "residual"
"""Columns that `ladders` adds."""
_OPTION = "option_"
_MODEL = ("r", "eta", "bulk", "normal", "tangential")
"""Options of penalised backends that change the program, and not the accuracy of its solution."""

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
    shown = columns(
        *("verdict", "case", "variant", "mesh"),
        Column(LINE, "backend"),
        Column(OPTION, "option"),
        Column(VALUE, link=RUN),
        *(column("solve_time", form=".3g"), "iterations", "gap"),
        Column(RESIDUAL, "largest residual", ".1e"),
    )
    return Table(shown, _with_lines(found))


def ladders(results: pd.DataFrame) -> pd.DataFrame:
    """Return the runs in which a backend solved a program once, with `LEAST` values of an option.

    Runs whose residuals prove no load factor are included, because the residuals state how
    accurate they are. If several options of a backend vary, the curve follows the one with the
    most values, and the others distinguish curves.

    Args:
        results: One row for each run.

    Returns:
        The rows, with ``ladder``, the name of the option that varies; ``value``, its value as
        text, or ``default``; ``residual``, the largest residual. In the column of that option they
        have no value, so that `solver_columns` distinguish the curves.

    Raises:
        InputError: A column is missing.
    """
    names = [name for name in with_prefix(results, _OPTION) if name[len(_OPTION) :] not in _MODEL]
    found = results.assign(**{RESIDUAL: largest_residuals(results)})
    if not names:
        return _none(found)
    seen = (
        (numbers(found, "outer_iterations") == 1)
        & np.isfinite(numbers(found, RESIDUAL))
        & (numbers(found, "solve_time") > 0)
        & answered_itself(found)
        & ~says(found, "verdict", SKIPPED)
    )
    fixed = [name for name in solver_columns(found) if name not in names]
    by = [*problem_columns(found), *fixed]
    curves = [own for _, part in groups(found[seen], by) for own in _curves(part, names)]
    return pd.concat(curves) if curves else _none(found)


def _none(found: pd.DataFrame) -> pd.DataFrame:
    return found.iloc[:0].assign(**{OPTION: "", VALUE: ""})


def _curves(part: pd.DataFrame, names: list[str]) -> Iterator[pd.DataFrame]:
    """Yield the curves of the runs of one backend on one program."""
    counts = {name: part[name].nunique(dropna=False) for name in names}
    varied = max(names, key=lambda name: counts[name])
    others = [name for name in names if name != varied]
    for _, own in groups(part, others):
        if own[varied].nunique(dropna=False) >= LEAST:
            values = [_text(value) for value in own[varied]]
            option = varied.removeprefix(_OPTION)
            made = own.assign(**{OPTION: option, VALUE: values})
            made[varied] = pd.NA
            yield made


def _text(value: object) -> str:
    if pd.isna(value):  # type: ignore[call-overload]
        return "default"
    return f"{value:g}" if isinstance(value, float) else str(value)
