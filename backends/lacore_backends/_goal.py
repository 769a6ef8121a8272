"""When an iteration of a solver of ours ends. Not a backend."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Goal:
    """When the iteration ends.

    Attributes:
        tolerance: on what is left of all conditions, relative.
        max_iterations: Newton steps.
        deadline: by the clock of `time.perf_counter`.
    """

    tolerance: float
    max_iterations: int
    deadline: float
