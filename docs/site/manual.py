"""Pages of the verification manual: one page per case, and the tables that lead to them."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import inf, isfinite, nan

from lacore.bounds.enclosing import has_coulomb
from lacore_verification.case import KINDS, Case
from lacore_verification.case.band import BRACKET
from lacore_verification.harness.analysis.summary import VariantSummary, summaries
from lacore_verification.harness.verdicts.bracket import STRICT
from lacore_verification.harness.verdicts.words import PASS
from lacore_verification.report.blocks import Block, Columns, Details, Facts, Preformatted, Section
from lacore_verification.report.drawing import Drawn
from lacore_verification.report.manual import page_of
from lacore_verification.report.overview import proven
from lacore_verification.runs.row import Row
from myst import Writer, escaped
from pictures import enclosed, mechanism
from results import Results

_MACHINE = "machine"
INDEX = "manual/index.md"


def page(case: Case, results: Results, drawn: Drawn) -> str:
    """Return the page of a case."""
    outcomes = [own for own in results.outcomes if own.run.case.id == case.id]
    checks = results.checks
    asked = checks[checks["case"] == case.id] if len(checks) else checks
    document = page_of(case, outcomes, asked, {}, drawn)
    write = Writer({name: f"../pictures/{name}.png" for name in drawn})
    parts = [f"# {document.title}", escaped(document.lead), write.page(document.summary)]
    sketches = [block for block in _every(document.sections) if _is_sketch(block)]
    for section in document.sections:
        if section.id == _MACHINE:
            continue
        blocks = [*_without_sketches(section.blocks)]
        if section.id == "problem":
            blocks += _moving(case, drawn)
            blocks += [Details("Sketch as text", sketches)] if sketches else []
        bracketed = enclosed(case, outcomes)
        if section.id == "results" and bracketed is not None and bracketed.name in drawn:
            blocks = [drawn[bracketed.name], *blocks]
        parts += [f"## {section.title}", write.page(blocks)]
    if not outcomes:
        parts.append(
            "This case is newer than the committed results."
            f" Run `lacore verify {case.id}` to solve it."
        )
    return "\n\n".join(parts) + "\n"


def _moving(case: Case, drawn: Drawn) -> Iterator[Block]:
    found = drawn.get(mechanism(case).name)
    if found is not None:
        yield found


def _every(sections: Sequence[Section]) -> Iterator[Block]:
    for section in sections:
        for block in section.blocks:
            yield from block.left if isinstance(block, Columns) else (block,)


def _is_sketch(block: Block) -> bool:
    return isinstance(block, Preformatted) and bool(block.sketch)


def _without_sketches(blocks: Sequence[Block]) -> Iterator[Block]:
    for block in blocks:
        if isinstance(block, Columns):
            left = [one for one in block.left if not _is_sketch(one)]
            yield replace(block, left=left)
        else:
            yield block


def index(cases: Sequence[Case], results: Results) -> str:
    """Return the page with the table of all cases, and the machine and versions of the results."""
    rows = {(one.case, one.variant): one for one in summaries(results.outcomes)}
    parts = [
        "# Verification manual",
        "Each case has a page with the problem, the hand calculation, the reference with its"
        " source, the results of every solver, and the reason for the error that is allowed."
        " `lacore verify` computes all results again.",
        f"[{_EXCLUDED}](excluded.md)",
    ]
    for kind in (*KINDS, ""):
        own = [case for case in cases if _kind(case) == kind]
        if own:
            parts += [f"## {(kind or 'others').capitalize()}", _front(own, rows)]
    parts += ["## Machine and versions", "The results in these tables were computed with:"]
    for runs, provenance in results.provenances.items():
        parts += [f"### {runs}", Writer({}).block(Facts(provenance))]
    contents = [":::{toctree}", ":hidden:", *(case.id for case in cases), "excluded", ":::"]
    return "\n\n".join([*parts, "\n".join(contents)]) + "\n"


def _kind(case: Case) -> str:
    return next((tag for tag in case.tags if tag in KINDS), "")


def _front(cases: Sequence[Case], rows: Mapping[tuple[str, str], VariantSummary]) -> str:
    lines = [
        "| case | variant | reference | lacore | width of the bracket | verdict |",
        "|---|---|---|---|--:|---|",
    ]
    for case in cases:
        found = [rows[case.id, one.name] for one in case.variants if (case.id, one.name) in rows]
        for number, own in enumerate(found[:_MOST]):
            name = "" if number else f"[{escaped(case.title)}]({case.id}.md)"
            cells = (name, own.variant, own.expected, proven(own), _width(own), own.verdict)
            lines.append("| " + " | ".join([cells[0], *map(escaped, cells[1:])]) + " |")
        if len(found) > _MOST:
            lines.append(f"| | [and {len(found) - _MOST} more]({case.id}.md) | | | | |")
        if not found:
            lines.append(f"| [{escaped(case.title)}]({case.id}.md) | | | | | not run yet |")
    return "\n".join(lines)


_MOST = 8
"""Largest number of variants of a case in the table of all cases."""


def _width(own: VariantSummary) -> str:
    """Return the width of a bracket relative to its mean, in per cent; empty without a bracket."""
    if not (isfinite(own.lower) and isfinite(own.upper)):
        return ""
    mean = (abs(own.upper) + abs(own.lower)) / 2
    share = (own.upper - own.lower) / mean if mean else nan
    if share < _LEAST_WIDTH:
        return f"< {100 * _LEAST_WIDTH:g} %"
    return f"{100 * share:.2g} %" if mean else ""


_LEAST_WIDTH = 1e-4
"""Smallest width that is shown: a narrower bracket is an exact solution with round-off."""


def excluded(cases: Sequence[Case], results: Results) -> str:
    """Return the page that lists references outside of proven bounds, and all that were compared.

    With Coulomb friction only the upper bound of associated friction is proven (T14).

    Raises:
        ValueError: No case has proven bounds.
    """
    compared = list(_compared(cases, results))
    if not compared:
        raise ValueError("no case has proven bounds that references can be compared with")
    rows = [_held(one) for one in compared if _is_outside(one)]
    head = (
        f"# {_EXCLUDED}\n\nThis page compares the reference of each case, and other published or"
        " analytical values for it, with the bounds that are proven for the same problem. A value"
        " is outside if it differs from the bounds by more than its own uncertainty and the"
        " tolerance of the certificate. With Coulomb friction, no load factor is above that of"
        " associated friction (T14), and no lower bound is proven.\n\n"
    )
    counted = f"{len(compared)} values were compared with proven bounds. "
    verb = "lies" if len(rows) == 1 else "lie"
    said = f"{len(rows)} {verb} outside:\n\n{_listed(rows)}" if rows else "**None lies outside.**\n"
    return f"{head}{counted}{said}\n## All that were compared\n\n{_listed(map(_held, compared))}"


def _listed(rows: Iterable[Sequence[str]]) -> str:
    lines = [
        "| case | variant | source | value | proven bounds | computed by |",
        "|---|---|---|---|---|---|",
    ]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)]) + "\n"


_EXCLUDED = "References outside of proven bounds"
_ROUND_OFF = 1e-6
"""Relative tolerance of a certificate."""


Told = tuple[Case, str, str, float, float]


def _told(cases: Sequence[Case]) -> Iterator[Told]:
    """Yield case, variant, source and the ends of each published or analytical value."""
    for case in cases:
        for variant in case.variants:
            one = case.reference_of(variant)
            if isfinite(one.low) and isfinite(one.high):
                yield case, variant.name, one.source, one.low, one.high
            for other in case.beside_of(variant):
                if not other.name.endswith(("at least", "at most")):
                    ends = other.value - other.half_width, other.value + other.half_width
                    yield case, variant.name, f"{other.name}: {other.source}", *ends


def _compared(cases: Sequence[Case], results: Results) -> Iterator[tuple[Told, Row]]:
    """Yield each value of a variant with the run that proves strict bounds for it."""
    proofs = {
        (own.row.case, own.row.variant): own.row
        for own in results.outcomes
        if own.row.coupling == BRACKET and own.row.rigor == STRICT and own.row.verdict == PASS
    }
    for told in _told(cases):
        row = proofs.get((told[0].id, told[1]))
        if row is not None:
            yield told, row if _is_of_both_sides(told[0], told[1]) else replace(row, lower=-inf)


def _is_of_both_sides(case: Case, name: str) -> bool:
    """Return whether both bounds hold: with Coulomb friction only the upper one does."""
    (variant,) = (one for one in case.variants if one.name == name)
    return not has_coulomb(case.problem(variant, case.bracketed_from))


def _is_outside(compared: tuple[Told, Row]) -> bool:
    (*_, low, high), row = compared
    slack = _ROUND_OFF * max(abs(end) for end in (row.lower, row.upper) if isfinite(end))
    return high < row.lower - slack or low > row.upper + slack


def _held(compared: tuple[Told, Row]) -> tuple[str, ...]:
    """Return a row: a value, and the bounds that are proven for it."""
    (case, variant, who, low, high), row = compared
    value = f"{low:.7g}" if low == high else f"[{low:.7g}, {high:.7g}]"
    bounds, size = f"<= {row.upper:.7g}", f"{row.n_elements:g} elements"
    if isfinite(row.lower):
        bounds = f"[{row.lower:.7g}, {row.upper:.7g}]"
        size = f"{row.n_elements_lower:g} elements for the lower bound"
        size += f", {row.n_elements:g} for the upper"
    by = f"{row.backend}, {size}"
    return f"[{escaped(case.title)}]({case.id}.md)", variant, escaped(who), value, bounds, by
