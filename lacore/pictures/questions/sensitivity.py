"""Pictures of sensitivities: elasticities, one bar each."""

import numpy as np
from matplotlib.figure import Figure

from lacore.questions.sensitivity import Sensitivity
from lacore.showing import counted, cut

_WIDTH, _ROW, _REST = 8.0, 0.3, 1.3  # inches
_MOST = 16  # bars
_COLOURS = {"strength": "#2b6a99", "load": "#b35806", "place": "#1b7837", "own": "#762a83"}
_NAME = 44  # characters of the name of a parameter


def plot_sensitivity(found: Sensitivity) -> Figure:
    """By how many per cent the load factor changes with one per cent of each parameter.

    Those that matter most first. Where mechanisms are not unique both one-sided values are drawn: a
    change to more is the full bar, one to less the hollow one.
    """
    table = found.table.dropna(subset="elasticity").head(_MOST)
    figure = Figure(figsize=(_WIDTH, _REST + _ROW * max(len(table), 1)), layout="constrained")
    figure.set_facecolor("white")
    methods = " and ".join(dict.fromkeys(found.table["method"]))
    heading = f"load factor {found.state.load_factor:.6g}: sensitivities by {methods}"
    figure.suptitle(heading, fontsize=11, x=0.01, ha="left", wrap=True)
    axes = figure.add_subplot()
    for place, row in enumerate(table.to_dict("records")):
        colour = _COLOURS[row["kind"]]
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
        range(len(table)), [cut(name, _NAME) for name in table["parameter"]], fontsize=8
    )
    axes.set_ylim(max(len(table), 1) - 0.4, -0.6)
    axes.axvline(0.0, color="black", lw=0.8)
    axes.margins(x=0.3)
    axes.set_xlabel("elasticity: change of the load factor in % for a change of 1 %", fontsize=9)
    axes.tick_params(axis="x", labelsize=8)
    for kind in dict.fromkeys(table["kind"]):
        axes.bar(np.nan, np.nan, color=_COLOURS[kind], label=kind)
    if len(table):
        axes.legend(fontsize=8, frameon=False, loc="best")
    rest = len(found.table) - len(table)
    if rest:
        axes.set_title(f"and {counted(rest, 'parameter')} more", fontsize=8, loc="right")
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)
    return figure
