"""Sections on convergence: regularisation (T19) and mesh refinement, fitted by the analysis."""

from collections.abc import Iterator, Sequence
from typing import Any

import pandas as pd

from lacore_verification.harness.analysis.columns import groups, problem_columns, solver_columns
from lacore_verification.harness.analysis.exact import with_exact
from lacore_verification.harness.analysis.slope_fits import refinement_orders, regularisation_slopes
from lacore_verification.harness.analysis.stepping import STEPS, step_orders
from lacore_verification.report.blocks import Block, Details, Drawing, Gallery, Section, Table, Text
from lacore_verification.report.charts import axes
from lacore_verification.report.charts.axes import Axis
from lacore_verification.report.charts.lines import LINE, with_lines
from lacore_verification.report.charts.svg import Chart
from lacore_verification.report.columns import Column, columns

_ERRORS = {"error_alpha_reg": "α* − α_reg", "error_lambda": "α* − λ"}
_PARAMETERS = {
    "option_r": "regularisation r",
    "option_eta": "viscosity η",
    "option_bulk": "bulk penalty K_c",
    "option_normal": "normal penalty K_n",
    "option_tangential": "tangential penalty K_t",
}
_NAMES = columns("case", "variant")
_FIT = columns("slope", Column("low", "from", "+.3f"), Column("high", "to", "+.3f"))
_ORDER = columns("order", "order_low", "order_high")
_POINTS = (Column("points", form=".0f"), Column("usable", "usable points", ".0f"))
_RANGE = columns("start", "stop", *_POINTS, "floor", "reason")


def regularisation_section(results: pd.DataFrame, parameter: str = "option_r") -> Section | None:
    """Return errors of regularised values against r or one penalty; None if it was not swept.

    Args:
        results: see `load_results`.
        parameter: ``option_r``, ``option_eta``, ``option_bulk``, ``option_normal`` or
            ``option_tangential``.
    """
    if parameter not in results:
        return None
    errors = with_exact(results)
    fits = regularisation_slopes(errors, parameter)
    if not len(fits):
        return None
    label = _PARAMETERS.get(parameter, parameter)
    expected = "1 and 2" if parameter == "option_r" else "−1 and −2"
    text = (
        "α* is the exact value on the same mesh. For fixed reactions P ≤ α_reg ≤ λ ≤ α*, and the"
        f" theory (T19) predicts the slopes {expected}. Each line covers the points to which it was"
        " fitted. The dotted line is the floor below which the accuracy of the solver dominates."
    )
    fitted = columns(*_NAMES, "mesh", Column(LINE, "backend"), Column("error"), *_FIT)
    theory = Column("expected", "theory", "+.0f")
    named = with_lines(fits, _solvers(fits, parameter), fits)
    shown = named.assign(error=named["error"].map(_ERRORS))
    blocks: list[Block] = [
        Text(text),
        Gallery(list(_against(errors, fits, Axis(parameter, label)))),
        Details(
            "Slopes, their confidence intervals and ranges",
            [Table(columns(*fitted, theory, "frozen", *_RANGE), shown)],
        ),
    ]
    return Section(f"convergence-{parameter}", f"Error against {label}", blocks)


def _against(errors: pd.DataFrame, fits: pd.DataFrame, x: Axis) -> Iterator[Drawing]:
    """Yield two charts for each problem that was swept."""
    problem = problem_columns(errors)
    for names, own in groups(fits, problem):
        points = _rows(errors, names)
        points = points[points[x.column].notna()]
        title = _title(names)
        for error, label in _ERRORS.items():
            chart = _fitted(points, own[own["error"] == error], x, Axis(error, label))
            yield Drawing(f"{title}-{x.column}-{error}", f"{title}: {label}", chart)


