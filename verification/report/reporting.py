"""Reports and manuals, drawn and written with progress on the terminal."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from verification import progress
from verification.case import Case
from verification.defaults import cores
from verification.report import manual, page
from verification.report.blocks import Report
from verification.report.drawing import Drawn, Subject, draw, most_for
from verification.report.files import write
from verification.runs.outcome import Outcome
from verification.store.store import file_of, sessions
from verification.verify import load_checks


def write_report(
    outcomes: Sequence[Outcome], about: Mapping[str, str], folder: Path, most: int | None = None
) -> Path:
    """Draw and write the report of outcomes; returns the path of its index.

    Args:
        outcomes: of a comparison, verification or sweep.
        about: their provenance.
        folder: to write into.
        most: mechanisms, and brackets, that are drawn of each case; None: `most_for` the cases.

    Raises:
        InputError: the folder cannot be written.
    """
    cases = len({outcome.run.case.id for outcome in outcomes})
    drawn = _drawn(page.subjects(outcomes, most_for(cases) if most is None else most))
    with progress.status("writing the pages"):
        return write(page.compared(outcomes, about, drawn), folder)


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
    each = most_for(2 * len(cases)) if most is None else most  # of each the problem is drawn, too
    drawn = _drawn(manual.subjects(cases, outcomes, each))
    about = list(sessions(file_of(results)).values())[-1]
    with progress.status("writing the pages"):
        found: Report = manual.manual(cases, outcomes, load_checks(results), about, drawn)
        return write(found, folder)


def _drawn(subjects: Sequence[Subject]) -> Drawn:
    """Pictures, by as many processes as there are cores."""
    with progress.patiently("drawing", len(subjects)) as on_done:
        return draw(subjects, cores(), on_done)
