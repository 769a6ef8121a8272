"""Stopping criteria of the solvers in this package. Not a backend."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Goal:
    """Stopping criteria of an iteration.

    Attributes:
        tolerance: relative tolerance on the residuals of all conditions.
        max_iterations: limit of Newton steps.
        deadline: time of the clock `time.perf_counter`.
    """

    tolerance: float
    max_iterations: int
    deadline: float
