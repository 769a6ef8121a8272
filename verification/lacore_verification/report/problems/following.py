"""`lacore solve` for a file with a path: follow it, and write each finished step."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import lacore as la
from lacore.files.problem.reading import Stated
from lacore.paths.ending import Ending
from lacore.reporting.errors import InputError
from lacore.reporting.showing import counted
from lacore_verification.report.problems.answers import Status
from lacore_verification.report.problems.more import ANALYSES

HISTORY, SHAPES, ANIMATION = "history.csv", "shapes", "path.gif"
_OWN = (*(name for name, own in ANALYSES.items() if own.automatic is None), "interfaces", "vary")
"""Analyses, and their options, of the load factor of one shape."""


@dataclass(frozen=True)
class Followed:
    """Result of a path.

    Attributes:
        path: the path up to its end.
        backend: backend that solved it.
        animated: whether the file requests an animation.
        seconds: total time.
    """

    path: la.Path
    backend: str
    animated: bool
    seconds: float

    @property
    def good(self) -> bool:
        """Whether it came to its end; the load of each step is certified."""
        return self.path.status in (Ending.REACHED, Ending.STEADY)


@dataclass
class Steps:
    """Finished steps, and their folder.

    Attributes:
        folder: folder of the report.
        finished: number of steps.
    """

    folder: Path
    finished: int = field(default=0)

    @property
    def told(self) -> str:
        """For a message when the path is interrupted."""
        if not self.finished:
            return "0 steps"
        return f"{counted(self.finished, 'step')}; see {self.folder / HISTORY}"

    def hooks(self) -> list[la.Hook]:
        """Return hooks that write the history and the shapes, and count."""
        for file in (self.folder / SHAPES).glob("*.vtu"):  # of an earlier path
            file.unlink()
        for name in (HISTORY, ANIMATION):
            (self.folder / name).unlink(missing_ok=True)
        return [
            la.hooks.table(self.folder / HISTORY),
            la.hooks.vtu(self.folder / SHAPES),
            la.Hook(self._count),
        ]

    def _count(self, now: la.PathProgress) -> None:
        self.finished += 1


def path_backend(stated: Stated, backend: str | None, more: Mapping[str, Any]) -> str:
    """Return the backend that follows a path.

    Args:
        stated: the file.
        backend: backend instead of that of the file.
        more: analyses of the command line, by name.

    Raises:
        InputError: an unknown backend, or an analysis that paths do not support.
    """
    why = "applies to the load factor of one shape, and the file has a table [path]"
    for name in _OWN:
        if more.get(name) not in (None, False):
            fix = "leave it out, or remove [path] to analyse the initial shape"
            raise InputError(f"--{name}", None, why, fix)
        if getattr(stated.asked, name) not in (None, False):
            fix = "remove it, or remove [path] to analyse the initial shape"
            raise stated.source.error(("solve", name), None, why, fix)
    if backend is not None:
        la.find_backend(backend)
        return backend
    try:
        la.find_backend(stated.asked.backend)
    except InputError as error:
        at = ("solve", "backend")
        raise stated.source.error(at, error.value, error.reason, error.fix) from error
    return stated.asked.backend


def followed(stated: Stated, backend: str, steps: Steps, doing: Status) -> Followed:
    """Follow the path of a file.

    Raises:
        InputError: the path cannot be followed, with its line; nothing is followed then.
    """
    begin, asked = time.perf_counter(), stated.asked
    with doing("following the path") as tell:
        hooks = [*steps.hooks(), la.Hook(lambda now: tell(str(now.row)))]
        if stated.animated:
            hooks.append(la.hooks.animation(steps.folder / ANIMATION))
        path = stated.followed(backend=backend, coupling=asked.coupling, hooks=hooks)
    return Followed(path, backend, stated.animated, time.perf_counter() - begin)
