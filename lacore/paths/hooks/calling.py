"""Call the hooks of a path, and end the path where one raises an exception."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path as File
from traceback import extract_tb
from typing import Any

from lacore.limit.state import LimitState
from lacore.paths.configuration import Configuration
from lacore.paths.ending import Ending, PathEndError
from lacore.paths.flow import Moment
from lacore.paths.hooks.hook import (
    AFTER_SOLVE,
    AFTER_STEP,
    BEFORE_SOLVE,
    END,
    Hook,
    PathProgress,
)
from lacore.paths.logbook import Log
from lacore.paths.path import Path
from lacore.paths.schemes import Here
from lacore.paths.stage import Stage
from lacore.reporting.errors import InputError
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind

GivenHook = Hook | Callable[[PathProgress], object]
"""A bare function is called after each step."""


def known_hooks(hooks: Sequence[GivenHook]) -> list[Hook]:
    """Return the hooks of a list of hooks and functions.

    Raises:
        InputError: not a list, or an entry that is neither.
    """
    if not isinstance(hooks, Sequence) or isinstance(hooks, str):
        raise InputError("hooks", hooks, "not a list", "put it in [ ]")
    for place, own in enumerate(hooks):
        if not callable(own) and not isinstance(own, Hook):
            fix = "give a function of one argument, or a lacore.Hook"
            raise InputError(f"hooks[{place}]", own, "neither a hook nor a function", fix)
    return [own if isinstance(own, Hook) else Hook(own) for own in hooks]


@dataclass
class Caller:
    """The hooks of a path, and the path that they are shown.

    Attributes:
        hooks: in the order in which they are called.
        log: of the path.
        settings: of each solve.
        here: where the bodies are between two steps.
    """

    hooks: Sequence[Hook]
    log: Log
    settings: Mapping[str, Any]
    here: Here

    def __call__(self, when: str, here: Here) -> None:
        """Call the hooks of a moment between two steps, or after one.

        Raises:
            PathEndError: a hook raises an exception.
        """
        self.here = here
        step = here.step if when == AFTER_STEP else here.step + 1
        self._call(when, step, self.log.now, here.configuration)

    def solving(self, stage: Stage, moment: Moment, state: LimitState | None) -> None:
        """Call the hooks before a solve, or after it if there is a state; errors as above."""
        when = BEFORE_SOLVE if state is None else AFTER_SOLVE
        self._call(when, self.here.step + 1, stage, moment.at, state)

    def end(self, ending: Ending, findings: tuple[Finding, ...]) -> Path:
        """Call the hooks at the end of a path; return it, with a note of each one that fails."""
        path = self.log.path(ending, findings, self.settings)
        reached, failed = ending in (Ending.REACHED, Ending.STEADY), list[Finding]()
        last = path.snapshots[-1]
        row = self.log.rows[-1] if self.log.rows else None
        now = PathProgress(END, last.step, last.travel, row, None, lambda: path, path.problem)
        for hook in self._of(END):
            try:
                hook.call(now)
            except Exception as error:
                first = reached and not failed
                severity = Severity.DETAIL if first else Severity.WARNING
                failed.append(_described(hook, END, error, severity))
        if not failed:
            return path
        status = Ending.STOPPED if reached else ending
        return self.log.path(status, (*findings, *failed), self.settings)

    def _of(self, when: str) -> list[Hook]:
        return [hook for hook in self.hooks if hook.when == when]

    def _call(
        self,
        when: str,
        step: int,
        stage: Stage,
        at: Configuration,
        state: LimitState | None = None,
    ) -> None:
        row = self.log.rows[-1] if self.log.rows else None
        now = PathProgress(
            when, step, self.here.travel, row, state, self.so_far, lambda: stage.at(at)
        )
        for hook in self._of(when):
            try:
                hook.call(now)
            except Exception as error:  # of others: the finished steps must not be lost with it
                failed = _described(hook, when, error, Severity.DETAIL)
                raise PathEndError(Ending.STOPPED, failed) from error

    def so_far(self) -> Path:
        """Return the path as hooks see it before it ends."""
        return self.log.path(Ending.RUNNING, (), self.settings)


def _described(hook: Hook, when: str, error: Exception, severity: Severity) -> Finding:
    """Return which hook failed, with the place in its code."""
    place = extract_tb(error.__traceback__)[-1]
    where = f"{File(place.filename).name}, line {place.lineno}"
    what = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    values = {"hook": hook.name, "when": when, "error": what, "place": where}
    return Finding(Kind.HOOK_FAILED, (), values, severity)
