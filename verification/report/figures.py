"""Figures of the report."""

import io
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from verification.case import Case
from verification.harness import Outcome

_MARKERS = "osD^v<>pX"
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")


def png(figure: Figure, dpi: int = 110) -> bytes:
    """A figure as a PNG file."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi)
    return buffer.getvalue()


def finest_exact(outcomes: Sequence[Outcome]) -> dict[str, Outcome]:
    """For each variant of one case the outcome to show: exact before regularised, then finest."""
    best: dict[str, Outcome] = {}

    def rank(outcome: Outcome) -> tuple[bool, bool, float]:
        state = outcome.state
        assert state is not None
        return (np.isfinite(state.load_factor), state.regularised is None, outcome.row.n_elements)

    for outcome in outcomes:
        if outcome.state is None or outcome.state.point is None:
            continue
        name = outcome.run.variant.name
        if name not in best or rank(outcome) > rank(best[name]):
            best[name] = outcome
    return best


def sweep_figure(case: Case, outcomes: Sequence[Outcome]) -> Figure | None:
    """Load factor against the parameter `case.sweep`; None with fewer than three values of it."""
    values = sorted({float(outcome.run.variant.parameters[case.sweep]) for outcome in outcomes})
    if len(values) < 3:
        return None
    figure = Figure(figsize=(7.0, 3.6), layout="constrained")
    figure.set_facecolor("white")
    axes = figure.add_subplot()
    axes.plot(*_reference_curve(case, values), color="#444444", lw=1.4, label="reference", zorder=1)
    backends = list(dict.fromkeys(outcome.run.backend for outcome in outcomes))
    for index, backend in enumerate(backends):
        rows = [
            (float(outcome.run.variant.parameters[case.sweep]), outcome.row.load_factor)
            for outcome in _finest(outcomes, backend)
        ]
        axes.plot(
            *zip(*rows, strict=True),
            ls="none",
            marker=_MARKERS[index % len(_MARKERS)],
            ms=9 - 2.2 * (index % 3),
            mfc="none" if index % 3 == 0 else _COLOURS[index % len(_COLOURS)],
            mec=_COLOURS[index % len(_COLOURS)],
            mew=1.6,
            label=backend,
        )
    axes.set_xlabel(case.sweep)
    axes.set_ylabel(f"load factor [{case.unit}]")
    axes.grid(color="#e5e5e5", lw=0.8)
    axes.set_axisbelow(True)
    axes.legend(frameon=False)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return figure


def _finest(outcomes: Sequence[Outcome], backend: str) -> list[Outcome]:
    """The finished outcome on the finest mesh of each variant, of one backend."""
    best: dict[str, Outcome] = {}
    for outcome in outcomes:
        name = outcome.run.variant.name
        if outcome.run.backend != backend or not np.isfinite(outcome.row.load_factor):
            continue
        if name not in best or outcome.row.n_elements > best[name].row.n_elements:
            best[name] = outcome
    return list(best.values())


def _reference_curve(case: Case, values: list[float]) -> tuple[list[float], list[float]]:
    """Through the references of the variants; dense where the case has a formula for any value."""
    points = np.unique(np.concatenate([np.linspace(values[0], values[-1], 201), values]))
    try:
        return points.tolist(), [case.reference(**{case.sweep: value}).value for value in points]
    except LookupError:  # only tabulated
        return values, [case.reference(**{case.sweep: value}).value for value in values]
