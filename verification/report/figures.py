"""Figures of the report."""

import io
from collections.abc import Sequence
from math import isfinite, nan

import numpy as np
from matplotlib.figure import Figure

from verification.case import Case, Variant
from verification.judging import BOUNDS
from verification.run import Outcome

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
        row = outcome.row
        return (np.isfinite(row.load_factor), np.isnan(row.P), row.n_elements)

    for outcome in outcomes:
        if not outcome.evidence.arrays:
            continue
        if outcome.row.coupling in BOUNDS:
            continue
        name = outcome.run.variant.name
        if name not in best or rank(outcome) > rank(best[name]):
            best[name] = outcome
    return best


def sweep_figure(case: Case, outcomes: Sequence[Outcome]) -> Figure | None:
    """Load factor against the parameter `case.sweep`; None with fewer than three values of it.

    Of the variants that differ in nothing else: the largest such family.
    """
    families: dict[tuple[object, ...], list[Outcome]] = {}
    for outcome in outcomes:
        if outcome.row.coupling not in BOUNDS and case.sweep in outcome.run.variant.parameters:
            families.setdefault(_others(case, outcome), []).append(outcome)
    family = max(families.values(), key=lambda own: len(_swept(case, own)), default=[])
    values = _swept(case, family)
    if len(values) < 3:
        return None
    figure = Figure(figsize=(7.0, 3.6), layout="constrained")
    figure.set_facecolor("white")
    axes = figure.add_subplot()
    points, low, high = _reference_curve(case, family[0].run.variant, values)
    axes.plot(points, low, color="#444444", lw=1.4, label="reference", zorder=1)
    if low != high:
        axes.plot(points, high, color="#444444", lw=1.4, zorder=1)
        axes.fill_between(points, low, high, color="#dddddd", label="Coulomb loads", zorder=0)
    backends = list(dict.fromkeys(outcome.run.backend for outcome in family))
    for index, backend in enumerate(backends):
        rows = [
            (float(outcome.run.variant.parameters[case.sweep]), outcome.row.load_factor)
            for outcome in _finest(family, backend)
        ]
        if not rows:
            continue
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
    axes.legend(edgecolor="none", framealpha=0.9)
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


def _others(case: Case, outcome: Outcome) -> tuple[object, ...]:
    """All parameters but the one that is swept."""
    parameters = outcome.run.variant.parameters
    return tuple(sorted((n, v) for n, v in parameters.items() if n != case.sweep))


def _swept(case: Case, outcomes: Sequence[Outcome]) -> list[float]:
    return sorted({float(outcome.run.variant.parameters[case.sweep]) for outcome in outcomes})


def _reference_curve(
    case: Case, variant: Variant, values: list[float]
) -> tuple[list[float], list[float], list[float]]:
    """Places and ends of the references of the variants; dense where there is a formula."""

    def ends(points: list[float]) -> tuple[list[float], list[float], list[float]]:
        found = [case.reference(**{**variant.parameters, case.sweep: value}) for value in points]
        low = [one.value if isfinite(one.value) else nan for one in found]
        high = [a if one.up_to is None else one.up_to for a, one in zip(low, found, strict=True)]
        return points, low, high

    points = np.unique(np.concatenate([np.linspace(values[0], values[-1], 201), values]))
    try:
        return ends(points.tolist())
    except LookupError:  # only tabulated
        return ends(values)
