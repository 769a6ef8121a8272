"""Pictures of cases for the manual and the gallery, drawn once per version of the code."""

import hashlib
import inspect
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import lacore as la
from lacore.bounds.enclosing import associated
from lacore.pictures.thumbnails import DPI
from lacore.reporting import views
from lacore_verification.case import Case
from lacore_verification.case.band import BRACKET
from lacore_verification.harness.store.provenance import code_version
from lacore_verification.harness.verdicts.words import PASS
from lacore_verification.report.blocks import Picture, Text
from lacore_verification.report.drawing import Drawn, Figures, Subject, drawing, sketch
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.run import Run

_SEEN = "mechanism"
_SMALL = "small"
_DEAR = 20.0  # s: brackets that took longer are not drawn


def mechanism(case: Case) -> Subject:
    """Return the collapse mechanism of the first variant of a case, on its second mesh level."""
    variant = case.variants[0]
    text = f"Collapse mechanism of {variant.name}, computed when this page was built"
    return Subject(f"{case.id}-{_SEEN}", text, case, partial(_mechanism, case))


def _mechanism(case: Case) -> Figures:
    state = _state(case)
    if state.status is not la.Status.SOLVED:
        raise ValueError(f"there is no collapse mechanism: {state.status.label}. {state.message}")
    return Figures(state.plot())


def _state(case: Case) -> la.LimitState:
    return la.solve(case.problem(case.variants[0], (*case.meshes, *case.meshes)[1]))


def small(case: Case) -> Subject:
    """Return the thumbnail of a case: its mechanism or deformed bodies, or else the problem."""
    return Subject(f"{case.id}-{_SMALL}", case.title, case, partial(_thumbnail, case), DPI)


def _thumbnail(case: Case) -> Figures:
    if case.path is not None:
        return Figures(views.thumbnail(_path(case)))
    state = _state(case)
    solved = state.status is la.Status.SOLVED
    return Figures(views.thumbnail(state if solved else state.discretisation.problem))


def _path(case: Case) -> la.Path:
    variant = case.variants[0]
    stated = case.following_of(variant)
    return la.sequential(
        case.problem(variant, next(iter(case.meshes))),
        stated.travel,
        stated.steps,
        stated.scheme,
        stated.control,
        approaching=stated.approaching,
    )


def subjects(case: Case, outcomes: Sequence[Outcome]) -> Iterator[Subject]:
    """Yield sketch, thumbnail, mechanism (but not of paths, with many loads) and bracket."""
    yield sketch(case)
    yield small(case)
    if case.path is None:
        yield mechanism(case)
    bracketed = enclosed(case, outcomes)
    if bracketed is not None:
        yield bracketed


def enclosed(case: Case, outcomes: Sequence[Outcome]) -> Subject | None:
    """Return the meshes of the bracket of the first variant; None without one that is fast."""
    name = case.variants[0].name
    for own in outcomes:
        row = own.row
        good = row.verdict == PASS and row.solve_time < _DEAR
        if good and (row.case, row.variant, row.coupling) == (case.id, name, BRACKET):
            text = f"Bracket of {name}, computed when this page was built"
            return Subject(f"{case.id}-bracket", text, case, partial(_bracketed, own.run))
    return None


def _bracketed(run: Run) -> Figures:
    stated = run.case.bracket
    assert stated is not None
    width, most = stated.target_width, stated.max_elements
    problem = associated(run.problem())
    return Figures(la.bracket(problem, width, most, backend=run.backend, jobs=1).plot())


@dataclass(frozen=True)
class Kept:
    """Pictures in a folder, by the code that they were drawn with."""

    folder: Path

    def drawn(self, cases: Sequence[Case], outcomes: Sequence[Outcome], most: int) -> Drawn:
        """Return the pictures of all cases, and draw at most `most` that are not in the folder."""
        found: dict[str, Picture | Text] = {}
        todo: list[Subject] = []
        for subject in (one for case in cases for one in subjects(case, outcomes)):
            old = self._found(subject)
            if old is not None:
                found[subject.name] = old
            elif len(todo) < most:
                todo.append(subject)
            else:
                found[subject.name] = Text(
                    "This picture was not drawn. `make docs` draws all.", soft=True
                )
        with drawing(todo, jobs=os.cpu_count() or 1) as new:
            for subject in todo:
                self._keep(subject, new[subject.name])
            return {**found, **new}

    def _file(self, subject: Subject) -> Path:
        source = Path(inspect.getfile(subject.case.build)).read_bytes()
        digest = hashlib.sha256(source + code_version().encode()).hexdigest()[:16]
        return self.folder / f"{subject.name}-{digest}"

    def _found(self, subject: Subject) -> Picture | Text | None:
        picture, text = (self._file(subject).with_suffix(end) for end in (".png", ".txt"))
        if picture.exists():
            return Picture(subject.name, subject.caption, picture.read_bytes())
        return Text(text.read_text(encoding="utf-8")) if text.exists() else None

    def _keep(self, subject: Subject, made: Picture | Text) -> None:
        self.folder.mkdir(parents=True, exist_ok=True)
        file = self._file(subject)
        if isinstance(made, Picture):
            file.with_suffix(".png").write_bytes(made.data)
        else:
            file.with_suffix(".txt").write_text(made.text, encoding="utf-8")


def files(drawn: Drawn) -> Mapping[str, bytes]:
    """Return the pictures as files of the site by their paths, without those of the gallery."""
    shown = {name: one for name, one in drawn.items() if not name.endswith(f"-{_SMALL}")}
    found = {name: one for name, one in shown.items() if isinstance(one, Picture)}
    return {f"pictures/{name}.png": one.data for name, one in found.items()}
