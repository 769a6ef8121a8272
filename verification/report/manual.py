"""The verification manual: a page for each case, and one that leads to them.

A page holds what is needed to check a case with pencil and paper, and what lacore found.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd

from verification.bracketing import BRACKET
from verification.case import KINDS, Case, Variant
from verification.checks import said
from verification.compare import tally
from verification.report import document
from verification.report.blocks import (
    Block,
    Column,
    Document,
    Facts,
    Gallery,
    Page,
    Pages,
    Picture,
    Preformatted,
    Section,
    Table,
    Text,
    slug,
)
from verification.report.description import counted, description, lead
from verification.report.figures import png
from verification.report.page import results_frame, results_of
from verification.report.tables import VERDICTS
from verification.run import Outcome
from verification.sketches import sketch_of

_NO_KIND = "others"
_BACK = Pages([Page("All cases", "index.html")])


def write(
    cases: Sequence[Case],
    outcomes: Sequence[Outcome],
    checks: pd.DataFrame,
    provenance: Mapping[str, str],
    folder: Path,
) -> Path:
    """Write ``index.html`` and a page for each case; returns the path of the first.

    Args:
        cases: in the order of the manual.
        outcomes: of any cases.
        checks: as `lacore verify` writes them; may have no rows.
        provenance: of the outcomes.
        folder: to write into.

    Raises:
        InputError: the folder cannot be written.
    """
    for case in cases:
        own = [outcome for outcome in outcomes if outcome.run.case.id == case.id]
        asked = checks[checks["case"] == case.id] if len(checks) else checks
        document.write(page_of(case, own, asked, provenance), folder / file_of(case))
    return document.write(contents(cases, outcomes, provenance), folder / "index.html")


def file_of(case: Case) -> str:
    """Name of the page of a case."""
    return f"case-{slug(case.id)}.html"


def contents(
    cases: Sequence[Case], outcomes: Sequence[Outcome], provenance: Mapping[str, str]
) -> Document:
    """The page that leads to all others, cases by kind."""
    sections = []
    for kind in (*KINDS, _NO_KIND):
        own = [case for case in cases if _kind(case) == kind]
        if own:
            pages = [Page(case.title, file_of(case), _standing(case, outcomes)) for case in own]
            sections.append(Section(f"kind-{kind}", kind.capitalize(), [Pages(pages)]))
    count = tally(outcomes)
    return Document(
        title="Verification manual",
        lead=f"{counted(len(cases), 'case')} with their references and how these are found by hand;"
        f" {counted(len(outcomes), 'run')}: {count.text}.",
        sections=[*sections, Section("machine", "Machine and versions", [Facts(provenance)])],
    )


def _kind(case: Case) -> str:
    """The first of its tags that is one of `KINDS`; cases of others need not have any."""
    return next((tag for tag in case.tags if tag in KINDS), _NO_KIND)


def _standing(case: Case, outcomes: Sequence[Outcome]) -> str:
    count = tally([outcome for outcome in outcomes if outcome.run.case.id == case.id])
    return f"{lead(case)} · {count.text}"


def page_of(
    case: Case, outcomes: Sequence[Outcome], checks: pd.DataFrame, provenance: Mapping[str, str]
) -> Document:
    """All that is to be said of a case; its outcomes and checks."""
    elements = {
        outcome.run.variant.name: int(outcome.row.n_elements)
        for outcome in sorted(outcomes, key=lambda outcome: outcome.row.n_elements)
        if outcome.row.n_elements == outcome.row.n_elements
        and outcome.row.coupling != BRACKET  # whose error is its width
    }
    sections = [
        Section("problem", "The problem", [_sketch(case)]),
        Section("theory", "Why it is so", [description(case, case.variants, elements)]),
        Section("settings", "Settings", [_variants_table(case), *_meshes(case)]),
    ]
    if len(checks):
        sections.append(Section("checks", "What was checked", [_checks_table(checks)]))
    if outcomes:
        blocks = results_of(case, outcomes, results_frame(outcomes))
        sections.append(Section("results", "What lacore found", blocks))
    sections += [
        Section("run", "Run it yourself", [_commands(case)]),
        Section("machine", "Machine and versions", [Facts(provenance)]),
    ]
    return Document(title=case.title, lead=lead(case), summary=[_BACK], sections=sections)


def _checks_table(checks: pd.DataFrame) -> Table:
    columns = (
        Column("verdict", moods=VERDICTS),
        *(Column(name) for name in ("check", "variant", "backend", "coupling", "meshes")),
        Column("measured", "measured", ".3g"),
        Column("allowed"),
        Column("why", long=True),
    )
    return Table(columns, checks)


def _sketch(case: Case) -> Block:
    """The problem of the first variant, drawn from its model; or why it cannot be."""
    variant = case.variants[0]
    caption = f"{variant.name}, drawn from the model"
    try:
        data = png(sketch_of(case, variant))
    except Exception as error:  # whatever others wrote: the rest of the page is there
        return Text(said(error), lead=f"{variant.name} cannot be drawn")
    return Gallery([Picture(f"sketch-{slug(case.id)}", caption, data)])


def _variants_table(case: Case) -> Table:
    names = list(dict.fromkeys(name for one in case.variants for name in one.parameters))
    columns = (Column("variant"), *(Column(name) for name in names), Column("reference"))
    rows = [
        {"variant": one.name, "reference": case.reference_of(one).text}
        | {name: _text(one, name) for name in names}
        for one in case.variants
    ]
    return Table(columns, pd.DataFrame(rows), caption=f"Reference in {case.unit}")


def _text(variant: Variant, name: str) -> str:
    value = variant.parameters.get(name, "")
    return f"{value:.7g}" if isinstance(value, float) else str(value)


def _meshes(case: Case) -> list[Block]:
    if not case.meshed:
        return [Text("Rigid blocks and frames are exact: there is no mesh.")]
    names = list(dict.fromkeys(name for size in case.meshes.values() for name in size))
    rows = [
        {"mesh": mesh} | {name: f"{size.get(name, '')}" for name in names}
        for mesh, size in case.meshes.items()
    ]
    blocks: list[Block] = [
        Table([Column("mesh"), *(Column(name) for name in names)], pd.DataFrame(rows))
    ]
    for variant in case.variants:
        order = case.order_of(variant)
        if order is not None:
            text = f"error ~ elements^-({order.expected:g} ± {order.tolerance:g}). {order.reason}"
            blocks.append(Text(text, lead=f"Order under refinement, {variant.name}"))
    stated = case.bracket
    if stated is not None:
        text = (
            f"At most {100 * stated.target_width:g} % wide, with at most {stated.max_elements}"
            f" elements a mesh, from the {case.bracketed_from} one. {stated.reason}"
        )
        blocks.append(Text(text.rstrip(), lead="Bracket"))
    return blocks


def _commands(case: Case) -> Preformatted:
    first = f"{case.id}:{case.variants[0].name}"
    lines = [f"lacore compare {case.id}", f"lacore verify {case.id}"]
    if case.sweep:
        values = sorted({float(one.parameters.get(case.sweep, "nan")) for one in case.variants})
        known = [value for value in values if value == value]
        lines.append(f"lacore sweep {first} --vary {case.sweep}={known[0]:g}:{known[-1]:g}:9")
    return Preformatted("\n".join(lines))
