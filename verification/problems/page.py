"""The page of an answer: what came out, pictures, certificate, tables, files to go on with."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
import pandas as pd

import lacore as la
from verification.problems.answers import Answer
from verification.problems.more import MORE
from verification.problems.words import worth
from verification.report.blocks import (
    Block,
    Column,
    Details,
    Document,
    Facts,
    Gallery,
    Page,
    Pages,
    Picture,
    Preformatted,
    Report,
    Section,
    Table,
    Text,
)
from verification.report.charts.figures import png
from verification.report.files import INDEX

_DPI = 110
_ROWS = 400  # of a table that a page shows


def page(
    title: str,
    answer: Answer,
    told: Mapping[str, str],
    files: Mapping[str, str],
    text: str,
    machine: Mapping[str, str],
) -> Report:
    """The page.

    Args:
        title: of the problem.
        answer: to it.
        told: what to say of it, by name.
        files: beside the page, with what each is for.
        text: of the problem file.
        machine: what it was found with.
    """
    state = answer.state
    sections = [
        Section("mechanism", "Mechanism", [*_mechanism(state)], told.get("mechanism", "")),
        Section("problem", "The problem", [_sketch(state), Facts(_parts(state))]),
    ]
    if answer.bracket is not None:
        sections.append(_bracket(answer.bracket))
    if answer.range is not None:
        sections.append(_range(answer.range))
    if answer.safety is not None:
        history = _table(answer.safety.history, "Bounds on the way")
        sections.append(Section("safety", "Factor of safety", [history], str(told["safety"])))
    sections += [_more(*pair) for pair in answer.more.items()]
    sections += [
        Section("certificate", "Certificate", [*_certificate(state)]),
        Section("tables", "Tables", [*_tables(state)]),
        Section("file", "The problem file", [Preformatted(text)]),
        Section("files", "Files", [Pages([Page(file, file, why) for file, why in files.items()])]),
        Section("machine", "Machine and versions", [Facts(machine)]),
    ]
    kept = [section for section in sections if section.blocks]
    return Report({INDEX: Document(title, _lead(answer), kept, [Facts(told)])})


def _lead(answer: Answer) -> str:
    state = answer.state
    if state.status is la.Status.SOLVED:
        return f"Collapse at {state.load_factor:.6g} times the reference loads: {worth(state)}."
    return state.status.said(state.message)


def _picture(name: str, caption: str, thing: object) -> Picture:
    return Picture(name, caption, png(thing.plot(), _DPI))  # type: ignore[attr-defined]


def _mechanism(state: la.LimitState) -> Iterator[Block]:
    if state.point is None:
        yield Text("There is no mechanism to be drawn.", soft=True)
        return
    yield Gallery([_picture("mechanism", "Mechanism, drawn larger than life", state)])


def _sketch(state: la.LimitState) -> Block:
    problem = state.discretisation.problem
    return Gallery([_picture("problem", "The problem: supports, contact, loads", problem)])


def _parts(state: la.LimitState) -> dict[str, str]:
    facts = state.discretisation.problem.facts()
    return {"problem": facts.title.partition(": ")[2], **facts.told}


def _bracket(bracket: la.Bracket) -> Section:
    blocks: list[Block] = [_table(bracket.history, "Solves")]
    if np.isfinite(bracket.width):
        blocks.insert(0, Gallery([_picture("bracket", "Where the rest of the gap is", bracket)]))
    return Section("bracket", "Proven from both sides", blocks, bracket.heading)


def _range(found: la.CoulombRange | la.SoilRange) -> Section:
    facts = found.facts()
    blocks: list[Block] = [Facts(dict(facts.told)), _table(found.states, "States found")]
    return Section("range", "Range of load factors", blocks, facts.title)


def _more(name: str, found: Any) -> Section:
    own = MORE[name]
    if isinstance(found, str):
        return Section(name, own.title, [Text(found)])
    blocks: list[Block] = [Gallery([_picture(name, own.caption(found), found)])]
    if own.table is not None:
        blocks.append(_table(own.table(found), own.title))
    return Section(name, own.title, blocks, own.said(found))


def _certificate(state: la.LimitState) -> Iterator[Block]:
    if state.certificate is None:
        yield Text("There is no state, and so no certificate.", soft=True)
        return
    named = pd.DataFrame(
        [(name.replace("_", " "), value) for name, value in asdict(state.certificate).items()],
        columns=["residual", "size"],
    )
    columns = (Column("residual"), Column("size", form=".2e"))
    yield Text(
        "Recomputed from velocities, stresses and reactions, whatever the solver says;"
        f" {state.tolerance:g} is what each may be."
    )
    yield Table(columns, named)


def _tables(state: la.LimitState) -> Iterator[Block]:
    if state.point is None:
        return
    found = {
        "Reactions in contact": state.reactions,
        "Forces of supports": state.support_reactions,
        "Plastic hinges": state.hinges,
        "Solves": state.history,
    }
    for title, frame in found.items():
        if len(frame):
            yield Details(f"{title}: {len(frame)}", [_table(frame, title)])


def _table(frame: pd.DataFrame, caption: str) -> Table:
    shown = frame.head(_ROWS)
    rest = f" (the first {_ROWS} of {len(frame)})" if len(frame) > _ROWS else ""
    columns = [
        Column(
            str(name),
            str(name).replace("_", " "),
            "" if not pd.api.types.is_numeric_dtype(shown[name]) else ".5g",
        )
        for name in shown
        if shown[name].map(lambda own: isinstance(own, str | int | float | np.number)).all()
    ]
    return Table(columns, shown, caption + rest)
