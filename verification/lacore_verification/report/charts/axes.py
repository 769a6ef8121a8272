"""Charts of results from a DataFrame, with the values of points as tooltips.

A line is drawn for each value of the column `by`, in the same order and colours for the same
values. Points that cannot be drawn (not finite, or not positive on a logarithmic axis) are left
out, and the summary of the chart states their number.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, log10, nan
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import (
    FuncFormatter,
    LogLocator,
    MaxNLocator,
    NullFormatter,
    PercentFormatter,
)

from lacore.pictures.axis import power
from lacore_verification.report.charts.svg import Chart, Tip
from lacore_verification.report.charts.theme import MARKERS, SERIES, styled

_SIZE = (5.6, 3.9)  # inches: type of 10 points is readable on a phone
_MINUS = "\N{MINUS SIGN}"
_DASHES = ("-", "--", "-.", ":")
_LONGEST = 40  # letters of a name in the legend
_HALF = 38  # letters of an entry that fits into half the width
_PLAIN = (1e-4, 2e4)  # range in which numbers of an axis are written out
_DECADES = 8  # largest number of labels on a logarithmic axis
_NARROW = 0.5  # decades: a smaller range may contain no round multiple of a power of ten
_FEW = 2.2  # decades: for a smaller range, powers of ten alone would leave the axis without labels


@dataclass(frozen=True)
class Axis:
    """Column on an axis.

    Attributes:
        column: name in the DataFrame.
        label: label with its unit.
        log: whether the axis is logarithmic, with positive values only.
    """

    column: str
    label: str
    log: bool = True


ELEMENTS = Axis("n_elements", "number of elements")
ERROR = Axis("error", "relative error")
BUDGET = Axis("budget", "solve time / (unknowns + 1) [s]")
FACTOR = Axis("factor", "time relative to the fastest solver")
SHARE = Axis("share", "share of problems solved", log=False)
RESIDUAL = Axis("residual", "largest residual of the certificate")
SOLVE_TIME = Axis("solve_time", "solve time [s]")


def curves(
    data: pd.DataFrame,
    x: Axis,
    y: Axis,
    *,
    by: str = "backend",
    tip: Sequence[str] = (),
    along: Axis | None = None,
) -> Chart:
    """Draw markers joined by lines in the order of `x`.

    Convergence without a fit, cost, iterations.

    Args:
        data: columns `x.column`, `y.column`, `by` and those of `tip`.
        x, y: the axes; the absolute value of `y` is shown on a logarithmic axis.
        by: column that distinguishes the lines, with its values in the legend.
        tip: further columns in tooltips.
        along: Axis whose order the lines follow, if that is not `x`.
    """
    shown, left_out = _drawable(data, x, y)
    if along is not None:
        shown = shown.sort_values(along.column, kind="stable")
    with styled():
        figure, axes = figure_axes()
        tips = _markers(axes, shown, x, y, by, tip, {}, "-")
        _finish(figure, axes, x, y)
    return Chart(figure, _summary(shown, x, y, by, left_out), tips)


def scatter(data: pd.DataFrame, x: Axis, y: Axis, tip: Sequence[str]) -> Chart:
    """Draw markers alone: results of many runs. Arguments as for `curves`."""
    by = "backend"
    shown, left_out = _drawable(data, x, y)
    with styled():
        figure, axes = figure_axes()
        tips = _markers(axes, shown, x, y, by, tip, {}, "none")
        _finish(figure, axes, x, y)
    return Chart(figure, _summary(shown, x, y, by, left_out), tips)


def fitted(
    data: pd.DataFrame,
    fits: pd.DataFrame,
    x: Axis,
    y: Axis,
    *,
    by: str = "backend",
    tip: Sequence[str] = (),
) -> Chart:
    """Draw markers with power laws: error against a swept parameter, or under refinement.

    Each law is drawn over its range of validity, with its floor dotted over all of `x`; the legend
    gives its slope, or states that there is none.

    Args:
        data: see `curves`.
        fits: from `lacore_verification.harness.analysis.slopes` (columns `by` and those of
            `Slope`), at most one row for each value of `by`.
        x, y, by, tip: see `curves`.

    Raises:
        ValueError: two fits of one line.
    """
    if fits[by].duplicated().any():
        raise ValueError(f"several fits for one {by}: {list(fits[by])}; choose one group")
    shown, left_out = _drawable(data, x, y)
    laws = {str(record[by]): record for record in fits.to_dict("records")}
    words = {name: slope_text(law) for name, law in laws.items()}
    with styled():
        figure, axes = figure_axes()
        tips = _markers(axes, shown, x, y, by, tip, words, "none")
        for colour, name in _colours(shown, by):
            if name in laws:
                _draw(axes, laws[name], colour, shown[x.column])
        _finish(figure, axes, x, y)
    slopes = "; ".join(f"{name}: {text}" for name, text in words.items())
    summary = _summary(shown, x, y, by, left_out)
    return Chart(figure, f"{summary} {slopes}." if slopes else summary, tips)


def profile(data: pd.DataFrame, x: Axis, share: Axis = SHARE, *, by: str = "solver") -> Chart:
    """Draw the steps of a profile from `lacore_verification.harness.analysis`.

    Args:
        data: one row per step: from `x.column` on, the share is `share.column` (0 to 1).
        x: axis of the factor to the best (`FACTOR`), or of the budget.
        share: axis of the share of solved problems, in per cent.
        by: column that distinguishes the profiles.
    """
    shown, left_out = _drawable(data, x, share)
    with styled():
        figure, axes = figure_axes()
        tips = []
        for number, (colour, name) in enumerate(_colours(shown, by)):
            own = shown[shown[by].astype(str) == name].sort_values(x.column)
            places, shares = own[x.column].to_list(), own[share.column].to_list()
            axes.step(
                places,
                shares,
                where="post",
                color=colour,
                ls=_DASHES[number % len(_DASHES)],
                lw=2,
                label=labelled(name),
            )
            tips += [
                Tip(axes, place, value, f"{name}: {100 * value:.3g} % within {place:.3g}")
                for place, value in zip(places, shares, strict=True)
            ]
        axes.set_ylim(-0.02, 1.04)
        axes.yaxis.set_major_formatter(PercentFormatter(1.0))
        _finish(figure, axes, x, share)
    return Chart(figure, _summary(shown, x, share, by, left_out), tips)


def cost(results: pd.DataFrame, *, by: str = "backend") -> Chart:
    """Draw relative error against time: columns `error`, `solve_time`, `mesh` and `by`."""
    return curves(results, SOLVE_TIME, ERROR, by=by, tip=["mesh"])


def figure_axes() -> tuple[Figure, Axes]:
    """Return an empty figure for one chart; draw within `theme.styled`."""
    figure = Figure(figsize=_SIZE, layout="constrained")
    return figure, figure.add_subplot()


def _drawable(data: pd.DataFrame, x: Axis, y: Axis) -> tuple[pd.DataFrame, int]:
    """Return the rows that can be drawn, in the order of `x`, and the number of the others.

    On a logarithmic axis `y`, signs are dropped.
    """
    numbers = data.assign(
        **{axis.column: data[axis.column].to_numpy(dtype=float, na_value=nan) for axis in (x, y)},
    )
    if y.log:
        numbers[y.column] = numbers[y.column].abs()
    keep = np.isfinite(numbers[x.column]) & np.isfinite(numbers[y.column])
    for axis in (x, y):
        if axis.log:
            keep &= numbers[axis.column] > 0
    return numbers[keep].sort_values(x.column, kind="stable"), int((~keep).sum())


def _colours(data: pd.DataFrame, by: str) -> list[tuple[str, str]]:
    """Colour and name of each line."""
    names = sorted(set(data[by].astype(str)))
    return [(SERIES[number % len(SERIES)], name) for number, name in enumerate(names)]


def _markers(
    axes: Axes,
    data: pd.DataFrame,
    x: Axis,
    y: Axis,
    by: str,
    tip: Sequence[str],
    words: Mapping[str, str],
    line: str,
) -> list[Tip]:
    """Draw a line for each value of `by`, with `words` behind its name in the legend."""
    tips = []
    for number, (colour, name) in enumerate(_colours(data, by)):
        own = data[data[by].astype(str) == name]
        axes.plot(
            own[x.column],
            own[y.column],
            color=colour,
            ls=line,
            marker=MARKERS[number % len(MARKERS)],
            mfc="none" if number % 2 else colour,  # An open marker does not hide one below it.
            ms=5 + 2 * (number % 2),
            label=labelled(name, f", {words[name]}" if name in words else ""),
        )
        for record in own.to_dict("records"):
            shown = [f"{axis.label}: {record[axis.column]:.4g}" for axis in (x, y)]
            shown += [f"{column}: {_text(record[column])}" for column in tip]
            text = "\n".join([name, *shown])
            tips.append(Tip(axes, record[x.column], record[y.column], text))
    return tips


def slope_text(law: Mapping[Any, Any]) -> str:
    """Return a text for the legend: ``slope -1.02 ± 0.03``, by half the confidence interval."""
    if not isfinite(law["slope"]):
        return "no slope"
    half = (law["high"] - law["low"]) / 2
    digits = 2 if not half < 0.01 else 3
    error = f" ± {half:.{digits}f}" if isfinite(half) else ""
    return f"slope {law['slope']:.{digits}f}{error}".replace("-", _MINUS)


def _draw(axes: Axes, law: Mapping[Any, Any], colour: str, places: Iterable[float]) -> None:
    """Draw a law over its range, and its floor over all places."""
    if isfinite(law["slope"]) and isfinite(law["coefficient"]):
        ends = np.array([law["start"], law["stop"]])
        axes.plot(ends, law["coefficient"] * ends ** law["slope"], color=colour, lw=1.4)
    if isfinite(law["floor"]):
        ends = np.array([min(places), max(places)])
        axes.plot(ends, [law["floor"], law["floor"]], color=colour, lw=1.2, ls=":")


def _finish(figure: Figure, axes: Axes, x: Axis, y: Axis) -> None:
    """Set scales, labels, and legend."""
    for axis, which, scale in ((x, axes.xaxis, axes.set_xscale), (y, axes.yaxis, axes.set_yscale)):
        if axis.log:
            scale("log")
            ends = which.get_view_interval()
            subs = (1.0,) if log10(ends[1] / ends[0]) > _FEW else (1.0, 2.0, 5.0)
            narrow = log10(ends[1] / ends[0]) < _NARROW
            locator = MaxNLocator(5) if narrow else LogLocator(subs=subs, numticks=_DECADES)
            which.set_major_locator(locator)
            which.set_major_formatter(FuncFormatter(tick_words(*ends)))
            which.set_minor_formatter(NullFormatter())
        which.set_tick_params(which="minor", length=0)
        which.set_label_text(axis.label)
    legend(figure, axes)


def legend(figure: Figure, axes: Axes) -> None:
    """Draw the legend above the axes, with names shortened by `labelled`."""
    handles, labels = axes.get_legend_handles_labels()
    columns = 2 if all(len(label) <= _HALF for label in labels) else 1
    figure.legend(handles, labels, loc="outside upper left", ncols=columns, borderaxespad=0.2)


def labelled(name: str, words: str = "") -> str:
    """Return a name for the legend: short, and visible even if it begins with an underscore."""
    short = name if len(name) <= _LONGEST else name[: _LONGEST - 1] + "…"
    return ("\u200b" if short.startswith("_") else "") + short + words


def tick_words(low: float, high: float) -> Callable[[float, int], str]:
    """Return the format of ticks between two ends: all plain, or all powers of ten."""
    plain = _PLAIN[0] <= low and high <= _PLAIN[1]
    return lambda value, _: f"{value:g}" if plain or not value > 0 else power(value)


def _summary(data: pd.DataFrame, x: Axis, y: Axis, by: str, left_out: int) -> str:
    names = ", ".join(name for _, name in _colours(data, by)) or "no points"
    missing = f" {left_out} points cannot be drawn." if left_out else ""
    return f"{y.label} against {x.label}: {names}.{missing}"


def _text(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
