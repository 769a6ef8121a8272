"""Advice on a limit state, which solves further problems."""

from __future__ import annotations

from lacore.coupling.kinds import ASSOCIATED
from lacore.limit.judges.reached import reached_supports
from lacore.limit.larger import held_back
from lacore.limit.solve import solve
from lacore.limit.state import LimitState
from lacore.model.problem.problem import Problem
from lacore.reporting.errors import typed
from lacore.reporting.findings import Finding
from lacore.reporting.status import Rigor, Status
from lacore.solvers.registry import PROVING_BACKEND


@typed()
def advice(state: LimitState) -> tuple[Finding, ...]:
    """Find sides of soils that hold a mechanism back, by solving with more ground beyond them.

    A mechanism that reaches a side through small elements is reported by `lacore.solve`. Next
    to large elements velocities do not show this: up to eight larger and finer problems are solved.

    Args:
        state: Of any status; without a certified load factor there is no advice.

    Returns:
        One finding for each side beyond which more ground lowers the load factor.

    Example:
        >>> la.advice(la.solve(la.examples.footing()))
        ()
    """
    discretisation, point = state.discretisation, state.point
    if state.status is not Status.SOLVED or point is None:
        return ()
    if reached_supports(discretisation, point.velocity):
        return ()
    normal = state.coupling == ASSOCIATED or discretisation.full.associated_flow
    known = state.load_factor if normal and state.rigor is not Rigor.REGULARISED else None
    return held_back(discretisation, point.velocity, _associated, known)


def _associated(problem: Problem) -> float:
    return solve(problem, PROVING_BACKEND, ASSOCIATED).load_factor
