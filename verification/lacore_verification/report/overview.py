"""Index of cases: a card per case, with its picture, and one result for each variant."""

from collections.abc import Mapping, Sequence
from math import isfinite
from typing import Any

import pandas as pd

from lacore_verification.case import Case
from lacore_verification.case.band import BRACKET
from lacore_verification.harness.analysis.summary import VariantSummary, summaries
from lacore_verification.harness.verdicts.words import FAIL, PASS
from lacore_verification.report.blocks import Card, Cards, Filters, PageLink, Picture, Table
from lacore_verification.report.columns import CERTIFICATE, Column, columns
from lacore_verification.report.description import lead
from lacore_verification.report.drawing import Drawn, Subject, thumbnail_of
from lacore_verification.runs.outcome import Outcome

_COLUMNS = columns(
    "variant",
    Column("proven", "proven bounds or value", link=CERTIFICATE, hover="told"),
    Column("expected", "reference"),
    Column("error", "error %", "+.3g", scale=100, order="size"),
    Column("allowed", "tolerance %", "+.3g", scale=100),
    Column("agree", "backends agreeing", order="agreeing"),
    Column("seconds", "solve time, s", ".1f"),
    "verdict",
)

ORDER = "failures, then largest errors"
_FEW = 4  # cards: fewer need no controls


def cards(
    cases: Sequence[Case],
    outcomes: Sequence[Outcome],
    files: Mapping[str, str],
    pictures: Mapping[str, Picture],
) -> Cards:
    """Return a card for each case: failures first, then the largest errors.

    Args:
        cases: cases to show.
        outcomes: outcomes of these cases, and of any others.
        files: files of the pages, by id of the case.
        pictures: available pictures, by id of the case.
    """
    ranks: dict[str, tuple[bool, float]] = {}
    for one in summaries(outcomes):
        ranks[one.case] = min(one.rank, ranks.get(one.case, one.rank))
    items = []
    for case in sorted(cases, key=lambda case: ranks.get(case.id, (True, 0.0))):
        own = [outcome for outcome in outcomes if outcome.run.case.id == case.id]
        table = answers(own)
        items.append(
            Card(
                PageLink(case.title, files[case.id], lead(case)),
                pictures.get(case.id),
                table,
                mood_of(verdicts := table.data["verdict"].tolist()),
                name=case.id,
                tags=case.tags,
                verdicts=list(dict.fromkeys(verdicts)),
                seconds=float(table.data["seconds"].sum()),
                runs=runs(own),
            )
        )
    return Cards(items)


def filters(*lists: Cards) -> list[Filters]:
    """Return the controls for all cards of a page; none for a few."""
    items = [card for cards in lists for card in cards.items]
    if len(items) < _FEW:
        return []
    tags = sorted({tag for card in items for tag in card.tags}, key=str.casefold)
    verdicts = dict.fromkeys(verdict for card in items for verdict in card.verdicts)
    solvers = {run.partition("\t")[0] for card in items for run in card.runs}
    return [Filters(tags, list(verdicts), ORDER, sorted(solvers))]


def runs(outcomes: Sequence[Outcome]) -> list[str]:
    """Return the different pairs of backend and verdict, with a tabulator in between."""
    rows = (outcome.row for outcome in outcomes)
    return list(dict.fromkeys(f"{row.backend}\t{row.verdict}" for row in rows))


def solver_filter(outcomes: Sequence[Outcome]) -> list[Filters]:
    """Return the choice of a solver for a page without cards; none for a single solver."""
    names = sorted({outcome.row.backend for outcome in outcomes})
    return [Filters([], [], "", names)] if len(names) > 1 else []


def mood_of(verdicts: Sequence[str]) -> str:
    """Return the mark of a case."""
    return "bad" if FAIL in verdicts else "good" if PASS in verdicts else "mild"


def answers(outcomes: Sequence[Outcome], *before: Column, sortable: bool = False) -> Table:
    """Return a row for each variant: failures first, then the largest errors."""
    rows = [_row(own, outcomes) for own in sorted(summaries(outcomes), key=_rank)]
    names = [*dict.fromkeys(["case", *(c.name for c in _COLUMNS), *_HIDDEN])]
    found = pd.DataFrame(rows, columns=names)
    shown = (*before, *_COLUMNS)
    return Table(shown, found, sortable=sortable, stacked=True, card="case" if before else "")


def _rank(summary: VariantSummary) -> tuple[bool, float]:
    return summary.rank


_HIDDEN = (CERTIFICATE.column, "told", "agreeing", "size")


def _row(summary: VariantSummary, outcomes: Sequence[Outcome]) -> dict[str, Any]:
    return {
        "case": summary.case,
        "variant": summary.variant,
        "proven": proven(summary),
        "expected": summary.expected,
        "error": 0.0 if summary.rounded else summary.error,
        "size": abs(summary.error),
        "allowed": summary.allowed,
        "agree": f"{summary.agreeing} of {summary.asked}",
        "agreeing": float(summary.agreeing),
        "seconds": summary.seconds,
        "verdict": summary.verdict,
        "told": _told(summary),
        CERTIFICATE.column: _proof(summary, outcomes),
    }


def proven(summary: VariantSummary) -> str:
    """Return the bracket, or the value of an exact backend, else the correct status."""
    low, high = isfinite(summary.lower), isfinite(summary.upper)
    if low and high:
        return f"[{summary.lower:.6g}, {summary.upper:.6g}]"
    if high and _bounds_tell_more(summary):
        return f"\N{LESS-THAN OR EQUAL TO} {summary.upper:.7g}"
    if low and _bounds_tell_more(summary):
        return f"\N{GREATER-THAN OR EQUAL TO} {summary.lower:.7g}"
    if isfinite(summary.value):
        return f"{summary.value:.7g}"
    return summary.expected if summary.verdict == PASS else ""


def _bounds_tell_more(summary: VariantSummary) -> bool:
    """Return whether there are both bounds, no value, or an upper one no looser than the value."""
    if isfinite(summary.lower) and isfinite(summary.upper):
        return True
    return not isfinite(summary.value) or summary.upper <= summary.value


def _told(summary: VariantSummary) -> str:
    """Return a text on the mesh of the number."""
    sizes = f"{summary.mesh} mesh, {summary.elements:g} elements" if summary.mesh else ""
    shown = summary.bounded and _bounds_tell_more(summary)
    bounds = f"bounds of the {summary.bounded} problem" if shown else ""
    return "; ".join(filter(None, (bounds, sizes and f"worst error: {sizes}")))


def _proof(summary: VariantSummary, outcomes: Sequence[Outcome]) -> str | None:
    """Return the run whose certificate proves the shown result."""
    own = [
        outcome
        for outcome in outcomes
        if (outcome.row.case, outcome.row.variant) == (summary.case, summary.variant)
        and outcome.evidence.residuals
    ]
    bounds = [o for o in own if o.row.lower == summary.lower or o.row.upper == summary.upper]
    bounds.sort(key=lambda outcome: outcome.row.coupling != BRACKET)
    values = [o for o in own if (o.row.mesh, o.row.load_factor) == (summary.mesh, summary.value)]
    found = [*bounds, *values] if _bounds_tell_more(summary) else values
    return next((outcome.run.key for outcome in found), None)


def first_thumbnail(subjects: Sequence[Subject], drawn: Drawn) -> Picture | None:
    """Find the first thumbnail of subjects that was drawn."""
    return next(filter(None, (thumbnail_of(one, drawn) for one in subjects)), None)
