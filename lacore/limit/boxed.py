"""`lacore.solve`: a state, and where a soil may go on beyond its box what that would change.

What lacore solves for itself - steps of brackets, ranges, paths, neighbours of a state - asks
`lacore.limit.solve` alone: nobody reads there what a larger box would carry.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from typing import ParamSpec

from lacore.inner.preparing import JUDGE
from lacore.limit import solve as states
from lacore.limit.larger import held_back
from lacore.limit.reached import reached_supports
from lacore.limit.state import LimitState
from lacore.problem.problem import Problem
from lacore.status import Rigor, Status

Given = ParamSpec("Given")
_TAKEN = ("__name__", "__qualname__", "__doc__", "__annotations__")  # not where it is, for pickle


def telling(solved: Callable[Given, LimitState]) -> Callable[Given, LimitState]:
    """The function with, in messages of solved states, which sides of soils hold them back."""

    @wraps(solved, assigned=_TAKEN)
    def told(*args: Given.args, **kwargs: Given.kwargs) -> LimitState:
        state = solved(*args, **kwargs)
        beyond = _beyond(state) if state.status is Status.SOLVED else ""
        return replace(state, message=f"{state.message}; {beyond}") if beyond else state

    return told


def _associated(problem: Problem) -> float:
    return states.solve(problem, JUDGE, "associated").load_factor


def _beyond(state: LimitState) -> str:
    """What more ground beside a soil would change, asked where speeds do not tell."""
    discretisation, point = state.discretisation, state.point
    if point is None or reached_supports(discretisation, point.velocity):
        return ""
    full = discretisation.full
    normal = state.coupling == "associated" or not (full.contact.coulomb.any() or full.frictional)
    known = state.load_factor if normal and state.rigor is not Rigor.REGULARISED else None
    return held_back(discretisation, point.velocity, _associated, known)


solve = telling(states.solve)
