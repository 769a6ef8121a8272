"""Progress of commands on stderr: a bar on a terminal, and otherwise lines.

In logs and pipes, a line is printed every `EVERY` seconds.
"""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from datetime import timedelta
from typing import Protocol

import click
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from lacore_verification.harness.verdicts.words import FAIL
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.run import Run

EVERY = 10.0
"""s between lines without a terminal."""
_LOOKBACK = 600.0  # s: the remaining time is estimated from the runs that ended in it.
_MOST = 2  # Names of runs in a line.


class Watch(Protocol):
    """Callbacks of many runs."""

    def start(self, run: Run) -> None:
        """Show that a run has started; called from any thread."""

    def finish(self, outcome: Outcome) -> None:
        """Show that a run has finished; a failure is printed at once."""


class _Bar:
    """Progress on a terminal."""

    def __init__(self, progress: Progress, total: int) -> None:
        self._progress = progress
        self._task = progress.add_task("", total=total)
        self._done = 0
        self._begun = False

    def start(self, run: Run) -> None:
        self._begun = True
        self._progress.update(self._task, description=run.label)

    def finish(self, outcome: Outcome) -> None:
        self._done += 1
        if self._begun:
            self._progress.advance(self._task)
        else:  # A stored result must not count in the estimate of the time.
            self._progress.reset(self._task, completed=self._done)
        if outcome.row.verdict == FAIL:
            self._progress.console.print(_failure(outcome), style="red", markup=False)


class _Lines:
    """Progress in a log."""

    def __init__(self, total: int) -> None:
        self._total = total
        self._begin = time.monotonic()
        self._known = 0
        self._done = 0
        self._running: dict[str, str] = {}

    def start(self, run: Run) -> None:
        self._running[run.key] = run.label

    def finish(self, outcome: Outcome) -> None:
        self._done += 1
        if self._running.pop(outcome.run.key, None) is None:
            self._known += 1
        if outcome.row.verdict == FAIL:
            click.echo(_failure(outcome), err=True)

    def line(self) -> str:
        """Return the line that shows the progress."""
        seconds = time.monotonic() - self._begin
        text = f"{self._done} of {self._total} runs finished, {_clock(seconds)} elapsed"
        new = self._done - self._known
        if new:
            left = (self._total - self._done) * seconds / new
            text += f", about {_clock(left)} remaining"
        running = list(self._running.values())
        more = f", {len(running) - _MOST} more" if len(running) > _MOST else ""
        return f"{text}; running: {', '.join(running[:_MOST])}{more}" if running else text


def _failure(outcome: Outcome) -> str:
    return f"FAIL {outcome.run.label}: {outcome.row.why}"


def _clock(seconds: float) -> str:
    return str(timedelta(seconds=round(seconds)))


@contextmanager
def watching(total: int) -> Iterator[Watch]:
    """Show the progress of `total` runs, which of them are running, and the remaining time."""
    console = Console(stderr=True)
    if not console.is_terminal:
        lines = _Lines(total)
        with _repeating(lines.line):
            yield lines
        return
    with Progress(
        SpinnerColumn(),
        BarColumn(bar_width=20),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("remaining"),
        TimeRemainingColumn(),
        TextColumn("{task.description}", markup=False),
        console=console,
        transient=True,
        speed_estimate_period=_LOOKBACK,
    ) as progress:
        yield _Bar(progress, total)


@contextmanager
def status(text: str) -> Iterator[Callable[[str], None]]:
    """Show a task of unknown length; the function that this yields shows a detail."""
    console = Console(stderr=True)
    if console.is_terminal:
        with console.status(text) as shown:
            yield lambda more: shown.update(f"{text}: {more}")
        return
    begin, far = time.monotonic(), ""

    def tell(more: str) -> None:
        nonlocal far
        far = f": {more}"

    with _repeating(lambda: f"{text}{far}, {_clock(time.monotonic() - begin)}"):
        yield tell


@contextmanager
def _repeating(line: Callable[[], str]) -> Iterator[None]:
    """Print a line every `EVERY` seconds from a thread."""
    over = threading.Event()

    def repeat() -> None:
        while not over.wait(EVERY):
            click.echo(line(), err=True)

    thread = threading.Thread(target=repeat, daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


@contextmanager
def patiently(title: str, total: int, after: float = 2.0) -> Iterator[Callable[[str], None]]:
    """Show the progress of a task that is usually quick, after `after` seconds."""
    console = Console(stderr=True)
    begin = time.monotonic()
    done, shown, doing = 0, False, title
    with ExitStack() as stack:
        progress = Progress(
            SpinnerColumn(),
            BarColumn(bar_width=20),
            MofNCompleteColumn(),
            TextColumn("{task.description}", markup=False),
            console=console,
            transient=True,
        )
        task = progress.add_task(title, total=total)
        if not console.is_terminal:
            stack.enter_context(_repeating(lambda: f"{doing}, {done} of {total}"))

        def start(what: str) -> None:
            nonlocal done, shown, doing
            doing = f"{title}: {what}"
            if console.is_terminal and not shown and time.monotonic() - begin > after:
                stack.enter_context(progress)
                shown = True
            progress.update(task, completed=done, description=doing)
            done += 1

        yield start
