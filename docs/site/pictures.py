"""Pictures of cases for the manual and the gallery: drawn once for each version of the code."""

import hashlib
import inspect
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

import lacore as la
from verification.case import Case
from verification.report.blocks import Picture, Text
from verification.report.drawing import Drawn, Subject, draw, sketch
from verification.store.provenance import code_version

_SEEN = "mechanism"


def mechanism(case: Case) -> Subject:
    """How the first variant of a case collapses, on its second mesh level."""
    variant = case.variants[0]
    text = f"How {variant.name} collapses, found anew when this page was made"
    return Subject(f"{case.id}-{_SEEN}", text, case, partial(_mechanism, case))


def _mechanism(case: Case) -> Figure:
    variant = case.variants[0]
    level = (*case.meshes, *case.meshes)[1]
    state = la.solve(case.problem(variant, level))
    if state.status is not la.Status.SOLVED:
        raise ValueError(f"nothing moves: {state.status.label}. {state.message}")
    return state.plot()


def subjects(case: Case) -> list[Subject]:
    """The problem, and how it collapses; a path has many loads."""
    return [sketch(case), *([] if case.path is not None else [mechanism(case)])]


@dataclass(frozen=True)
class Kept:
    """Pictures in a folder, by what they were drawn with."""

    folder: Path

    def drawn(self, cases: Sequence[Case], most: int) -> Drawn:
        """Pictures of all cases; of what is not in the folder the first `most` are drawn."""
        found: dict[str, Picture | Text] = {}
        todo: list[Subject] = []
        for subject in (one for case in cases for one in subjects(case)):
            old = self._found(subject)
            if old is not None:
                found[subject.name] = old
            elif len(todo) < most:
                todo.append(subject)
            else:
                found[subject.name] = Text("Not drawn: `make docs` draws all.", soft=True)
        new = draw(todo, jobs=1)
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
    """Pictures as files of the site, by their paths."""
    found = {name: one for name, one in drawn.items() if isinstance(one, Picture)}
    return {f"pictures/{name}.png": one.data for name, one in found.items()}
