"""Figures of a comparison."""

import io
from collections.abc import Sequence
from math import isfinite, nan

import numpy as np
from matplotlib.figure import Figure

from lacore_verification.case import Case, Variant
from lacore_verification.harness.verdicts.limit_state import FINDS_NONE
from lacore_verification.report.charts.axes import figure_axes, labelled, legend
from lacore_verification.report.charts.svg import Chart, Tip
from lacore_verification.report.charts.theme import BAND, INK, MARKERS, SERIES, freeze, styled
from lacore_verification.runs.outcome import Outcome

_COMPRESSION = 3  # of 9: half the time of the default, for files that are 8 % larger


def png(figure: Figure, dpi: int = 110) -> bytes:
    """Return a figure as a PNG file."""
    figure.set_dpi(dpi)
    freeze(figure)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi, pil_kwargs={"compress_level": _COMPRESSION})
    return buffer.getvalue()


def finest_exact(outcomes: Sequence[Outcome]) -> dict[str, Outcome]:
    """Return the outcome to show for each variant of a case: exact ones first, then the finest."""
    best: dict[str, Outcome] = {}

    def rank(outcome: Outcome) -> tuple[bool, bool, float]:
        row = outcome.row
        return (np.isfinite(row.load_factor), np.isnan(row.P), row.n_elements)

    for outcome in outcomes:
        if not outcome.evidence.arrays or outcome.run.case.path is not None:
            continue  # A path has a separate picture.
        if outcome.row.coupling in FINDS_NONE:
            continue
        name = outcome.run.variant.name
        if name not in best or rank(outcome) > rank(best[name]):
            best[name] = outcome
    return best


def sweep_chart(case: Case, outcomes: Sequence[Outcome]) -> Chart | None:
    """Draw load factor against the parameter `case.sweep`; None with fewer than three values.

    It uses the largest family of variants that differ in nothing else.
    """
    families: dict[tuple[object, ...], list[Outcome]] = {}
    for outcome in outcomes:
        if outcome.row.coupling not in FINDS_NONE and case.sweep in outcome.run.variant.parameters:
            families.setdefault(_others(case, outcome), []).append(outcome)
    family = max(families.values(), key=lambda own: len(_swept(case, own)), default=[])
    values = _swept(case, family)
    if len(values) < 3:
        return None
    with styled():
        figure, axes = figure_axes()
        points, low, high = _reference_curve(case, family[0].run.variant, values)
        axes.plot(points, low, color=INK, lw=1.3, label="reference", zorder=1)
        if low != high:
            axes.plot(points, high, color=INK, lw=1.3, zorder=1)
            axes.fill_between(points, low, high, color=BAND, label="Coulomb load factors", zorder=0)
        tips = []
        for number, backend in enumerate(sorted({outcome.run.backend for outcome in family})):
            finest = _finest(family, backend)
            colour = SERIES[number % len(SERIES)]
            places = [float(outcome.run.variant.parameters[case.sweep]) for outcome in finest]
            axes.plot(
                places,
                [outcome.row.load_factor for outcome in finest],
                ls="none",
                marker=MARKERS[number % len(MARKERS)],
                ms=9 - 2.2 * (number % 3),
                mfc="none" if number % 3 == 0 else colour,
                mec=colour,
                mew=1.6,
                label=labelled(backend),
            )
            tips += [
                Tip(axes, place, outcome.row.load_factor, _words(case, outcome, place))
                for place, outcome in zip(places, finest, strict=True)
            ]
        axes.set_xlabel(case.sweep)
        axes.set_ylabel(f"load factor [{case.unit}]")
        legend(figure, axes)
    return Chart(figure, f"{case.title}: load factor and reference against {case.sweep}", tips)


def _words(case: Case, outcome: Outcome, place: float) -> str:
    row = outcome.row
    return (
        f"{row.backend}, {row.coupling}\n{case.sweep}: {place:g}\n"
        f"load factor: {row.load_factor:.7g}\nreference: {row.expected}"
    )


def _finest(outcomes: Sequence[Outcome], backend: str) -> list[Outcome]:
    """Return the finished outcome on the finest mesh of each variant, for one backend."""
    best: dict[str, Outcome] = {}
    for outcome in outcomes:
        name = outcome.run.variant.name
        if outcome.run.backend != backend or not np.isfinite(outcome.row.load_factor):
            continue
        if name not in best or outcome.row.n_elements > best[name].row.n_elements:
            best[name] = outcome
    return list(best.values())


def _others(case: Case, outcome: Outcome) -> tuple[object, ...]:
    """Return all parameters except the swept one."""
    parameters = outcome.run.variant.parameters
    return tuple(sorted((n, v) for n, v in parameters.items() if n != case.sweep))


def _swept(case: Case, outcomes: Sequence[Outcome]) -> list[float]:
    return sorted({float(outcome.run.variant.parameters[case.sweep]) for outcome in outcomes})


def _reference_curve(
    case: Case, variant: Variant, values: list[float]
) -> tuple[list[float], list[float], list[float]]:
    """Return places and ends of the references of variants, dense if there is a formula."""

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
