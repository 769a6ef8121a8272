"""Verification manual: a page for each case, and an index.

A page contains what is needed to check a case with pencil and paper, and the results of lacore.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd

from lacore_verification.case import KINDS, Case, Variant
from lacore_verification.harness import progress
from lacore_verification.harness.store.store import file_of, sessions
from lacore_verification.harness.verdicts.words import tally
from lacore_verification.harness.verify import load_checks
from lacore_verification.report.blocks import (
    Block,
    Facts,
    Gallery,
    Page,
    PageLink,
    Picture,
    Preformatted,
    Report,
    Section,
    Table,
    Text,
)
from lacore_verification.report.columns import Column, columns
from lacore_verification.report.description import counted, lead
from lacore_verification.report.drawing import (
    Drawn,
    Subject,
    brackets,
    mechanisms,
    most_for,
    sketch,
)
from lacore_verification.report.files import INDEX, case_files, write
from lacore_verification.report.overview import answers, cards, filters, first_thumbnail
from lacore_verification.report.page import explained, results_frame, results_of
from lacore_verification.report.reporting import pictures_of
from lacore_verification.runs.outcome import Outcome

_NO_KIND = "others"
_UP = PageLink("All cases", INDEX)


def write_manual(
    cases: Sequence[Case],
    outcomes: Sequence[Outcome],
    results: Path,
    folder: Path,
    most: int | None = None,
) -> Path:
    """Draw and write the manual of cases; returns the path of its index.

    Args:
        cases: in the order of the manual.
        outcomes: of any cases.
        results: folder that they, and the checks of `lacore verify`, are from.
        folder, most: as of `write_report`.

    Raises:
        InputError: the folder cannot be written.
    """
    # The problem of each case is drawn, too.
    each = most_for(2 * len(cases)) if most is None else most
    about = list(sessions(file_of(results)).values())[-1]
    with pictures_of(subjects(cases, outcomes, each)) as drawn:
        found = manual(cases, outcomes, load_checks(results), about, drawn)
    with progress.status("writing the pages"):
        return write(found, folder)


def subjects(cases: Sequence[Case], outcomes: Sequence[Outcome], most: int) -> list[Subject]:
    """List the pictures of a manual.

    For each case its problem, and `most` mechanisms and brackets.
    """
    found: list[Subject] = []
    for case in cases:
        own = _of(case, outcomes)
        found += [sketch(case, own), *mechanisms(own, most), *brackets(own, most)]
    return found


def manual(
    cases: Sequence[Case],
    outcomes: Sequence[Outcome],
    checks: pd.DataFrame,
    provenance: Mapping[str, str],
    drawn: Drawn,
) -> Report:
    """Write the pages of a manual.

    Args:
        cases: in the order of the manual.
        outcomes: of any cases.
        checks: as `lacore verify` writes them; may have no rows.
        provenance: of the outcomes.
        drawn: pictures of its `subjects`.
    """
    files = case_files(case.id for case in cases)
    pages = {INDEX: _contents(cases, outcomes, provenance, files, drawn)}
    for case in cases:
        asked = checks[checks["case"] == case.id] if len(checks) else checks
        pages[files[case.id]] = page_of(case, _of(case, outcomes), asked, provenance, drawn)
    return Report(pages)


def _of(case: Case, outcomes: Sequence[Outcome]) -> list[Outcome]:
    return [outcome for outcome in outcomes if outcome.run.case.id == case.id]


def _contents(
    cases: Sequence[Case],
    outcomes: Sequence[Outcome],
    provenance: Mapping[str, str],
    files: Mapping[str, str],
    drawn: Drawn,
) -> Page:
    """Write the page that links to all others, with the cases by kind."""
    pictures = {}
    for case in cases:
        subjects = [*mechanisms(_of(case, outcomes), 1), sketch(case)]
        if small := first_thumbnail(subjects, drawn):
            pictures[case.id] = small
    sections, lists = [], []
    for kind in (*KINDS, _NO_KIND):
        own = [case for case in cases if _kind(case) == kind]
        if own:
            shown = cards(own, outcomes, files, pictures)
            lists.append(shown)
            sections.append(Section(f"kind-{kind}", kind.capitalize(), [shown]))
    count = tally(outcomes)
    return Page(
        title="Verification manual",
        lead=f"{counted(len(cases), 'case')} with reference values and hand calculations;"
        f" {counted(len(outcomes), 'run')}: {count.text}.",
        sections=[*sections, Section("machine", "Machine and versions", [Facts(provenance)])],
        summary=filters(*lists),
    )


def _kind(case: Case) -> str:
    """Return the first of its tags that is one of `KINDS`; users' cases need not have any."""
    return next((tag for tag in case.tags if tag in KINDS), _NO_KIND)