def refinement_section(results: pd.DataFrame) -> Section | None:
    """Return the error against the reference under refinement; None without refinement."""
    fits = refinement_orders(results)
    if not len(fits):
        return None
    solved = results[results["error"].notna() & results["rigor"].ne("")]
    drawings = []
    for names, own in groups(fits, [n for n in problem_columns(fits) if n in fits]):
        if own["slope"].notna().any():  # Results that are exact on every mesh do not converge.
            drawings += _refined(_rows(solved, names), own, _title(names))
    named = with_lines(fits, _solvers(fits, ""), fits)
    text = (
        "Relative error with respect to the reference, fitted over three or more meshes. The order"
        " refers to the element size h = N^(−1/2)."
    )
    blocks: list[Block] = [
        Text(text),
        Gallery(drawings),
        Details("Orders", [Table((*_NAMES, Column(LINE, "backend"), *_ORDER, *_RANGE), named)]),
    ]
    return Section("refinement", "Error under refinement", blocks)


def steps_section(results: pd.DataFrame) -> Section | None:
    """Return the largest error of paths against their steps; None if these were not varied."""
    fits = step_orders(results)
    if not len(fits):
        return None
    path = [n for n in fits if str(n).startswith(("param_", "size_")) and n != "param_scheme"]
    names = ["case", "mesh", *map(str, path)]
    lines = ["param_scheme", *_solvers(fits, "")]
    own_columns = columns(
        "case",
        *(Column(str(name), str(name).partition("_")[2]) for name in path),
        *("mesh", Column(LINE, "scheme")),
        *(*_ORDER, Column("expected", "theory", "g")),
        *_RANGE,
    )
    drawings = []
    for values, own in groups(fits, names):
        points = _rows(results[results["path_error"].notna()], values)
        title = ", ".join(str(value) for value in values.values() if not pd.isna(value))
        chart = axes.fitted(
            with_lines(points, lines, fits),
            with_lines(own, lines, fits),
            Axis(STEPS, "steps"),
            Axis("path_error", "largest relative error of the path"),
            by=LINE,
        )
        drawings.append(Drawing(f"{title}-steps", f"{title}: error against steps", chart))
    text = (
        "Largest relative error of the loads along each path. The theory (T30) predicts order 1 for"
        " explicit and implicit Euler steps, and order 2 for leapfrog and the implicit midpoint"
        " rule. The floor is the error of the mesh."
    )
    shown = with_lines(fits, lines, fits)
    blocks: list[Block] = [
        Text(text),
        Gallery(drawings),
        Details("Orders of the schemes", [Table(own_columns, shown)]),
    ]
    return Section("steps", "Error of paths against their steps", blocks)


def _refined(points: pd.DataFrame, fits: pd.DataFrame, title: str) -> list[Drawing]:
    """Return the error against elements, and against time."""
    columns = _solvers(fits, "")
    lines = with_lines(points, columns, fits)
    error = _fitted(points, fits, axes.ELEMENTS, axes.ERROR, tip=["mesh"])
    cost = axes.cost(lines, by=LINE)
    return [
        Drawing(f"{title}-refinement", f"{title}: error under refinement", error),
        Drawing(f"{title}-cost", f"{title}: error against solve time", cost),
    ]


def _fitted(
    points: pd.DataFrame, fits: pd.DataFrame, x: Axis, y: Axis, tip: Sequence[str] = ()
) -> Chart:
    columns = _solvers(fits, x.column)
    return axes.fitted(
        with_lines(points, columns, fits), with_lines(fits, columns, fits), x, y, by=LINE, tip=tip
    )


def _solvers(fits: pd.DataFrame, parameter: str) -> list[str]:
    return [name for name in solver_columns(fits) if name != parameter]


def _rows(frame: pd.DataFrame, names: dict[str, Any]) -> pd.DataFrame:
    """Return the rows with these values; missing ones are equal to missing ones."""
    keep = pd.Series(True, index=frame.index)
    for name, value in names.items():
        same = frame[name].isna() if pd.isna(value) else (frame[name] == value).fillna(False)
        keep &= same.astype(bool)
    return frame[keep]


def _title(names: dict[str, Any]) -> str:
    mesh = f", {names['mesh']} mesh" if "mesh" in names else ""
    return f"{names['case']}:{names['variant']}{mesh}"
