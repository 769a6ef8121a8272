"""Bounds on the meshes of an iteration, two at a time on two processors."""

import os
import time
from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from lacore.bounds.constants import LOSS_AIM, PROJECTED_RESIDUAL, SHARPER, TIGHTEST_TOLERANCE
from lacore.bounds.lower import LowerBound, lower_bound
from lacore.bounds.upper import UpperBound, upper_bound
from lacore.limit.solve import solve
from lacore.model.problem.problem import Problem
from lacore.numerics.threads import each
from lacore.reporting.status import Status
from lacore.solvers.backend import TRUE_GAP, find_backend

Bound = LowerBound | UpperBound


def processors() -> int:
    """Return the number of processors that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not available on all systems
        return os.cpu_count() or 1


@dataclass(frozen=True)
class RequestedBound:
    """A bound to compute.

    Attributes:
        kind: ``lower`` or ``upper``.
        problem: problem on its mesh.
        tolerance: nominal tolerance; if nothing is proven, the backend is called again with its
            own.
        affordable: largest loss of the load factor when the solver's result is made admissible. If
            the bound loses more, the backend is called again with a smaller tolerance.
    """

    kind: str
    problem: Problem
    tolerance: float
    affordable: float = np.inf


@dataclass(frozen=True)
class FoundBound:
    """A bound, and the tolerance that it needed.

    Attributes:
        bound: the better one if the backend was called twice.
        sharper: tolerance by the requested one, for a bound that lost too much; else 1.
    """

    bound: Bound
    sharper: float = 1.0


@dataclass(frozen=True)
class Solver:
    """Solver of bounds.

    Attributes:
        backend: name of the backend.
        options: options of the backend, which take precedence.
        deadline: time of the clock `time.perf_counter`.
        jobs: number of simultaneous solves.
    """

    backend: str
    options: Mapping[str, Any]
    deadline: float
    jobs: int

    def answers(self, asked: Sequence[RequestedBound]) -> Generator[FoundBound]:
        """Yield the bounds in their order; the results do not depend on `jobs`.

        If the caller stops reading, the remaining bounds are not solved, or not returned.
        """
        yield from each(self.answer, asked, self.jobs)

    def answer(self, asked: RequestedBound) -> FoundBound:
        """Return one bound."""
        tolerance = asked.tolerance * self._nominal
        bound = self._bound(asked, {"tolerance": tolerance})
        if bound.status is Status.NOT_CERTIFIED:
            return FoundBound(self._bound(asked, {}))
        sharper = self._sharper(asked, bound)
        if sharper > SHARPER:
            return FoundBound(bound)
        again = self._bound(asked, {"tolerance": sharper * tolerance})
        closer = again.status is Status.SOLVED and again.lost < bound.lost
        return FoundBound(again if closer else bound, sharper)

    def _sharper(self, asked: RequestedBound, bound: Bound) -> float:
        """Return the factor for the tolerance of a bound that loses too much; else 1."""
        if bound.status is not Status.SOLVED or not bound.lost > asked.affordable:
            return 1.0
        if "tolerance" in self.options or "tolerance" not in self._known:
            return 1.0
        needed = LOSS_AIM * asked.affordable / bound.lost
        return max(needed, min(TIGHTEST_TOLERANCE / asked.tolerance, 1.0))

    @property
    def _nominal(self) -> float:
        """Nominal tolerance of the backend for a tolerance of 1."""
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
        state = solve(
            asked.problem, self.backend, "associated", tolerance=PROJECTED_RESIDUAL, options=given
        )
        return upper_bound(state)
