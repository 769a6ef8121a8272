"""Colours and type of figures, and their CSS variables on the page.

A figure is drawn with the light colours, so that it also looks right as a PNG; on the page each of
them becomes a variable of `style.html.j2`, with another value in dark mode.
"""

from collections.abc import Mapping
from contextlib import AbstractContextManager
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from lacore.pictures.axis import lay_out

INK, SOFT, LINE, PAPER, BAND = "#1c1c1e", "#5f6368", "#dcdcd8", "#ffffff", "#dddddb"
SERIES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b58900", "#56b4e9", "#7a5195", "#8c564b")
"""Colours that colour-blind readers can distinguish (Okabe & Ito), and two more."""
MARKERS = "osD^vPX<"

VARIABLES: Mapping[str, str] = {
    INK: "--ink",
    SOFT: "--soft",
    LINE: "--line",
    PAPER: "--paper",
    BAND: "--band",
    **{colour: f"--series-{number}" for number, colour in enumerate(SERIES, start=1)},
}
"""CSS variable of each colour."""

STYLE: Mapping[str, Any] = {
    "font.family": "DejaVu Sans",  # part of matplotlib: the same layout on every machine
    "font.size": 10,
    "text.parse_math": False,  # A $ in a name is not mathematics.
    "text.color": INK,
    "axes.edgecolor": SOFT,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.facecolor": "none",
    "figure.facecolor": PAPER,
    "grid.color": LINE,
    "grid.linewidth": 0.7,
    "xtick.color": SOFT,
    "ytick.color": SOFT,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.minor.size": 0,
    "ytick.minor.size": 0,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "legend.handlelength": 1.8,
    "lines.linewidth": 1.6,
    "lines.markersize": 5.5,
    "svg.fonttype": "none",  # Text remains text: small, selectable, in the font of the page.
    "svg.hashsalt": "lacore",
}
"""Settings of matplotlib."""


def styled() -> AbstractContextManager[None]:
    """Return a context in which figures are drawn in our style."""
    settings: Any = dict(STYLE)  # matplotlib lists every key in its type.
    return mpl.rc_context(settings)


def freeze(figure: Figure, again: bool = True) -> None:
    """Fix the layout of a figure, since saving would otherwise compute it twice, and draw twice.

    Args:
        figure: any figure.
        again: compute it first; False for a figure with a layout.
    """
    if again:
        lay_out(figure)
    with mpl.rc_context({"figure.constrained_layout.use": False, "figure.autolayout": False}):
        figure.set_layout_engine(None)  # "none" leaves an engine that does nothing, but draws.
