"""How long the steps of a path are: equal, or as their error allows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lacore.paths.ending import Ending, PathEndError
from lacore.reporting.errors import InputError, require_positive
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Compact

_END = 1e-9  # of the travel: a smaller rest is round-off
_SAFETY, _CHANGE = 0.9, (0.3, 2.0)  # factors on the length of adaptive steps


@dataclass(frozen=True, repr=False)
class AdaptiveSteps(Compact):
    """Steps whose length follows from their error.

    Attributes:
        tolerance: of the displacement by which the velocity may change within a step, per body
            size; see `PathStep.error`.
        first: length of the first step, of the travel.
        smallest: of a step, of the travel; below it the path ends.

    Example:
        >>> steps = la.AdaptiveSteps(tolerance=1e-3, first=0.05)  # in place of a number of them
    """

    tolerance: float = 1e-3
    first: float = 0.05
    smallest: float = 1e-4

    def __post_init__(self) -> None:
        for name in ("tolerance", "first", "smallest"):
            require_positive(f"AdaptiveSteps.{name}", getattr(self, name))
        if not self.smallest <= self.first <= 1:
            raise InputError(
                "AdaptiveSteps.first",
                self.first,
                f"outside [smallest, 1], where smallest = {self.smallest!r}",
                "give a share of the travel in between",
            )


@dataclass
class Pace:
    """Lengths of steps: equal, or as the error allows; `next` is that of the next one."""

    steps: int | AdaptiveSteps
    travel: float
    next: float = 0.0

    def __post_init__(self) -> None:
        first = self.steps.first if isinstance(self.steps, AdaptiveSteps) else 1 / self.steps
        self.next = self.travel * first

    def resume(self, step: float) -> None:
        """Continue with a step of the given length; the length of equal steps does not change."""
        if isinstance(self.steps, AdaptiveSteps):
            self.next = step

    def distance(self, done: float) -> float:
        """Return the distance of the next step; 0 at the end."""
        left = self.travel - done
        return 0.0 if left <= _END * self.travel else min(self.next, left)

    def accepts(self, error: float) -> bool:
        """Whether a step with this error is taken; the first one has none."""
        return not isinstance(self.steps, AdaptiveSteps) or not error > self.steps.tolerance

    def shorter(self, distance: float, error: float) -> float:
        """Another attempt.

        Raises:
            PathEndError: The step would be too short.
        """
        shorter = distance * self._factor(error)
        assert isinstance(self.steps, AdaptiveSteps)
        if shorter < self.steps.smallest * self.travel:
            found = Finding(Kind.STEP_ERROR, values={"error": float(error)})
            raise PathEndError(Ending.STEP_TOO_SMALL, found)
        return shorter

    def learn(self, distance: float, error: float) -> None:
        """Set the next step by the error of the last: the error goes with its square."""
        if isinstance(self.steps, AdaptiveSteps) and np.isfinite(error):
            self.next = distance * self._factor(error)

    def _factor(self, error: float) -> float:
        assert isinstance(self.steps, AdaptiveSteps)
        ratio = np.sqrt(self.steps.tolerance / max(error, 1e-300))
        return float(np.clip(_SAFETY * ratio, *_CHANGE))
