"""The page of a comparison: what came out, and every case explained beside its numbers."""

from collections.abc import Iterator, Mapping, Sequence
from math import isfinite, isnan, nan

import pandas as pd

from verification.bracketing import BRACKET
from verification.case import EXACT, SOLVER, Case
from verification.checks import said
from verification.compare import Tally as Verdicts
from verification.compare import efforts, tally
from verification.evidence import restored
from verification.judging import FAIL, NO_REFERENCE, NO_RESULT, STRONG
from verification.report import document
from verification.report.blocks import (
    Anchor,
    Block,
    Column,
    Count,
    Details,
    Document,
    Drawing,
    Facts,
    Gallery,
    Heading,
    Html,
    Link,
    Links,
    Picture,
    Section,
    Table,
    Tally,
    Text,
    slug,
)
from verification.report.brackets import bracket_drawings, brackets_table
from verification.report.description import counted, description, lead
from verification.report.figures import finest_exact, png, sweep_chart
from verification.report.paths import path_chart, paths_table
from verification.report.studies import studies
from verification.report.tables import (
    RUN,
    certificates_table,
    reasons_table,
    results_table,
)
from verification.results import as_table
from verification.run import Outcome

MECHANISMS = 4
"""Pictures of a case; variants that failed come first."""


def compared(
    outcomes: Sequence[Outcome],
    machine: Mapping[str, str],
    title: str = "Plastic collapse loads compared with references",
) -> Document:
    """The page of outcomes, in their order."""
    results = results_frame(outcomes)
    by_case: dict[str, list[int]] = {}
    for index, outcome in enumerate(outcomes):
        by_case.setdefault(outcome.run.case.id, []).append(index)
    cases = [
        (outcomes[own[0]].run.case, [outcomes[n] for n in own], results.iloc[own])
        for own in by_case.values()
    ]
    seconds = sum(o.row.solve_time for o in outcomes if isfinite(o.row.solve_time))
    return Document(
        title=title,
        lead=f"{counted(len(cases), 'case')}, {counted(len(outcomes), 'run')},"
        f" {seconds:.0f} s of solving. Each load factor links to its certificate: residuals"
        " recomputed from velocity, stress, reactions.",
        summary=list(_summary(outcomes, results)),
        sections=[
            Section("cases", "Cases at a glance", [_cases_table(cases)]),
            Section("couplings", "Couplings and backends", [_efforts_table(outcomes)]),
            *studies(results),
            *(_section(*case) for case in cases),
            Section("verdicts", "How a verdict is reached", [_rules()]),
            Section("machine", "Machine and versions", [Facts(machine)]),
        ],
    )


def results_frame(outcomes: Sequence[Outcome]) -> pd.DataFrame:
    """Outcomes as the table that a store would give of them."""
    return as_table(outcome.record() | {"run": outcome.run.key} for outcome in outcomes)


def _summary(outcomes: Sequence[Outcome], results: pd.DataFrame) -> Iterator[Block]:
    yield _tally(tally(outcomes))
    failed = results[results["verdict"] == FAIL]
    if len(failed):
        labels = [outcome.run.label for outcome in outcomes if outcome.row.verdict == FAIL]
        yield Heading("What failed")
        yield Links(
            [
                Link(label, RUN.of({"run": run}), why)
                for label, run, why in zip(labels, failed["run"], failed["why"], strict=True)
            ]
        )


def _tally(count: Verdicts) -> Tally:
    counts = [
        Count(count.passed, "pass", "good"),
        Count(count.failed, "FAIL", "bad" if count.failed else "mild"),
        Count(count.skipped, "skipped"),
    ]
    rare = [Count(count.no_result, NO_RESULT), Count(count.no_reference, NO_REFERENCE)]
    return Tally(counts + [own for own in rare if own.number])


def _cases_table(cases: Sequence[tuple[Case, Sequence[Outcome], pd.DataFrame]]) -> Table:
    rows = [
        {"case": case.id, "title": case.title, "worst": _worst_error(own)} | vars(tally(own))
        for case, own, _ in cases
    ]
    some = any(row["no_reference"] for row in rows)
    unjudged = [Column("no_reference", NO_REFERENCE, ".0f")] if some else []
    columns = (
        Column("title", "case", link=Anchor("case", "case"), long=True),
        Column("passed", "pass", ".0f"),
        Column("failed", "FAIL", ".0f"),
        Column("skipped", "skipped", ".0f"),
        *unjudged,
        Column("worst", "error %, exact, finest", ".2g", scale=100),
    )
    return Table(columns, pd.DataFrame(rows, columns=[*rows[0]] if rows else []))


