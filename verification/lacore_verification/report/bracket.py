"""Brackets on a page: bounds and reference, history, and gap by elements."""

from collections.abc import Sequence
from dataclasses import asdict

import numpy as np
import pandas as pd

from lacore_verification.case.band import BRACKET
from lacore_verification.harness.analysis.slope_fits import fit_slope
from lacore_verification.report.blocks import Drawing, Table
from lacore_verification.report.charts.axes import ELEMENTS, Axis, fitted
from lacore_verification.report.columns import CERTIFICATE, RUN, Column, column, columns
from lacore_verification.report.tables import with_certificates
from lacore_verification.runs.outcome import Outcome

_WIDTH = Axis("width", "(upper − lower)/mean")
_CLOSE = 0.05  # Widths above it do not show the order yet.
_FEWEST = 5  # number of widths for the fit of an order
_ANY = 100.0  # Bounds improve in steps, so their local slopes are arbitrary.


def brackets_table(results: pd.DataFrame) -> Table:
    """Return the proven bounds and the reference between them."""
    shown = columns(
        *(column("verdict", hover="why"), "variant", "backend"),
        Column("lower", "lower bound", ".7f", link=CERTIFICATE),
        "expected",
        Column("upper", "upper bound", ".7f"),
        *("width", "rigor"),
        Column("n_elements_lower", "elements, lower", ".0f"),
        column("n_elements", title="elements, upper"),
        column("outer_iterations", title="solves"),
        "solve_time",
    )
    return Table(shown, with_certificates(results), anchor=RUN, caption="Lower and upper bounds")


def widths(outcome: Outcome) -> pd.DataFrame:
    """Return the width and the mean number of elements, a row per solve, once both bounds exist."""
    rows, last = [], {"lower": 0, "upper": 0}
    for step in outcome.evidence.history:
        last[step["bound"]] = step["elements"]
        rows.append({"n_elements": sum(last.values()) / 2, "width": step["width"]})
    frame = pd.DataFrame(rows, columns=["n_elements", "width"])
    frame["line"] = outcome.run.variant.name
    known: pd.DataFrame = frame[np.isfinite(frame["width"])]
    return known


def widths_chart(outcomes: Sequence[Outcome]) -> Drawing | None:
    """Draw the width against elements, with its order where enough brackets are narrow."""
    found = [o for o in outcomes if o.row.coupling == BRACKET and o.evidence.history]
    frames, fits = [], []
    for outcome in {one.run.variant.name: one for one in found}.values():
        frame = widths(outcome)
        close = frame[frame["width"] < _CLOSE]
        if len(close) < _FEWEST:
            continue
        frames.append(frame)
        fit = fit_slope(
            close["n_elements"].to_numpy(dtype=float),
            close["width"].to_numpy(dtype=float),
            fewest=_FEWEST,
            agreement=_ANY,
        )
        fits.append({"line": outcome.run.variant.name, **asdict(fit)})
    if not frames:
        return None
    chart = fitted(pd.concat(frames), pd.DataFrame(fits), ELEMENTS, _WIDTH, by="line")
    return Drawing(
        f"{found[0].run.case.id}-widths",
        "Width of the bracket against the mean number of elements of both meshes (slope under"
        " uniform refinement: −0.5)",
        chart,
    )
