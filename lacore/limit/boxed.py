"""`lacore.solve`: a state, and what only who asked for it reads.

That is where a soil may go on beyond its box what that would change, and what to try where there is
no load factor. What lacore solves for itself - steps of brackets, ranges, paths, neighbours of a
state - asks `lacore.limit.solve` alone.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import wraps
from typing import ParamSpec

from lacore.bodies.continuum.regions.lending import next_to_none, strengthless
from lacore.conditions.water import PorePressure, StandingWater
from lacore.coupling.kinds import ASSOCIATED
from lacore.limit import solve as states
from lacore.limit.larger import held_back
from lacore.limit.reached import reached_supports
from lacore.limit.state import LimitState
from lacore.problem.problem import Problem
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.text import Quantity
from lacore.solvers.registry import JUDGE
from lacore.status import Rigor, Status

Given = ParamSpec("Given")
_TAKEN = ("__name__", "__qualname__", "__doc__", "__annotations__")  # not where it is, for pickle


def telling(solved: Callable[Given, LimitState]) -> Callable[Given, LimitState]:
    """Return the function with findings on sides that hold soils back, and on what to try."""

    @wraps(solved, assigned=_TAKEN)
    def told(*args: Given.args, **kwargs: Given.kwargs) -> LimitState:
        state = solved(*args, **kwargs)
        more = _TOLD.get(state.status, _nothing)(state)
        return replace(state, findings=(*state.findings, *more)) if more else state

    return told


def _associated(problem: Problem) -> float:
    return states.solve(problem, JUDGE, "associated").load_factor


def _beyond(state: LimitState) -> tuple[Finding, ...]:
    """What more ground beside a soil would change, asked where speeds do not tell."""
    discretisation, point = state.discretisation, state.point
    if point is None or reached_supports(discretisation, point.velocity):
        return ()
    normal = state.coupling == ASSOCIATED or discretisation.full.associated_flow
    known = state.load_factor if normal and state.rigor is not Rigor.REGULARISED else None
    return held_back(discretisation, point.velocity, _associated, known)


def _room(state: LimitState) -> tuple[Finding, ...]:
    """What to lend to bodies in which solvers find no digits."""
    found = state.discretisation
    bodies = {name: dofs.body for name, dofs in found.continua.items()}
    lent = {
        name: next_to_none(body, found.full.dead_load)
        for name, body in bodies.items()
        if any(strengthless(body))
    }
    return tuple(
        Finding(Kind.HARDLY_STRONG, (name,), {"lent": Quantity(size, "Pa", ".1e")})
        for name, size in lent.items()
    )


def _water(state: LimitState) -> tuple[Finding, ...]:
    """That free water has to be said, too, where a wet body falls without any."""
    dead = state.discretisation.problem.dead_loads
    wet = any(isinstance(load, PorePressure) for load in dead)
    standing = any(isinstance(load, StandingWater) for load in dead)
    return () if standing or not wet else (Finding(Kind.NO_STANDING_WATER),)


def _nothing(state: LimitState) -> tuple[Finding, ...]:
    return ()


_TOLD: Mapping[Status, Callable[[LimitState], tuple[Finding, ...]]] = {
    Status.SOLVED: _beyond,
    Status.UNSAFE: _water,
    Status.NOT_CERTIFIED: _room,
    Status.STALLED: _room,
    Status.ITERATION_LIMIT: _room,
}

solve = telling(states.solve)
