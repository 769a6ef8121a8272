"""Selection of the pictures of a report, which are drawn in separate processes."""

# Annotations are not evaluated, so their modules are not loaded.
from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import partial
from pkgutil import resolve_name
from threading import Event
from typing import TYPE_CHECKING, Any

from lacore_verification.case import Case, is_of_lacore
from lacore_verification.case.band import BRACKET
from lacore_verification.case.case import described
from lacore_verification.harness.perform.pool import answers, processes
from lacore_verification.harness.verdicts.words import FAIL
from lacore_verification.report.blocks import Picture, Text
from lacore_verification.report.charts.figures import finest_exact, png
from lacore_verification.report.columns import slug
from lacore_verification.runs.outcome import Outcome

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST = 4
"""Number of mechanisms, and of brackets, of each case in a report of a few cases."""
_FEW = 48  # pictures: half a minute of one core
_LIMIT = 120.0  # s, limit for a picture
_DPI = 90
_WORKER = "lacore_verification.report.drawing:Painter"
_MAKERS = "lacore_verification.report.stored_figures"

Drawn = Mapping[str, Picture | Text]
"""Pictures by name; for those that cannot be drawn, the reason."""


@dataclass(frozen=True)
class Figures:
    """Figures of a subject.

    Attributes:
        full: The figure of its own page.
        thumbnail: The mechanism alone, for a list of cases; None for none.
    """

    full: Figure
    thumbnail: Figure | None = None


@dataclass(frozen=True)
class Subject:
    """Something to draw.

    Attributes:
        name: Name of the picture.
        caption: What the picture shows.
        case: Case whose problem has to be built for it.
        draw: Makes the figures; is sent to another process.
        dpi: Pixels per inch of the full figure.
    """

    name: str
    caption: str
    case: Case
    draw: Callable[[], Figures]
    dpi: int = _DPI


class Painter:
    """Draws one subject after the other in a separate process."""

    def draw(self, subject: Subject) -> Picture | Text:
        """Draw a subject, or say why it cannot be drawn."""
        return painted(subject)


