"""Reports, drawn and written with progress on the terminal."""

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from lacore_verification.defaults import cores
from lacore_verification.harness import progress
from lacore_verification.harness.campaigns.compared_programs import program_files
from lacore_verification.harness.store.provenance import describe
from lacore_verification.report import page
from lacore_verification.report.drawing import Drawn, Subject, drawing, most_for
from lacore_verification.report.files import write
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.run import Run

FIRST = 10.0
"""Seconds after which a comparison writes its first pages, if it has not ended before."""
SHARE = 0.01
"""Share of its time that a comparison spends on pages before it has ended, at most."""


class GrowingReport:
    """The table and the pages of a comparison that has not ended; no mechanisms are drawn.

    They are written again whenever that takes a small share of the time since the last time, so
    that a comparison that is killed leaves pages with most of its rows.

    Args:
        runs: Runs of the comparison, in its order.
        folder: Output folder.
    """

    def __init__(self, runs: Sequence[Run], folder: Path) -> None:
        self._runs, self._folder = runs, folder
        self._found: dict[str, Outcome] = {}
        self._due = time.monotonic() + FIRST

    def add(self, outcome: Outcome) -> None:
        """Add a row, and write what exists if it is time to."""
        self._found[outcome.run.key] = outcome
        begin = time.monotonic()
        if begin >= self._due and len(self._found) < len(self._runs):
            self.write()
            end = time.monotonic()
            self._due = end + (end - begin) / SHARE

    def write(self) -> None:
        """Write the table and the pages of the runs that have ended; nothing if there are none.

        Raises:
            InputError: The folder cannot be written.
        """
        outcomes = [self._found[run.key] for run in self._runs if run.key in self._found]
        if not outcomes:
            return
        count = f"{len(outcomes)} of {len(self._runs)} runs finished"
        about = {**describe(run.backend for run in self._runs), "progress": count}
        title = f"Collapse loads compared with reference values, {count}"
        write(page.comparison_report(outcomes, about, {}, title), self._folder)


def write_report(
    outcomes: Sequence[Outcome], about: Mapping[str, str], folder: Path, most: int | None = None
) -> Path:
    """Draw and write the report of outcomes; returns the path of its index.

    Args:
        outcomes: outcomes of a comparison, verification or sweep.
        about: their provenance.
        folder: output folder. Pages link the programs that `write_programs` wrote there.
        most: number of mechanisms, and of brackets, that are drawn for each case; None: `most_for`
            the cases.

    Raises:
        InputError: the folder cannot be written.
    """
    cases = len({outcome.run.case.id for outcome in outcomes})
    subjects = page.subjects(outcomes, most_for(cases) if most is None else most)
    with pictures_of(subjects) as drawn:
        report = page.comparison_report(outcomes, about, drawn, programs=program_files(folder))
    with progress.status("writing the pages"):
        return write(report, folder)


@contextmanager
def pictures_of(subjects: Sequence[Subject]) -> Iterator[Drawn]:
    """Draw pictures by as many processes as there are cores, while the pages are built."""
    with (
        progress.patiently("drawing", len(subjects)) as on_done,
        drawing(subjects, cores(), on_done) as drawn,
    ):
        yield drawn
