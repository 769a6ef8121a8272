"""The report of a comparison: an index with a row per variant, and a page for each case."""

import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

import pandas as pd

from lacore_verification.case import EXACT, SOLVER, Case
from lacore_verification.case.band import BRACKET
from lacore_verification.case.case import RANGE
from lacore_verification.harness.analysis.settings import settings
from lacore_verification.harness.store.provenance import PROVENANCE
from lacore_verification.harness.store.results import RESULTS, as_table
from lacore_verification.harness.store.spreadsheets import quoted
from lacore_verification.harness.verdicts.limit_state import STRONG
from lacore_verification.harness.verdicts.words import (
    BOUND_ONLY,
    FAIL,
    NO_REFERENCE,
    NO_RESULT,
    tally,
)
from lacore_verification.harness.verdicts.words import Tally as Verdicts
from lacore_verification.report import document
from lacore_verification.report.blocks import (
    Block,
    Count,
    Details,
    Drawing,
    Facts,
    Gallery,
    Heading,
    Html,
    Link,
    Links,
    Page,
    PageLink,
    PageLinks,
    Picture,
    Report,
    Section,
    Tally,
    Text,
)
from lacore_verification.report.charts.figures import sweep_chart
from lacore_verification.report.columns import RUN, Column
from lacore_verification.report.description import counted, description, lead
from lacore_verification.report.drawing import Drawn, Subject, brackets, mechanisms, sketch
from lacore_verification.report.files import INDEX, case_files
from lacore_verification.report.measurement import noise_section, settings_section
from lacore_verification.report.overview import (
    answers,
    cards,
    filters,
    first_thumbnail,
    solver_filter,
)
from lacore_verification.report.tables import (
    beside_table,
    certificates_table,
    commands,
    couplings_table,
    ranges_table,
    reasons_table,
    results_table,
    times_table,
    with_programs,
)
from lacore_verification.runs.commands import INSTANCES, commands_of
from lacore_verification.runs.outcome import Outcome

SETTINGS = "settings.csv"
"""Table of the options of all backends, in the folder of a report."""
_SHOWN = 8
"""Lines of a list that are shown; the others are in a fold."""


@dataclass(frozen=True)
class CaseResults:
    """A case with its outcomes and results."""

    case: Case
    outcomes: Sequence[Outcome]
    results: pd.DataFrame


def by_case(outcomes: Sequence[Outcome], results: pd.DataFrame) -> list[CaseResults]:
    """Group outcomes, and the rows of their `results_frame`, by case, in their order."""
    places: dict[str, list[int]] = {}
    for index, outcome in enumerate(outcomes):
        places.setdefault(outcome.run.case.id, []).append(index)
    return [
        CaseResults(outcomes[own[0]].run.case, [outcomes[n] for n in own], results.iloc[own])
        for own in places.values()
    ]


def subjects(outcomes: Sequence[Outcome], most: int) -> list[Subject]:
    """List the pictures of a report: `most` mechanisms and brackets per case, or its problem."""
    groups: dict[str, list[Outcome]] = {}
    for outcome in outcomes:
        groups.setdefault(outcome.run.case.id, []).append(outcome)
    found: list[Subject] = []
    for own in groups.values():
        drawn = [*mechanisms(own, most), *brackets(own, most)]
        found += drawn or [sketch(own[0].run.case, own)]
    return found


def comparison_report(
    outcomes: Sequence[Outcome],
    machine: Mapping[str, str],
    drawn: Drawn,
    title: str = "Collapse loads compared with reference values",
    programs: Collection[str] = (),
) -> Report:
    """Write the report of outcomes, with the pictures of its `subjects` and links to programs."""
    results = results_frame(outcomes)
    own = by_case(outcomes, with_programs(results, programs))
    files = case_files(one.case.id for one in own)
    found, side_by_side = _studies(results)
    pages = {f"studies/{section.id}.html": section for section in found}
    # Pages are in the order in which their pictures are drawn; the index shows all of them.
    own_pages = {
        files[one.case.id]: _page(one, drawn, _trail(own, n, files)) for n, one in enumerate(own)
    }
    index = _index(outcomes, own, files, drawn)
    sections = [*index, *side_by_side, *_appendices(outcomes, results, pages, machine, programs)]
    return Report(
        {INDEX: Page(title, _lead(outcomes, own), sections, list(_summary(outcomes)))}
        | own_pages
        | {
            file: Page(section.title, section.lead, [section], solver_filter(outcomes), trail=[_UP])
            for file, section in pages.items()
        },
        {
            # A spreadsheet must show text that looks like a formula as text.
            RESULTS: quoted(results.drop(columns="run")).to_csv(index=False),
            SETTINGS: quoted(settings(own.run for own in outcomes)).to_csv(index=False),
            PROVENANCE: json.dumps(dict(machine), indent=1) + "\n",
        },
    )


_UP = PageLink("All cases", INDEX)


