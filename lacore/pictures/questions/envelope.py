"""Pictures of yield surfaces: what is carried, what is not, and what is between."""

from itertools import combinations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.spatial import ConvexHull

from lacore.arrays import Floats
from lacore.questions.yield_surface.envelope import Envelope

_SIZE, _PANEL = (6.4, 5.2), (4.2, 4.6)  # inches: of one picture, and of one of several
_INSIDE, _OUTSIDE = "#7fa6c9", "#b2182b"


def plot_envelope(found: Envelope) -> Figure:
    """Inner and outer polygon, with the points and directions that they come from.

    Of three components the shadows of both bodies on each pair of axes. Of Coulomb states points.
    """
    pairs = list(combinations(range(len(found.names)), 2))
    size = _SIZE if len(pairs) == 1 else (_PANEL[0] * len(pairs), _PANEL[1])
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