def page_of(
    case: Case,
    outcomes: Sequence[Outcome],
    checks: pd.DataFrame,
    provenance: Mapping[str, str],
    drawn: Drawn,
) -> Page:
    """Write the page of a case with its outcomes and checks."""
    sections = [
        Section("problem", "The problem", [_sketch(case, drawn)]),
        Section("theory", "Theory", [explained(case, outcomes)]),
        Section("settings", "Settings", [_variants_table(case), *_meshes(case)]),
    ]
    if len(checks):
        sections.append(Section("checks", "Checks", [_checks_table(checks)]))
    if outcomes:
        blocks = results_of(case, outcomes, results_frame(outcomes), drawn)
        sections.append(Section("results", "Results", blocks))
    sections += [
        Section("run", "Commands", [_commands(case)]),
        Section("machine", "Machine and versions", [Facts(provenance)]),
    ]
    found = [answers(outcomes)] if outcomes else []
    return Page(case.title, lead(case), sections, found, trail=[_UP])


def _checks_table(checks: pd.DataFrame) -> Table:
    names = ("verdict", "check", "variant", "backend", "coupling", "meshes")
    return Table(columns(*names, Column("measured", form=".3g"), "allowed", "why"), checks)


def _sketch(case: Case, drawn: Drawn) -> Block:
    """Return the problem of the first variant, or say why it cannot be drawn."""
    found = drawn[sketch(case).name]
    return Gallery([found]) if isinstance(found, Picture) else found


def _variants_table(case: Case) -> Table:
    names = list(dict.fromkeys(name for one in case.variants for name in one.parameters))
    rows = [
        {"variant": one.name, "reference": case.reference_of(one).text}
        | {name: _text(one, name) for name in names}
        for one in case.variants
    ]
    shown = columns("variant", *map(Column, names), "reference")
    return Table(shown, pd.DataFrame(rows), caption=f"Reference values in {case.unit}")


def _text(variant: Variant, name: str) -> str:
    value = variant.parameters.get(name, "")
    return f"{value:.7g}" if isinstance(value, float) else str(value)


def _meshes(case: Case) -> list[Block]:
    if not case.meshed:
        return [Text("Rigid blocks and frames need no mesh; their discrete problem is exact.")]
    names = list(dict.fromkeys(name for size in case.meshes.values() for name in size))
    rows = [
        {"mesh": mesh} | {name: f"{size.get(name, '')}" for name in names}
        for mesh, size in case.meshes.items()
    ]
    blocks: list[Block] = [Table(columns("mesh", *map(Column, names)), pd.DataFrame(rows))]
    for variant in case.variants:
        order = case.order_of(variant)
        if order is not None:
            text = f"error ~ elements^-({order.expected:g} ± {order.tolerance:g}). {order.reason}"
            blocks.append(Text(text, lead=f"Order of convergence, {variant.name}"))
    stated = case.bracket
    if stated is not None:
        text = (
            f"Target width {100 * stated.target_width:g} %, at most {stated.max_elements} elements"
            f" per mesh, starting from the {case.bracketed_from} mesh. {stated.reason}"
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
