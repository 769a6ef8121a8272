"""Bounds on the meshes of a round, two at a time where there are two processors."""

import os
import time
from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from lacore.bounds.lower import LowerBound, lower_bound
from lacore.bounds.upper import UpperBound, upper_bound
from lacore.limit.solve import solve
from lacore.model.problem.problem import Problem
from lacore.numerics.threads import each
from lacore.reporting.status import Status
from lacore.solvers.backend import TRUE_GAP, find_backend

Bound = LowerBound | UpperBound

TIGHTEST = 1e-9  # tolerance that is asked for
_JUDGED = 1e-3  # residuals of a velocity that is worth projecting
_AIM = 0.2  # of what may be lost, when a bound is asked for again: losses do not fall evenly
_WORTH = 0.5  # of a tolerance at most, for which another solve is worth its time


def processors() -> int:
    """How many this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not everywhere
        return os.cpu_count() or 1


@dataclass(frozen=True)
class RequestedBound:
    """A bound that is to be found.

    Attributes:
        kind: ``lower`` or ``upper``.
        problem: on its mesh.
        tolerance: nominal; the backend is asked once more with its own where nothing is proven.
        affordable: of load factors, what a bound may lose as what the solver found is made
            admissible; where it loses more, the backend is asked once more, with a tolerance as
            much tighter.
    """

    kind: str
    problem: Problem
    tolerance: float
    affordable: float = np.inf


@dataclass(frozen=True)
class FoundBound:
    """A bound, and how it was found.

    Attributes:
        bound: the better one, where the backend was asked twice.
        sharper: tolerance that it took, per that of the question, for a bound that lost too much;
            else 1.
    """

    bound: Bound
    sharper: float = 1.0


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

    def answers(self, asked: Sequence[RequestedBound]) -> Generator[FoundBound]:
        """The bounds in their order, the same whatever `jobs`: each knows its own question only.

        Who stops reading leaves the rest unsolved, or unread.
        """
        yield from each(self.answer, asked, self.jobs)

    def answer(self, asked: RequestedBound) -> FoundBound:
        """The answer to one question."""
        tolerance = asked.tolerance * self._nominal
        bound = self._bound(asked, {"tolerance": tolerance})
        if bound.status is Status.NOT_CERTIFIED:
            return FoundBound(self._bound(asked, {}))
        sharper = self._sharper(asked, bound)
        if sharper > _WORTH:
            return FoundBound(bound)
        again = self._bound(asked, {"tolerance": sharper * tolerance})
        closer = again.status is Status.SOLVED and again.lost < bound.lost
        return FoundBound(again if closer else bound, sharper)

    def _sharper(self, asked: RequestedBound, bound: Bound) -> float:
        """Which share of the tolerance a bound needs that loses too much; else 1."""
        if bound.status is not Status.SOLVED or not bound.lost > asked.affordable:
            return 1.0
        if "tolerance" in self.options or "tolerance" not in self._known:
            return 1.0
        needed = _AIM * asked.affordable / bound.lost
        return max(needed, min(TIGHTEST / asked.tolerance, 1.0))

    @property
    def _nominal(self) -> float:
        """What its backend calls a nominal tolerance of 1."""
        return TRUE_GAP if find_backend(self.backend).capabilities.true_gap else 1.0

    @property
    def _known(self) -> set[str]:
        """Names of the options that its backend has."""
        return {field.name for field in fields(find_backend(self.backend).Options)}

    def _bound(self, asked: RequestedBound, options: Mapping[str, Any]) -> Bound:
        left = max(self.deadline - time.perf_counter(), 1.0)
        known = self._known
        given = {k: v for k, v in {**options, "time_limit": left}.items() if k in known}
        given |= self.options
        if "time_limit" in given:
            given["time_limit"] = min(given["time_limit"], left)
        if asked.kind == "lower":
            return lower_bound(asked.problem, self.backend, options=given)
        state = solve(asked.problem, self.backend, "associated", tolerance=_JUDGED, options=given)
        return upper_bound(state)
