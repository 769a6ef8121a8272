"""Charts of a value of each backend over several versions."""

from collections.abc import Sequence
from math import isfinite

import pandas as pd
from matplotlib.ticker import PercentFormatter

from lacore_verification.report.charts.axes import Axis, figure_axes, labelled, legend
from lacore_verification.report.charts.svg import Chart, Tip
from lacore_verification.report.charts.theme import MARKERS, SERIES, styled

_LETTERS = 14  # letters of the name of a version below the axis
_TURNED = 4  # number of versions above which their names are rotated


def by_version(data: pd.DataFrame, value: Axis, versions: Sequence[str], share: bool) -> Chart:
    """Draw a line for each backend, with the versions in their order on the horizontal axis.

    Args:
        data: Columns ``backend``, ``version`` and that of `value`; missing values are left out.
        value: The vertical axis.
        versions: Names of all versions.
        share: Whether the values are shares, which are shown in per cent.
    """
    places = {name: number for number, name in enumerate(versions)}
    tips = []
    with styled():
        figure, axes = figure_axes()
        for number, backend in enumerate(dict.fromkeys(data["backend"])):
            own = data[data["backend"] == backend]
            pairs = zip(own["version"], own[value.column], strict=True)
            known = [(name, float(height)) for name, height in pairs if isfinite(height)]
            colour = SERIES[number % len(SERIES)]
            axes.plot(
                [places[name] for name, _ in known],
                [height for _, height in known],
                color=colour,
                marker=MARKERS[number % len(MARKERS)],
                mfc="none" if number % 2 else colour,
                ms=5 + 2 * (number % 2),
                label=labelled(str(backend)),
            )
            tips += [
                Tip(axes, places[name], height, f"{backend}, {name}\n{value.label}: {height:.4g}")
                for name, height in known
            ]
        axes.set_xticks(
            range(len(versions)),
            [_short(name) for name in versions],
            rotation=30 if len(versions) > _TURNED else 0,
        )
        axes.set_xlim(-0.3, len(versions) - 0.7)
        axes.set_ylabel(value.label)
        if share:
            axes.set_ylim(-0.02, 1.04)
            axes.yaxis.set_major_formatter(PercentFormatter(1.0))
        else:
            axes.set_ylim(bottom=0)
        legend(figure, axes)
    names = ", ".join(map(str, dict.fromkeys(data["backend"])))
    return Chart(figure, f"{value.label} in {', '.join(versions)}: {names}.", tips)


def _short(name: str) -> str:
    return name if len(name) <= _LETTERS else f"…{name[1 - _LETTERS :]}"