def _studies(results: pd.DataFrame) -> tuple[list[Section], list[Section]]:
    """Return studies, and the comparison of backends, if a problem was solved in several ways."""
    varied = [name for name in results if name == "param_steps" or str(name).startswith("option_")]
    ways = results[["mesh", "backend", "coupling", *varied]]
    if not (ways.nunique() > 1).any():
        return [], []
    from lacore_verification.report.studies.sections import solvers, studies

    side_by_side = solvers(results)
    return studies(results), [] if side_by_side is None else [side_by_side]


def _lead(outcomes: Sequence[Outcome], own: Sequence[CaseResults]) -> str:
    seconds = sum(o.row.solve_time for o in outcomes if isfinite(o.row.solve_time))
    return (
        f"{counted(len(own), 'case')}, {counted(len(outcomes), 'run')}, {seconds:.0f} s of"
        " solve time. Each load factor links to its certificate: residuals that are recomputed from"
        " velocities, stresses and reactions."
    )


def _index(
    outcomes: Sequence[Outcome],
    own: Sequence[CaseResults],
    files: Mapping[str, str],
    drawn: Drawn,
) -> list[Section]:
    cases = [one.case for one in own]
    pictures = {one.case.id: picture for one in own if (picture := _picture(one, drawn))}
    shown = cards(cases, outcomes, files, pictures)
    return [
        Section(
            "cases",
            "Cases",
            [
                *filters(shown),
                shown,
                Details(
                    "All cases in one table", [answers(outcomes, Column("case"), sortable=True)]
                ),
            ],
            "Failures come first, then the largest errors. The error is the worst one of exact"
            " backends on their finest mesh, or of the farther end of a bracket.",
        ),
    ]


def _picture(own: CaseResults, drawn: Drawn) -> Picture | None:
    subjects = [*mechanisms(own.outcomes, 1), *brackets(own.outcomes, 1), sketch(own.case)]
    return first_thumbnail(subjects, drawn)


def _appendices(
    outcomes: Sequence[Outcome],
    results: pd.DataFrame,
    pages: Mapping[str, Section],
    machine: Mapping[str, str],
    programs: Collection[str],
) -> list[Section]:
    links = [PageLink(section.title, file) for file, section in pages.items()]
    return [
        *([Section("studies", "Studies", [PageLinks(links)])] if links else []),
        Section("couplings", "Couplings and backends", [couplings_table(results)]),
        settings_section(outcome.run for outcome in outcomes),
        noise_section(results),
        Section("verdicts", "How a verdict is reached", [Details("Rules", [_rules()])]),
        Section("machine", "Machine and versions", [Facts(machine)]),
        Section("downloads", "Downloads", [_downloads(programs)]),
    ]


def _downloads(programs: Collection[str]) -> PageLinks:
    """Link the files with all runs, and the index of programs if there are any."""
    index = f"{INSTANCES}/index.csv"
    minima = [PageLink(index, index, "Minima and checksums of the programs.")]
    return PageLinks(
        [
            PageLink(
                "results.csv", RESULTS, "All runs, with settings, residuals, times and verdicts."
            ),
            PageLink("settings.csv", SETTINGS, "All options of the backends, with their defaults."),
            PageLink(
                "provenance.json",
                PROVENANCE,
                "Machine, date and versions, for lacore history. Each table of the report also"
                " links to its CSV file.",
            ),
            *(minima if programs else []),
        ]
    )


def _trail(own: Sequence[CaseResults], number: int, files: Mapping[str, str]) -> list[PageLink]:
    """Link the index, and the cases before and after."""
    near = [(number - 1, "\N{LEFTWARDS ARROW} {}"), (number + 1, "{} \N{RIGHTWARDS ARROW}")]
    return [
        _UP,
        *(
            PageLink(words.format(own[n].case.title), files[own[n].case.id])
            for n, words in near
            if 0 <= n < len(own)
        ),
    ]


def results_frame(outcomes: Sequence[Outcome]) -> pd.DataFrame:
    """Return outcomes as the table that a store would return."""
    return as_table(
        outcome.record() | {"run": outcome.run.key} | commands_of(outcome.run)
        for outcome in outcomes
    )


def _summary(outcomes: Sequence[Outcome]) -> Iterator[Block]:
    yield _tally(tally(outcomes))
    for verdict, title in ((FAIL, "Failures"), (NO_RESULT, "Runs without a result")):
        links = [
            Link(outcome.run.label, RUN.of({"run": outcome.run.key}), outcome.row.why)
            for outcome in outcomes
            if outcome.row.verdict == verdict
        ]
        if links:
            yield Heading(title)
            yield Links(links[:_SHOWN])
        if links[_SHOWN:]:
            yield Details(f"and {len(links) - _SHOWN} more", [Links(links[_SHOWN:])])