def _worst_error(outcomes: Sequence[Outcome]) -> float:
    """Largest error of an exact backend on the finest mesh run; NaN without any.

    Of values that were found: a status has no error.
    """
    exact = [
        o for o in outcomes if o.evidence.residuals and isnan(o.row.P) and o.row.coupling != BRACKET
    ]
    finest = max((o.row.n_elements for o in exact), default=0)
    errors = [abs(o.row.error) for o in exact if o.row.n_elements == finest]
    return max((error for error in errors if isfinite(error)), default=nan)


def _efforts_table(outcomes: Sequence[Outcome]) -> Table:
    columns = (
        Column("coupling"),
        Column("backend"),
        Column("solved", "certified", ".0f"),
        Column("cases", "of", ".0f"),
        Column("median", "median solves", "g"),
        Column("most", "most solves", "g"),
        Column("failed", "FAIL", ".0f"),
    )
    rows = [vars(effort) for effort in efforts(outcomes)]
    return Table(columns, pd.DataFrame(rows, columns=[column.name for column in columns]))


def _section(case: Case, outcomes: Sequence[Outcome], results: pd.DataFrame) -> Section:
    runs = {outcome.run.variant.name: outcome.run for outcome in outcomes}
    elements: dict[str, int] = {}
    for outcome in outcomes:
        name, size = outcome.run.variant.name, outcome.row.n_elements
        if isfinite(size) and outcome.row.coupling != BRACKET:  # whose error is its width
            elements[name] = max(int(size), elements.get(name, 0))
    blocks: list[Block] = [
        description(case, [run.variant for run in runs.values()], elements),
        Heading("Results"),
        *results_of(case, outcomes, results),
    ]
    mood = "bad" if FAIL in set(results["verdict"]) else "good" if tally(outcomes).passed else ""
    return Section(f"case-{slug(case.id)}", case.title, blocks, lead(case), mood)


def results_of(case: Case, outcomes: Sequence[Outcome], results: pd.DataFrame) -> list[Block]:
    """What came out of one case: runs, reasons, certificates, charts and mechanisms."""
    brackets = results["coupling"] == BRACKET
    blocks: list[Block] = []
    if brackets.any():
        blocks.append(brackets_table(results[brackets]))
    if not brackets.all():
        blocks.append(results_table(results[~brackets]))
    if case.path is not None:
        blocks.append(paths_table(results))
    blocks.append(Details("Why each verdict", [reasons_table(results)]))
    certificates = certificates_table(results)
    if len(certificates.data):
        title = "Certificates: residuals recomputed from velocity, stress, reactions and load"
        blocks.append(Details(title, [certificates]))
    drawn = [*_mechanisms(outcomes), *bracket_drawings(outcomes)]
    pictures = [item for item in drawn if not isinstance(item, Text)]
    missing = [item for item in drawn if isinstance(item, Text)]
    return [*blocks, Gallery([*_charts(case, outcomes), *pictures]), *missing]


def _charts(case: Case, outcomes: Sequence[Outcome]) -> Iterator[Drawing]:
    chart = sweep_chart(case, outcomes) if case.sweep else None
    if chart is not None:
        text = f"Load factor against {case.sweep}, finest mesh of each backend"
        yield Drawing(f"{case.id}-sweep", text, chart)
    paths = path_chart(case, outcomes) if case.path is not None else None
    if paths is not None:
        yield paths


def _mechanisms(outcomes: Sequence[Outcome]) -> Iterator[Picture | Text]:
    """Pictures of mechanisms; of a state that does not go with its case any more, why not."""
    shown = sorted(finest_exact(outcomes).items(), key=lambda item: item[1].row.verdict != FAIL)
    for name, outcome in shown[:MECHANISMS]:
        caption = f"Mechanism of {name}: {outcome.row.mesh} mesh, {outcome.row.backend}"
        file = f"{slug(outcome.run.case.id)}-{slug(name)}"
        try:
            state = restored(outcome.run, outcome.row, outcome.evidence)
            yield Picture(file, caption, png(state.plot(), dpi=90))
        except Exception as error:  # of a case that was changed since, or whatever others wrote
            yield Text(said(error), lead=f"{caption}: cannot be drawn from what is stored")


def _rules() -> Html:
    return Html(document.fragment("verdicts.html.j2", solver=SOLVER, exact=EXACT, strong=STRONG))
