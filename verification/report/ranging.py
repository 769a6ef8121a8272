"""Ranges of load factors on a page, and their comparison with other values."""

from collections.abc import Iterator, Sequence
from math import isfinite, nan
from typing import Any

import pandas as pd

from verification.case import Case, Variant
from verification.case.beside import RANGE
from verification.report.blocks import Block, Table
from verification.report.columns import Column
from verification.report.tables import CERTIFICATE, HOW, RUN, VERDICTS, with_certificates
from verification.runs.outcome import Outcome
from verification.runs.row import Row


def ranges_table(results: pd.DataFrame) -> Table:
    """Return the lowest and the highest certified load factors, and the bound of all of them."""
    columns = (
        Column("verdict", moods=VERDICTS, hover="why"),
        Column("variant"),
        Column("backend"),
        Column("lowest", "lowest found", ".6f", link=CERTIFICATE),
        Column("highest", "highest found", ".6f"),
        Column("upper", "proven upper bound", ".6f"),
        Column("gap", "largest gap", ".1e"),
        HOW[0],
        Column("n_elements", "elements", ".0f"),
        Column("outer_iterations", "inner solves", ".0f"),
        Column("solve_time", "solve time, s", ".2f"),
    )
    caption = "Found by searches from several starting points; lower or higher ones may exist"
    return Table(columns, with_certificates(results), anchor=RUN, caption=caption)


def beside_table(case: Case, outcomes: Sequence[Outcome]) -> list[Block]:
    """Compare other values of each variant with those certified on one mesh; empty without any.

    Coarse meshes overestimate all load factors, so that shares of the associated one are compared.
    """
    ranges = {o.run.variant.name: o.row for o in outcomes if o.row.coupling == RANGE}
    ran = {outcome.run.variant.name for outcome in outcomes}
    rows = [
        {"variant": variant.name, **row}
        for variant in case.variants
        if variant.name in ran
        for row in (*_of_mesh(ranges.get(variant.name)), *_of_others(case, variant))
    ]
    if not rows:
        return []
    columns = (
        Column("variant"),
        Column("what", "result or source"),
        Column("value", "load factor", ".5g"),
        Column("share", "share of associated, %", ".1f", scale=100),
        Column("source", long=True),
    )
    return [
        Table(
            columns,
            pd.DataFrame(rows),
            caption="Comparison with other methods and published values",
            sortable=False,
        )
    ]


def _of_mesh(row: Row | None) -> Iterator[dict[str, Any]]:
    """Yield the results of a range, on its mesh."""
    if row is None or not (isfinite(row.lowest) and isfinite(row.highest)):
        return
    found = (
        ("lowest state found", row.lowest, "certified"),
        ("highest state found", row.highest, "certified"),
        (
            "associated flow on the same mesh",
            row.upper,
            "upper bound of all states on this mesh (T54)",
        ),
        ("Davis's reduced strength on the same mesh", row.davis, "not a bound (T55)"),
    )
    for what, value, worth in found:
        if isfinite(value):
            source = f"{worth}; {row.mesh} mesh, {row.n_elements:g} elements"
            yield {"what": what, "value": value, "share": value / row.upper, "source": source}


def _of_others(case: Case, variant: Variant) -> Iterator[dict[str, Any]]:
    whole = case.reference_of(variant).associated
    for one in case.beside_of(variant):
        share = nan if whole is None else one.value / whole
        yield {"what": one.name, "value": one.value, "share": share, "source": one.source}
