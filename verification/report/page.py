"""The page: every case explained beside its numbers, in one file that loads nothing."""

from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, isnan
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from lacore.errors import InputError
from verification.case import EXACT, SOLVER, Case
from verification.compare import efforts, tally
from verification.evidence import restored
from verification.judging import FAIL, PASS, SKIPPED, STRONG
from verification.report.figures import finest_exact, png, sweep_figure
from verification.run import Outcome, Run

MECHANISMS = 4
"""Pictures of a case; variants that failed come first."""


@dataclass(frozen=True)
class Picture:
    """A figure: file name, what it shows, and the PNG."""

    name: str
    caption: str
    data: bytes

    @property
    def uri(self) -> str:
        """As a data URI, to be embedded."""
        return f"data:image/png;base64,{b64encode(self.data).decode('ascii')}"


@dataclass(frozen=True)
class Section:
    """One case with its outcomes and pictures."""

    case: Case
    outcomes: Sequence[Outcome]
    pictures: Sequence[Picture]

    @property
    def blocks(self) -> Iterator[tuple[bool, str]]:
        """Paragraphs of the explanation: whether it is a sketch, and the text."""
        for block in self.case.explanation.strip("\n").split("\n\n"):
            yield all(line.startswith("  ") for line in block.splitlines()), block

    @property
    def runs(self) -> list[Run]:
        """One run of each variant."""
        return list({outcome.run.variant.name: outcome.run for outcome in self.outcomes}.values())

    @property
    def references(self) -> list[tuple[str, str]]:
        """Values by variant, and formula with source, one pair a formula."""
        values: dict[str, list[str]] = {}
        for run in self.runs:
            reference = self.case.reference_of(run.variant)
            kinds = [(reference, "")]
            if reference.associated is not None:
                kinds.append((reference.of_associated(), ", associated"))
            for one, suffix in kinds:
                text = f"{one.formula} ({one.kind}; {one.source})"
                values.setdefault(text, []).append(f"{run.variant.name}{suffix}: {one.text}")
        return [(", ".join(own), text) for text, own in values.items()]

    @property
    def reasons(self) -> list[tuple[str, str]]:
        """Variants, and why their band on the finest mesh run is what it is."""
        texts: dict[str, str] = {}
        sizes: dict[str, float] = {}
        for outcome in self.outcomes:
            name, elements = outcome.run.variant.name, outcome.row.n_elements
            if isfinite(elements) and elements > sizes.get(name, 0):
                band = self.case.band_of(outcome.run.variant, int(elements))
                texts[name], sizes[name] = band.reason, elements
        names: dict[str, list[str]] = {}
        for name, text in texts.items():
            names.setdefault(text, []).append(name)
        return [(", ".join(own), text) for text, own in names.items()]

    @property
    def residuals(self) -> list[tuple[Outcome, dict[str, float]]]:
        """Outcomes that carry a certificate."""
        return [
            (outcome, dict(outcome.evidence.residuals))
            for outcome in self.outcomes
            if outcome.evidence.residuals
        ]

    @property
    def worst_error(self) -> float:
        """Largest error of an exact backend on the finest mesh run; NaN without any.

        Of values that were found: a status has no error.
        """
        exact = [o for o in self.outcomes if o.evidence.residuals and isnan(o.row.P)]
        finest = max((o.row.n_elements for o in exact), default=0)
        errors = [abs(o.row.error) for o in exact if o.row.n_elements == finest]
        errors = [error for error in errors if isfinite(error)]
        return max(errors, default=float("nan"))


def sections(outcomes: Sequence[Outcome]) -> list[Section]:
    """Outcomes by case, with their pictures drawn."""
    by_case: dict[str, list[Outcome]] = {}
    for outcome in outcomes:
        by_case.setdefault(outcome.run.case.id, []).append(outcome)
    return [
        Section(own[0].run.case, own, list(_pictures(own[0].run.case, own)))
        for own in by_case.values()
    ]


def _pictures(case: Case, outcomes: Sequence[Outcome]) -> Iterator[Picture]:
    if case.sweep:
        figure = sweep_figure(case, outcomes)
        if figure is not None:
            text = f"Load factor against {case.sweep}, finest mesh of each backend"
            yield Picture(f"{case.id}-sweep", text, png(figure))
    shown = sorted(finest_exact(outcomes).items(), key=lambda item: item[1].row.verdict != FAIL)
    for name, outcome in shown[:MECHANISMS]:
        state = restored(outcome.run, outcome.row, outcome.evidence)
        caption = f"Mechanism of {name}: {outcome.row.mesh} mesh, {outcome.row.backend}"
        yield Picture(f"{case.id}-{name}", caption, png(state.plot(), dpi=90))


def write(folder: Path, outcomes: Sequence[Outcome], machine: Mapping[str, str]) -> Path:
    """Write pictures and page into a folder; returns the path of the page.

    Raises:
        InputError: the folder cannot be written.
    """
    parts = sections(outcomes)
    page = folder / "index.html"
    try:
        pictures = folder / "pictures"
        pictures.mkdir(parents=True, exist_ok=True)
        for part in parts:
            for picture in part.pictures:
                (pictures / f"{picture.name}.png").write_bytes(picture.data)
        page.write_text(render(parts, outcomes, machine), encoding="utf-8")
    except OSError as error:
        raise InputError(
            "--out", str(folder), f"cannot write there ({error.strerror})", "name a folder"
        ) from error
    return page


def render(
    parts: Sequence[Section], outcomes: Sequence[Outcome], machine: Mapping[str, str]
) -> str:
    """The page as text."""
    environment = Environment(
        loader=PackageLoader("verification.report", ""),
        autoescape=True,  # template names end in .j2, which a choice by extension would miss
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["number"] = _number
    environment.globals.update(PASS=PASS, FAIL=FAIL, SKIPPED=SKIPPED)
    rules: dict[str, Any] = {"solver": SOLVER, "exact": EXACT, "strong": STRONG}
    return environment.get_template("page.html.j2").render(
        sections=parts,
        outcomes=outcomes,
        tally=tally,
        efforts=efforts(outcomes),
        machine=machine,
        rules=rules,
        solve_time=sum(o.row.solve_time for o in outcomes if isfinite(o.row.solve_time)),
    )


def _number(value: float, how: str = ".6g") -> str:
    """Formatted; empty where there is none."""
    return format(value, how) if isfinite(value) else ("" if value != value else str(value))