def most_for(cases: int) -> int:
    """Choose how many mechanisms and brackets of each case are drawn if there are so many cases."""
    return min(max(_FEW // max(cases, 1), 1), MOST)


def mechanisms(outcomes: Sequence[Outcome], most: int) -> list[Subject]:
    """List the mechanisms of the variants of a case; those of failed runs come first."""
    shown = sorted(finest_exact(outcomes).items(), key=lambda item: item[1].row.verdict != FAIL)
    return [
        Subject(
            f"{slug(outcome.run.case.id)}-{slug(name)}",
            f"Collapse mechanism of {name}: {outcome.row.mesh} mesh, {outcome.row.backend}",
            outcome.run.case,
            partial(_made, "mechanism", outcome),
        )
        for name, outcome in shown[:most]
    ]


def brackets(outcomes: Sequence[Outcome], most: int) -> list[Subject]:
    """List the meshes of the brackets of a case; those of failed runs come first."""
    found = [o for o in outcomes if o.row.coupling == BRACKET and o.evidence.arrays]
    return [
        Subject(
            f"{slug(outcome.run.case.id)}-{slug(outcome.run.variant.name)}-bracket",
            f"Bracket of {outcome.run.variant.name}: contributions of the elements to the gap",
            outcome.run.case,
            partial(_made, "bracket", outcome),
        )
        for outcome in sorted(found, key=lambda one: one.row.verdict != FAIL)[:most]
    ]


def sketch(case: Case, outcomes: Sequence[Outcome] = ()) -> Subject:
    """Describe the sketch of the first variant of a case.

    Its thumbnail shows the deformed bodies at the end of a path if there is one among the outcomes,
    else the problem.
    """
    variant = case.variants[0]
    paths = [one for one in outcomes if one.row.ending and one.evidence.arrays]
    return Subject(
        f"{slug(case.id)}-sketch",
        f"Problem of {variant.name}: supports, contact, loads",
        case,
        partial(_made, "sketch", case, variant, next(iter(paths), None)),
    )


def thumbnail_of(subject: Subject, drawn: Drawn) -> Picture | None:
    """Find the thumbnail of a subject that was drawn."""
    found = drawn.get(subject.name)
    return found.thumbnail if isinstance(found, Picture) else None


def _made(name: str, *arguments: Any) -> Figures:
    """Make figures by a function of `stored_figures`, which only the process that draws imports."""
    figures: Figures = resolve_name(f"{_MAKERS}:{name}")(*arguments)
    return figures


def painted(subject: Subject) -> Picture | Text:
    """Draw a subject, or say why it cannot be drawn."""
    import matplotlib as mpl

    from lacore.pictures.thumbnails import DPI

    try:
        # Text is measured again for each resolution.
        with mpl.rc_context({"figure.dpi": subject.dpi}):
            made = subject.draw()
        small = None
        if made.thumbnail is not None:
            name = f"{subject.name}-thumbnail"
            data = png(made.thumbnail, DPI)
            small = Picture(name, subject.caption, data, shown_at=1 / 2)
        return Picture(subject.name, subject.caption, png(made.full, subject.dpi), small)
    except Exception as error:  # a case that was changed since, or any error of users
        return _failed(subject, error)


def _failed(subject: Subject, error: Exception) -> Text:
    return Text(
        described(error), lead=f"{subject.caption}: cannot be drawn from the stored results"
    )


class _Pending(Mapping[str, Picture | Text]):
    """Pictures that other processes draw: looking one up waits until it is drawn."""

    def __init__(self, subjects: Sequence[Subject]) -> None:
        self._pictures: dict[str, Future[Picture | Text]] = {one.name: Future() for one in subjects}

    def add(self, subject: Subject, answer: Any) -> None:
        """Add the answer of a process: a picture, or why there is none."""
        made = _failed(subject, answer) if isinstance(answer, Exception) else answer
        self._pictures[subject.name].set_result(made)

    @contextmanager
    def ended(self) -> Iterator[None]:
        """Let nobody wait for pictures after an error, which they raise instead."""
        try:
            yield
        except BaseException as error:
            for waiting in self._pictures.values():
                if not waiting.done():
                    waiting.set_exception(error)
            raise

    def __getitem__(self, name: str) -> Picture | Text:
        return self._pictures[name].result()

    def __iter__(self) -> Iterator[str]:
        return iter(self._pictures)

    def __len__(self) -> int:
        return len(self._pictures)


@contextmanager
def drawing(
    subjects: Sequence[Subject], jobs: int, on_done: Callable[[str], None] = lambda _: None
) -> Iterator[Drawn]:
    """Draw subjects in `jobs` processes while the pages that show them are built.

    A few are drawn in this process, before anything else, except those of user-defined cases, which
    could end it. matplotlib serves one thread at a time.

    Args:
        subjects: What to draw.
        jobs: Processes at most.
        on_done: Called with the caption of each that is drawn.

    Yields:
        The pictures; looking one up waits until it is drawn.
    """
    drawn = _Pending(subjects)
    isolate = not all(is_of_lacore(subject.case) for subject in subjects)
    found = answers(_WORKER, "draw", subjects, jobs, _LIMIT, isolate)
    stopped = Event()

    def draw() -> None:
        with closing(found), drawn.ended():
            for subject, answer in found:
                drawn.add(subject, answer)
                on_done(subject.caption)
                if stopped.is_set():
                    return

    if not isolate and processes(len(subjects), jobs) == 0:
        draw()
        yield drawn
        return
    with ThreadPoolExecutor(1) as pool:
        ending = pool.submit(draw)
        try:
            yield drawn
        except BaseException:
            stopped.set()
            raise
        ending.result()
