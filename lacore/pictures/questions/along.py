"""Pictures of load factors along a parameter: critical values, worst positions."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lacore.questions.critical import Critical, Search
from lacore.questions.position import WorstPosition
from lacore.showing import listed

_SIZE = (7.0, 3.8)  # inches
_LINE, _FOUND, _WRONG = "#2b6a99", "#b2182b", "#999999"
_MARGIN = 0.06  # of the range of load factors
_TINY = float(np.finfo(float).tiny)
_HIGHEST = 4.0  # of a picture of the least, per the middle one: others would flatten it


def plot_critical(found: Critical, parameter: str = "parameter") -> Figure:
    """Load factors over the parameter, the target, and wherever both were found to meet.

    Values without a finite load factor stand at the border, with their status.

    Args:
        found: the answer.
        parameter: what the axis is called.
    """
    figure, axes = _axes(_heading(found))
    _curve(axes, found.table, found.target)
    axes.axhline(found.target, color="black", lw=0.8, ls="--", zorder=1)
    axes.annotate(
        f"target {found.target:g}", (0.995, found.target), (0, 3), ha="right", fontsize=8,
        xycoords=("axes fraction", "data"), textcoords="offset points",
    )  # fmt: skip
    for own in found.crossings:
        if own.status is Search.FOUND:
            axes.axvline(own.value, color=_FOUND, lw=1.0, zorder=1)
            axes.plot([own.value], [found.target], "o", color=_FOUND, ms=7, zorder=4)
    axes.set_ylabel(found.of.replace(", ", ",\n"), fontsize=9)
    axes.set_xlabel(parameter, fontsize=9)
    return figure


def plot_worst_position(found: WorstPosition, position: str = "position") -> Figure:
    """Load factors over the position, and the least of them.

    Args:
        found: the answer.
        position: what the axis is called.
    """
    heading = f"smallest load factor found: {found.load_factor:.6g} at {found.position:.6g}"
    figure, axes = _axes(heading)
    _curve(axes, found.table, found.load_factor, highest=_HIGHEST)
    if np.isfinite(found.load_factor):
        axes.plot([found.position], [found.load_factor], "o", color=_FOUND, ms=7, zorder=4)
    axes.set_ylabel("load factor", fontsize=9)
    axes.set_xlabel(position, fontsize=9)
    return figure


def _heading(found: Critical) -> str:
    if found.status is not Search.FOUND:
        return f"{found.status.label}: {found.status.value}"
    crossed = [own.value for own in found.crossings if own.status is Search.FOUND]
    if len(crossed) > 1:
        return f"the target is reached at {listed([f'{value:.7g}' for value in crossed])}"
    return (
        f"the target is reached at {found.value:.7g} (between {found.low:.9g} and {found.high:.9g})"
    )


def _axes(heading: str) -> tuple[Figure, Axes]:
    figure = Figure(figsize=_SIZE, layout="constrained")
    figure.set_facecolor("white")
    figure.suptitle(heading, fontsize=11, x=0.01, ha="left", wrap=True)
    axes = figure.add_subplot()
    axes.tick_params(labelsize=8)
    axes.grid(color="#dddddd", lw=0.5)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return figure, axes


def _curve(axes: Axes, table: pd.DataFrame, level: float, highest: float = np.inf) -> None:
    value = table["load_factor"].to_numpy()
    finite = np.isfinite(value)
    axes.plot(
        table["parameter"][finite], value[finite], "-o", color=_LINE, ms=3.5, lw=1.2, zorder=3
    )
    seen = np.append(value[finite], level if np.isfinite(level) else np.zeros(0))
    if not seen.size:
        seen = np.zeros(1)
    seen = np.minimum(seen, seen.min() + highest * max(np.median(seen) - seen.min(), _TINY))
    room = _MARGIN * (np.ptp(seen) or abs(seen[0]) or 1.0)
    low, high = float(seen.min() - 2 * room), float(seen.max() + 2 * room)
    axes.set_ylim(low, high)
    for row in table[~finite].itertuples():
        place = high - room if row.load_factor == np.inf else low + room
        axes.plot([row.parameter], [place], "x", color=_WRONG, ms=5)
        axes.annotate(
            str(row.status), (row.parameter, place), (3, 3), textcoords="offset points",
            fontsize=7, color=_WRONG,
        )  # fmt: skip
