"""Pictures of outcomes: which ones a report shows, drawn in processes of their own."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from queue import SimpleQueue

from matplotlib.figure import Figure

from lacore.solvers.child_process import ChildProcess
from verification.case import Case, is_of_lacore
from verification.case.bracketing import BRACKET
from verification.case.sketches import sketch_of
from verification.catalogue.checks import said
from verification.evidence.limit_state import restored
from verification.perform.processes import ONE_THREAD
from verification.report.blocks import Picture, Text, slug
from verification.report.bracket import drawn_bracket
from verification.report.charts.figures import finest_exact, png
from verification.report.charts.theme import freeze
from verification.runs.outcome import Outcome
from verification.verdicts.words import FAIL

MOST = 4
"""Mechanisms of a case, and brackets, that a report of a few cases shows."""
_FEW = 48  # pictures: half a minute of one core
_TOGETHER = 4  # pictures that are drawn here: another process takes as long to start
_LIMIT = 120.0  # s, of a picture
_DPI = 90
_WORKER = "verification.report.drawing:Painter"

Drawn = Mapping[str, Picture | Text]
"""Pictures by their names; of those that cannot be drawn, why not."""


@dataclass(frozen=True)
class Subject:
    """What a picture is to be drawn of.

    Attributes:
        name: of the picture.
        caption: what it shows.
        case: whose problem has to be built for it.
        draw: makes the figure; goes to another process.
    """

    name: str
    caption: str
    case: Case
    draw: Callable[[], Figure]


class Painter:
    """In a process of its own: draws one subject after the other."""

    def draw(self, subject: Subject) -> Picture | Text:
        """The picture; of what cannot be drawn, why not."""
        return painted(subject)


def most_for(cases: int) -> int:
    """How many mechanisms, and brackets, of each of so many cases are drawn first."""
    return min(max(_FEW // max(cases, 1), 1), MOST)


def mechanisms(outcomes: Sequence[Outcome], most: int) -> list[Subject]:
    """Mechanisms of the variants of a case; those that failed come first."""
    shown = sorted(finest_exact(outcomes).items(), key=lambda item: item[1].row.verdict != FAIL)
    return [
        Subject(
            f"{slug(outcome.run.case.id)}-{slug(name)}",
            f"Mechanism of {name}: {outcome.row.mesh} mesh, {outcome.row.backend}",
            outcome.run.case,
            partial(_mechanism, outcome),
        )
        for name, outcome in shown[:most]
    ]


def brackets(outcomes: Sequence[Outcome], most: int) -> list[Subject]:
    """Meshes of the brackets of a case; those that failed come first."""
    found = [o for o in outcomes if o.row.coupling == BRACKET and o.evidence.arrays]
    return [
        Subject(
            f"{slug(outcome.run.case.id)}-{slug(outcome.run.variant.name)}-bracket",
            f"Bracket of {outcome.run.variant.name}: where the rest of the gap is",
            outcome.run.case,
            partial(drawn_bracket, outcome),
        )
        for outcome in sorted(found, key=lambda one: one.row.verdict != FAIL)[:most]
    ]


def sketch(case: Case) -> Subject:
    """The problem of the first variant, from its model."""
    variant = case.variants[0]
    return Subject(
        f"{slug(case.id)}-sketch",
        f"{variant.name}, drawn from the model",
        case,
        partial(sketch_of, case, variant),
    )


def _mechanism(outcome: Outcome) -> Figure:
    """That of a stored state, its layout as it is."""
    figure = restored(outcome.run, outcome.row, outcome.evidence).plot()
    freeze(figure, lay_out=False)  # it is laid out: once more would take as long as all else
    return figure


def painted(subject: Subject) -> Picture | Text:
    """The picture of a subject; of what cannot be drawn, why not."""
    try:
        return Picture(subject.name, subject.caption, png(subject.draw(), _DPI))
    except Exception as error:  # of a case that was changed since, or whatever others wrote
        return _failed(subject, error)


def _failed(subject: Subject, error: Exception) -> Text:
    return Text(said(error), lead=f"{subject.caption}: cannot be drawn from what is stored")


def draw(
    subjects: Sequence[Subject], jobs: int, on_done: Callable[[str], None] = lambda _: None
) -> dict[str, Picture | Text]:
    """Pictures of subjects, by `jobs` processes; `on_done` is told the caption of each.

    A few are drawn here, but for those of cases that others wrote: these may end the process.
    """
    found: dict[str, Picture | Text] = {}
    least = 0 if all(is_of_lacore(subject.case) for subject in subjects) else 1
    for subject, picture in _each(subjects, max(least, min(jobs, len(subjects) // _TOGETHER))):
        found[subject.name] = picture
        on_done(subject.caption)
    return found


def _each(subjects: Sequence[Subject], jobs: int) -> Iterator[tuple[Subject, Picture | Text]]:
    if jobs < 1:
        yield from ((subject, painted(subject)) for subject in subjects)
        return
    idle: SimpleQueue[ChildProcess] = SimpleQueue()

    def task(subject: Subject) -> Picture | Text:
        child = idle.get()
        try:
            answer: Picture | Text = child.ask(_LIMIT, "draw", subject)
        except Exception as error:  # its process ended, or it cannot go there
            return _failed(subject, error)
        else:
            return answer
        finally:
            idle.put(child)

    with ExitStack() as stack:
        children = [ChildProcess(_WORKER, ONE_THREAD) for _ in range(jobs)]
        for child in children:
            stack.callback(child.close)
            idle.put(child)
        pool = stack.enter_context(ThreadPoolExecutor(jobs))

        def abandon() -> None:
            pool.shutdown(wait=False, cancel_futures=True)
            for child in children:
                child.kill()

        stack.callback(abandon)
        tasks: dict[Future[Picture | Text], Subject] = {
            pool.submit(task, subject): subject for subject in subjects
        }
        for future in as_completed(tasks):
            yield tasks[future], future.result()
