"""Bounds on the meshes of a round, two at a time where there are two processors."""

import os
import time
from collections.abc import Generator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields
from typing import Any

from lacore.backend import find_backend
from lacore.bounds.lower import LowerBound, lower_bound
from lacore.bounds.upper import UpperBound, upper_bound
from lacore.limit.solve import solve
from lacore.problem.problem import Problem
from lacore.status import Status

Bound = LowerBound | UpperBound

_JUDGED = 1e-3  # residuals of a velocity that is worth projecting


def processors() -> int:
    """How many this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not everywhere
        return os.cpu_count() or 1


@dataclass(frozen=True)
class Asked:
    """A bound that is to be found.

    Attributes:
        kind: ``lower`` or ``upper``.
        problem: on its mesh.
        tolerance: of the backend; it is asked once more with its own where nothing is proven.
    """

    kind: str
    problem: Problem
    tolerance: float


@dataclass(frozen=True)
class Solver:
    """Who finds bounds.

    Attributes:
        backend: its name.
        options: of the backend, before all others.
        deadline: on the clock of `time.perf_counter`.
        jobs: how many bounds are found at a time.
    """

    backend: str
    options: Mapping[str, Any]
    deadline: float
    jobs: int

    def answers(self, asked: Sequence[Asked]) -> Generator[Bound]:
        """The bounds in their order, the same whatever `jobs`: each knows its own question only.

        Who stops reading leaves the rest unsolved, or unread.
        """
        jobs = min(self.jobs, len(asked))
        if jobs < 2:
            yield from map(self.bound, asked)
            return
        with ThreadPoolExecutor(jobs) as pool:  # backends let go of the interpreter
            yield from pool.map(self.bound, asked)

    def bound(self, asked: Asked) -> Bound:
        """The answer to one question."""
        bound = self._bound(asked, {"tolerance": asked.tolerance})
        if bound.status is Status.NOT_CERTIFIED:
            bound = self._bound(asked, {})
        return bound

    def _bound(self, asked: Asked, options: Mapping[str, Any]) -> Bound:
        known = {field.name for field in fields(find_backend(self.backend).Options)}
        left = max(self.deadline - time.perf_counter(), 1.0)
        given = {k: v for k, v in {**options, "time_limit": left}.items() if k in known}
        given |= self.options
        if "time_limit" in given:
            given["time_limit"] = min(given["time_limit"], left)
        if asked.kind == "lower":
            return lower_bound(asked.problem, self.backend, options=given)
        state = solve(asked.problem, self.backend, "associated", tolerance=_JUDGED, options=given)
        return upper_bound(state)
