"""The report of `lacore solve`: results, pictures, certificate, tables and files."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, fields
from types import MappingProxyType
from typing import Any

import numpy as np
import pandas as pd

import lacore as la
from lacore.program.certificate import Certificate
from lacore.reporting import views
from lacore.reporting.text import Reader, render
from lacore.reporting.units import Units
from lacore_verification.report.blocks import (
    Block,
    Details,
    Facts,
    Gallery,
    Page,
    PageLink,
    PageLinks,
    Picture,
    Preformatted,
    Report,
    Section,
    Table,
    Text,
)
from lacore_verification.report.charts.figures import png
from lacore_verification.report.columns import Column
from lacore_verification.report.files import INDEX
from lacore_verification.report.problems.answers import ProblemResults
from lacore_verification.report.problems.more import ANALYSES
from lacore_verification.report.problems.tables import in_units
from lacore_verification.report.problems.words import claim, friction, loads_told, said_of

_DPI = 110
_ROWS = 400  # rows of a table on a page


def page(
    title: str,
    answer: ProblemResults,
    told: Mapping[str, str],
    units: Units,
    files: Mapping[str, str],
    text: str,
    machine: Mapping[str, str],
) -> Report:
    """Return the page.

    Args:
        title: title of the problem.
        answer: its results.
        told: texts on it, by name.
        units: units of all values.
        files: files next to the page, with their purpose.
        text: text of the problem file.
        machine: machine of the results.
    """
    state = answer.state
    sections = [
        Section(
            "mechanism",
            "Collapse mechanism",
            [*_mechanism(state, units)],
            told.get("mechanism", ""),
        ),
        Section("problem", "The problem", [*described(state.discretisation.problem, units)]),
    ]
    sections += [
        _section(name, own, units) for name, own in answer.results.items() if ANALYSES[name].title
    ]
    sections += [
        Section("certificate", "Certificate", [*_certificate(state)]),
        Section("tables", "Tables", [*_tables(state, units)]),
        Section("file", "The problem file", [Preformatted(text)]),
        Section(
            "files",
            "Files",
            [PageLinks([PageLink(file, file, why) for file, why in files.items()])],
        ),
        Section("machine", "Machine and versions", [Facts(machine)]),
    ]
    kept = [section for section in sections if section.blocks]
    return Report({INDEX: Page(title, _lead(answer, units), kept, [Facts(told)])})


def _lead(answer: ProblemResults, units: Units) -> str:
    state, proven, reader = answer.state, answer.bracket, Reader(units, files=True)
    if proven is not None:
        ends = f"{proven.lower:.6g} and {proven.upper:.6g}"
        return (
            f"Collapse between {ends} times the reference loads: {proven.report.text_for(reader)}."
        )
    if state.status is la.Status.SOLVED:
        return f"Collapse at {state.load_factor:.6g} times the reference loads; {claim(state)}."
    return state.report.text_for(reader)


def _picture(name: str, caption: str, thing: object, units: Units) -> Picture:
    return Picture(name, caption, png(views.picture(thing, units=units), _DPI))


def _mechanism(state: la.LimitState, units: Units) -> Iterator[Block]:
    if state.point is None:
        yield Text("There is no mechanism to draw.", soft=True)
        return
    caption = "Collapse mechanism, displacements exaggerated"
    yield Gallery([_picture("mechanism", caption, state, units)])


def described(problem: la.Problem, units: Units) -> Iterator[Block]:
    """Yield the problem: its picture, and its parts as printed, without shortening."""
    caption = "The problem: supports, contact, loads"
    yield Gallery([_picture("problem", caption, problem, units)])
    reader = Reader(units, files=True)
    said = {
        "bodies": [f"{name}: {render(o.contents, reader)}" for name, o in problem.bodies.items()],
        "supports": [render(own.told, reader) for own in problem.supports],
        "interfaces": [
            f"{render(own.name, reader)}: {friction(own.law, units)}" for own in problem.interfaces
        ],
    }
    yield Facts(
        {
            "problem": problem.facts().title,
            **{kind: "; ".join(own) or "none" for kind, own in said.items()},
            "reference": loads_told(problem, problem.reference_loads, units),
            "dead": loads_told(problem, problem.dead_loads, units),
        }
    )


def _section(name: str, found: Any, units: Units) -> Section:
    """Show the result of an analysis: its picture, its facts, its table."""
    own, said = ANALYSES[name], said_of(name, found, units)
    if isinstance(found, str):
        return Section(name, own.title, [Text(said)])
    told = own.told(found, units)
    blocks: list[Block] = []
    if caption := own.caption(told):
        blocks.append(Gallery([Picture(name, caption, png(own.drawn(told, units), _DPI))]))
    if facts := own.facts(told, units):
        blocks.append(Facts(facts))
    if own.table is not None:
        blocks.append(table_of(own.table(told), own.table_title(told) or own.title))
    return Section(name, own.title, blocks, said)


def _certificate(state: la.LimitState) -> Iterator[Block]:
    if state.certificate is None:
        yield Text("There is no solution, and therefore no certificate.", soft=True)
        return
    named = pd.DataFrame(
        [(name.replace("_", " "), value) for name, value in asdict(state.certificate).items()],
        columns=["residual", "size"],
    )
    columns = (Column("residual"), Column("size", form=".2e"))
    yield Text(
        "The residuals are recomputed from velocities, stresses and reactions, independently of"
        f" the solver. The tolerance of each is {state.tolerance:g}."
    )
    yield Table(columns, named)


def _tables(state: la.LimitState, units: Units) -> Iterator[Block]:
    problem = state.discretisation.problem
    if state.point is None:
        return
    found = {
        "Reactions in contact": state.reactions,
        "Forces of supports": state.support_reactions,
        "Plastic hinges": state.hinges,
    }
    for title, frame in found.items():
        if len(frame):
            own, heads = in_units(frame, units, problem)
            yield Details(f"{title}: {len(frame)}", [table_of(own, title, heads)])
    if len(state.history):
        yield Details(f"Solves: {len(state.history)}", [*_history(state.history)])


def _history(history: pd.DataFrame) -> Iterator[Table]:
    """Yield the solves, and their residuals, whose columns need a separate table."""
    names = {entry.name for entry in fields(Certificate)}
    residuals = [str(name) for name in history if name in names]
    yield table_of(history.drop(columns=residuals), "Solves")
    if residuals:
        first = str(history.columns[0])
        yield table_of(history[[first, *residuals]], "Residuals of the solves", form=".1e")


def table_of(
    frame: pd.DataFrame,
    caption: str,
    heads: Mapping[str, str] = MappingProxyType({}),
    form: str = ".5g",
) -> Table:
    """Return the first rows of a table, with the numbers in a format."""
    shown = frame.head(_ROWS)
    rest = f" (the first {_ROWS} of {len(frame)})" if len(frame) > _ROWS else ""
    columns = [
        Column(
            str(name),
            heads.get(str(name), str(name).replace("_", " ")),
            _form(shown[name], form),
        )
        for name in shown
        if shown[name].map(lambda own: isinstance(own, str | int | float | np.number)).all()
    ]
    return Table(columns, shown, caption + rest)


def _form(column: "pd.Series[Any]", form: str) -> str:
    """Choose the format of a column: none for text, whole numbers as they are."""
    if not pd.api.types.is_numeric_dtype(column):
        return ""
    return "g" if pd.api.types.is_integer_dtype(column) else form
