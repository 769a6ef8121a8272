"""Pictures of analyses: load factors along a parameter, load cases, sensitivities, envelopes."""

from itertools import combinations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.spatial import ConvexHull

from lacore.analyses.critical import Critical, Search
from lacore.analyses.load_cases import LoadCases
from lacore.analyses.position import WorstPosition
from lacore.analyses.sensitivity import Sensitivity
from lacore.analyses.stable import Stable
from lacore.analyses.yield_surface.envelope import Envelope
from lacore.numerics.arrays import Floats
from lacore.pictures.mechanism import plot_mechanism
from lacore.reporting.showing import counted, cut, listed
from lacore.reporting.units import Units

_SURFACE, _SURFACES = (6.4, 5.2), (4.2, 4.6)  # inches: of one picture, and of one of several
_INSIDE, _OUTSIDE = "#7fa6c9", "#b2182b"

_PARAMETERS_WIDTH, _PARAMETER_ROW, _HEADING = 8.0, 0.3, 1.3  # inches
_MOST_PARAMETERS = 16  # bars
_PARAMETER_COLOURS = {
    "strength": "#2b6a99",
    "load": "#b35806",
    "place": "#1b7837",
    "own": "#762a83",
}
_PARAMETER_NAME = 44  # characters of the name of a parameter

_WIDTH, _ROW, _REST = 7.0, 0.34, 1.3  # inches
_GOVERNS, _OTHER, _NOTHING = "#b2182b", "#7fa6c9", "#999999"
_NAME = 28  # characters of the name of a case

_SIZE = (7.0, 3.8)  # inches
_LINE, _FOUND, _WRONG = "#2b6a99", "#b2182b", "#999999"
_MARGIN = 0.06  # by the range of load factors
_TINY = float(np.finfo(float).tiny)
_HIGHEST = 4.0  # limit of a picture by its median, as higher values would flatten it


def plot_critical(found: Critical, parameter: str = "parameter") -> Figure:
    """Plot load factors over the parameter, the target, and their crossings.

    Values without a finite load factor are at the border, with their status.

    Args:
        found: the result.
        parameter: label of the axis.
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
    """Plot load factors over the position, and the smallest of them.

    Args:
        found: the result.
        position: label of the axis.
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


def plot_load_cases(cases: LoadCases) -> Figure:
    """Plot a bar per case with its load factor, or with its bounds for brackets.

    Bars of brackets end at the lower bound, with a line to the upper one. The governing case is
    red; cases without a load factor state the reason.
    """
    table = cases.table
    figure = Figure(figsize=(_WIDTH, _REST + _ROW * len(table)), layout="constrained")
    figure.set_facecolor("white")
    figure.suptitle(cut(cases.message, 200), fontsize=11, x=0.01, ha="left", wrap=True)
    axes = figure.add_subplot()
    low = table["load_factor"].where(np.isfinite(table["load_factor"]), table["lower"])
    high = table["load_factor"].where(np.isfinite(table["load_factor"]), table["upper"])
    for place, row in enumerate(table.itertuples()):
        colour = _GOVERNS if row.governs else _OTHER
        below, above = float(low.iloc[place]), float(high.iloc[place])
        if not (np.isfinite(below) and np.isfinite(above)):
            told = f"{row.status}: load factor {row.load_factor:g}"
            grey = _GOVERNS if row.governs else _NOTHING
            axes.text(0.0, place, f" {told}", va="center", fontsize=8, color=grey)
            continue
        axes.barh(place, below, height=0.62, color=colour)
        text = f"{below:.4g}"
        if above > below:
            axes.plot([below, above], [place, place], color="black", lw=1.2, marker="|")
            text += f" to {above:.4g}"
        axes.annotate(
            text, (max(above, 0.0), place), (4, 0), textcoords="offset points", va="center",
            fontsize=8,
        )  # fmt: skip
    axes.set_yticks(range(len(table)), [cut(name, _NAME) for name in table["case"]], fontsize=9)
    axes.set_ylim(len(table) - 0.4, -0.6)
    axes.axvline(0.0, color="black", lw=0.8)
    axes.margins(x=0.16)
    axes.set_xlabel("load factor", fontsize=9)
    axes.tick_params(labelsize=8)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)
    return figure


def plot_stable(found: Stable, units: Units | None = None) -> Figure:
    """Plot the stresses that carry the dead loads, or the mechanism of collapse under them.

    Args:
        found: the result.
        units: see `plot_mechanism`.

    Raises:
        ValueError: neither is proven.
    """
    figure = plot_mechanism(found.state, units)
    standing = found.stability.standing
    heading = cut(f"{standing.label.upper()}: {standing.value}", 95)
    residual = found.stability.residual
    told = f"{found.state.backend}, largest residual of the certificate {residual:.1e}"
    figure.suptitle(f"{heading}\n{told}", fontsize=11, x=0.01, ha="left", wrap=True)
    figure.draw_without_rendering()
    return figure


