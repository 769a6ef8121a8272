"""Pictures of load cases: their load factors, one bar each."""

import numpy as np
from matplotlib.figure import Figure

from lacore.questions.load_cases import LoadCases
from lacore.showing import cut

_WIDTH, _ROW, _REST = 7.0, 0.34, 1.3  # inches
_GOVERNS, _OTHER, _NOTHING = "#b2182b", "#7fa6c9", "#999999"
_NAME = 28  # characters of the name of a case


def plot_load_cases(cases: LoadCases) -> Figure:
    """A bar a case, as long as its load factor; of brackets from 0 to the lower bound, then a line.

    The case that governs is red; those without a load factor say why.
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