def _tally(count: Verdicts) -> Tally:
    counts = [
        Count(count.passed, "pass", "good"),
        Count(count.failed, "FAIL", "bad" if count.failed else "mild"),
        Count(count.skipped, "skipped"),
    ]
    rare = [
        Count(count.bound_only, BOUND_ONLY),
        Count(count.no_result, NO_RESULT),
        Count(count.no_reference, NO_REFERENCE),
    ]
    return Tally(counts + [own for own in rare if own.number])


def _page(own: CaseResults, drawn: Drawn, trail: Sequence[PageLink]) -> Page:
    """Write the page of a case."""
    results = [
        *solver_filter(own.outcomes),
        *results_of(own.case, own.outcomes, own.results, drawn),
    ]
    return Page(
        own.case.title,
        lead(own.case),
        [
            Section("results", "Results", results),
            Section("case", "The case", [*_sketch(own, drawn), explained(own.case, own.outcomes)]),
        ],
        [answers(own.outcomes)],
        trail,
    )


def _sketch(own: CaseResults, drawn: Drawn) -> Iterator[Gallery]:
    """Yield the sketch of the problem, if it was drawn in place of a mechanism."""
    found = drawn.get(sketch(own.case).name)
    if isinstance(found, Picture):
        yield Gallery([found])


def explained(case: Case, outcomes: Sequence[Outcome]) -> Block:
    """Describe a case, with the tolerances on the finest mesh of each variant that was run."""
    variants = {outcome.run.variant.name: outcome.run.variant for outcome in outcomes}
    elements: dict[str, int] = {}
    for outcome in outcomes:
        name, size = outcome.run.variant.name, outcome.row.n_elements
        if isfinite(size) and outcome.row.coupling != BRACKET:  # Its error is its width.
            elements[name] = max(int(size), elements.get(name, 0))
    return description(case, list(variants.values()) or case.variants, elements)


def results_of(
    case: Case, outcomes: Sequence[Outcome], results: pd.DataFrame, drawn: Drawn
) -> list[Block]:
    """Show the results of a case: mechanisms, charts, runs, reasons and certificates."""
    proven, ranges = results["coupling"] == BRACKET, results["coupling"] == RANGE
    blocks: list[Block] = []
    if proven.any():
        from lacore_verification.report.bracket import brackets_table  # not imported for other runs

        blocks.append(brackets_table(results[proven]))
    if ranges.any():
        blocks.append(ranges_table(results[ranges]))
    blocks += beside_table(case, outcomes)
    if not (proven | ranges).all():
        blocks.append(results_table(results[~(proven | ranges)]))
        blocks.append(Details("Times", [times_table(results[~(proven | ranges)])]))
    if case.path is not None:
        from lacore_verification.report.path import paths_table  # not imported for other cases

        blocks.append(paths_table(results))
    blocks.append(Details("Reasons for the verdicts", [reasons_table(results)]))
    certificates = certificates_table(results)
    if len(certificates.data):
        title = "Certificates: residuals recomputed from velocities, stresses, reactions and loads"
        blocks.append(Details(title, [certificates]))
    blocks.append(
        Details("Commands that repeat each run and export its program", commands(results))
    )
    return [*_seen(case, outcomes, drawn), *blocks]


def _seen(case: Case, outcomes: Sequence[Outcome], drawn: Drawn) -> Iterator[Block]:
    """Yield pictures and charts, then notes on those that cannot be drawn, or are not yet."""
    every = [*mechanisms(outcomes, len(outcomes)), *brackets(outcomes, len(outcomes))]
    found = [drawn[subject.name] for subject in every if subject.name in drawn]
    pictures = [item for item in found if isinstance(item, Picture)]
    yield Gallery([*pictures[:1], *_charts(case, outcomes), *pictures[1:]])
    yield from (item for item in found if isinstance(item, Text))
    yield from _not_drawn([subject for subject in every if subject.name not in drawn])


def _not_drawn(left: Sequence[Subject]) -> Iterator[Text]:
    if left:
        names = "; ".join(subject.caption for subject in left)
        yield Text(
            f"Not drawn yet: {names}. The command lacore report DIR --pictures"
            f" {len(left)} draws them, in about a second each.",
            soft=True,
        )


def _charts(case: Case, outcomes: Sequence[Outcome]) -> Iterator[Drawing]:
    chart = sweep_chart(case, outcomes) if case.sweep else None
    if chart is not None:
        text = f"Load factor against {case.sweep}, finest mesh of each backend"
        yield Drawing(f"{case.id}-sweep", text, chart)
    if case.path is not None:
        from lacore_verification.report.path import path_chart  # not imported for other cases

        paths = path_chart(case, outcomes)
        if paths is not None:
            yield paths
    if any(outcome.row.coupling == BRACKET for outcome in outcomes):
        from lacore_verification.report.bracket import widths_chart  # not imported for other runs

        widths = widths_chart(outcomes)
        if widths is not None:
            yield widths


def _rules() -> Html:
    return Html(document.fragment("verdicts.html.j2", solver=SOLVER, exact=EXACT, strong=STRONG))