def plot_sensitivity(found: Sensitivity) -> Figure:
    """Plot the per cent of change of the load factor per one per cent of each parameter.

    The most important parameters are first. If mechanisms are not unique, both one-sided values are
    drawn: the full bar for an increase, the hollow one for a decrease.
    """
    table = found.table.dropna(subset="elasticity").head(_MOST_PARAMETERS)
    figure = Figure(
        figsize=(_PARAMETERS_WIDTH, _HEADING + _PARAMETER_ROW * max(len(table), 1)),
        layout="constrained",
    )
    figure.set_facecolor("white")
    methods = " and ".join(dict.fromkeys(found.table["method"]))
    heading = f"load factor {found.state.load_factor:.6g}: sensitivities by {methods}"
    figure.suptitle(heading, fontsize=11, x=0.01, ha="left", wrap=True)
    axes = figure.add_subplot()
    for place, row in enumerate(table.to_dict("records")):
        colour = _PARAMETER_COLOURS[row["kind"]]
        sides = [row["elasticity"]]
        if not row["unique"]:
            most = max(row["left"], row["right"], key=abs)
            sides = [row["elasticity"] * row[side] / most for side in ("right", "left")]
            axes.barh(place, sides[1], height=0.62, fill=False, edgecolor=colour, lw=1.2)
        axes.barh(place, sides[0], height=0.62, color=colour)
        far = max(sides, key=abs)
        axes.annotate(
            " / ".join(f"{side:+z.3f}" for side in sides), (far, place),
            (4 if far >= 0 else -4, 0), textcoords="offset points", va="center",
            ha="left" if far >= 0 else "right", fontsize=8,
        )  # fmt: skip
    axes.set_yticks(
        range(len(table)), [cut(name, _PARAMETER_NAME) for name in table["parameter"]], fontsize=8
    )
    axes.set_ylim(max(len(table), 1) - 0.4, -0.6)
    axes.axvline(0.0, color="black", lw=0.8)
    axes.margins(x=0.3)
    axes.set_xlabel("elasticity: change of the load factor in % for a change of 1 %", fontsize=9)
    axes.tick_params(axis="x", labelsize=8)
    for kind in dict.fromkeys(table["kind"]):
        axes.bar(np.nan, np.nan, color=_PARAMETER_COLOURS[kind], label=kind)
    if len(table):
        axes.legend(fontsize=8, frameon=False, loc="best")
    rest = len(found.table) - len(table)
    if rest:
        axes.set_title(f"and {counted(rest, 'parameter')} more", fontsize=8, loc="right")
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)
    return figure


def plot_envelope(found: Envelope) -> Figure:
    """Plot the inner and outer polygon, with their points and directions.

    For three components the projections of both sets on each pair of axes are drawn; for Coulomb
    states the points.
    """
    pairs = list(combinations(range(len(found.names)), 2))
    size = _SURFACE if len(pairs) == 1 else (_SURFACES[0] * len(pairs), _SURFACES[1])
    figure = Figure(figsize=size, layout="constrained")
    figure.set_facecolor("white")
    figure.suptitle(found.message, fontsize=11, x=0.01, ha="left", wrap=True)
    for place, pair in enumerate(pairs):
        axes = figure.add_subplot(1, len(pairs), place + 1)
        _draw(axes, found, np.array(pair))
        axes.set_xlabel(found.names[pair[0]], fontsize=9)
        axes.set_ylabel(found.names[pair[1]], fontsize=9)
        axes.tick_params(labelsize=8)
        axes.grid(color="#dddddd", lw=0.5)
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower left", ncols=3, fontsize=8, frameon=False)
    return figure


def _draw(axes: Axes, found: Envelope, pair: Floats) -> None:
    inner, shadow = found.inner[:, pair], ", projected" * (len(found.names) > 2)
    axes.axhline(0.0, color="black", lw=0.6, zorder=1)
    axes.axvline(0.0, color="black", lw=0.6, zorder=1)
    if not found.convex:
        axes.plot(*inner.T, "o", color=_OUTSIDE, ms=4, label="certified point")
        return
    hull = inner[ConvexHull(inner / np.ptp(inner, axis=0)).vertices]
    axes.fill(*hull.T, color=_INSIDE, alpha=0.55, lw=0, label=f"carried (proven){shadow}")
    axes.plot(*hull.T, "o", color="#2b6a99", ms=3)
    outer = found.outer[:, pair]
    if not len(outer):
        return
    border = outer[ConvexHull(outer / np.ptp(outer, axis=0)).vertices]
    border = np.concatenate([border, border[:1]])
    axes.plot(*border.T, color=_OUTSIDE, lw=1.2, label=f"not carried beyond (proven){shadow}")
    if not found.bounded:
        reach = np.ptp(hull, axis=0)
        axes.set_xlim(hull[:, 0].min() - 0.3 * reach[0], hull[:, 0].max() + 0.3 * reach[0])
        axes.set_ylim(hull[:, 1].min() - 0.3 * reach[1], hull[:, 1].max() + 0.3 * reach[1])
