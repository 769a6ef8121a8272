"""A hook, and what it is given."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from lacore.limit.state import LimitState
from lacore.model.problem.problem import Problem
from lacore.paths.path import Path, PathStep
from lacore.reporting.errors import InputError, require_known
from lacore.reporting.showing import Compact

BEFORE_STEP, AFTER_STEP = "before step", "after step"
BEFORE_SOLVE, AFTER_SOLVE = "before solve", "after solve"
BEFORE_REMESHING, AFTER_REMESHING = "before remeshing", "after remeshing"
END = "end"
TIMES = (
    *(BEFORE_STEP, AFTER_STEP, BEFORE_SOLVE, AFTER_SOLVE),
    *(BEFORE_REMESHING, AFTER_REMESHING, END),
)
"""When a path calls hooks."""


@dataclass(frozen=True, repr=False)
class PathProgress(Compact):
    """A path at the moment when it calls a hook.

    Attributes:
        when: the moment, as in `Hook`.
        step: number of the step that is being taken, or that has just been taken; 1, 2, ...
        travel: of the bodies at this moment, in units of the control.
        row: the last finished step; None before there is one.
        state: the limit state that was solved; None except ``after solve``.

    Example:
        >>> def tell(now: la.PathProgress) -> None:
        ...     print(now.step, now.travel)
        >>> path = la.sequential(
        ...     la.examples.footing(), travel=0.01, steps=1, hooks=[la.Hook(tell, "after step")]
        ... )
        1 0.01
    """

    when: str
    step: int
    travel: float
    row: PathStep | None
    state: LimitState | None
    _path: Callable[[], Path] = field(repr=False)
    _problem: Callable[[], Problem] = field(repr=False)

    @property
    def path(self) -> Path:
        """The path with all finished steps; its status is `RUNNING` until it ends."""
        return self._path()

    @property
    def problem(self) -> Problem:
        """The problem on the current shape, see `Path.problem`."""
        return self._problem()

    def __str__(self) -> str:
        """A line of progress."""
        done = self.row is not None and self.row.step == self.step
        return str(self.row) if done else f"step {self.step}: {self.when} at {self.travel:.6g}"


@dataclass(frozen=True, repr=False)
class Hook(Compact):
    """A function that a path calls, with a `PathProgress` as its only argument.

    Attributes:
        call: the function; its result is ignored.
        when: ``before step``, ``after step`` (when the step is stored, in the checkpoint as well),
            ``before solve``, ``after solve``, ``before remeshing``, ``after remeshing``, or ``end``
            (once, after the last step, however the path ends).

    Raises:
        InputError: not a function, or not such a moment.

    Example:
        >>> rows = []
        >>> hook = la.Hook(lambda progress: rows.append(progress.row), "after step")
    """

    call: Callable[[PathProgress], object]
    when: str = AFTER_STEP

    def __post_init__(self) -> None:
        if not callable(self.call):
            raise InputError(
                "Hook.call", self.call, "not a function", "give a function of one argument"
            )
        require_known("Hook.when", self.when, TIMES)

    @property
    def name(self) -> str:
        """Of the function, for messages."""
        return str(getattr(self.call, "__name__", type(self.call).__name__))
