"""Add nodes at the peaks of moments in loaded members, so that hinges can form there.

Hinges form at nodes only. A member with a load along it first gets one node midway between the
places where it is connected or supported. Then it gets nodes where the moments of a state exceed
the plastic moment, until they exceed it nowhere. Each of these states is an upper bound, and its
load divided by the largest excess is a lower bound. A distance e of the node from the peak gives an
error O(e^2) of the load factor and of the next node, so a few iterations give full accuracy.
"""

from collections.abc import Callable

import numpy as np

from lacore.assembly.discretisation import Discretisation
from lacore.assembly.span_nodes import places_on, with_nodes
from lacore.limit.constants import HINGING_ROUNDS, NODES_APART
from lacore.limit.outcome import Outcome, Times
from lacore.limit.span_moments import span_excess, span_moments
from lacore.limit.state import LimitState
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.frames.frame import Frame
from lacore.model.problem.problem import Problem
from lacore.reporting.status import Status


def with_hinges(
    given: Problem,
    problem: Problem | Discretisation,
    solved: Callable[[Problem | Discretisation, Times], Outcome],
) -> Outcome:
    """Solve again with nodes where moments exceed the plastic moment, until they exceed it nowhere.

    Args:
        given: The problem before any round.
        problem: The problem, or its discretisation.
        solved: Solves a problem with its present nodes, given the durations of earlier rounds.
    """
    outcome = solved(problem, Times())
    for _ in range(HINGING_ROUNDS):
        if outcome.status is not Status.SOLVED or outcome.excess <= outcome.allowed_excess:
            break
        outcome = solved(hinged(outcome, given), outcome.times)
    return outcome


def excess(found: LimitState) -> float:
    """How far moments inside members exceed the plastic moment, relative; at least 0."""
    assert found.point is not None
    return span_excess(found.discretisation, found.point)


def hinged(state: Outcome, given: Problem) -> Problem:
    """The problem of an outcome with nodes where its moments exceed the plastic moment most.

    Args:
        state: with a point.
        given: the problem before any round: its nodes stay.
    """
    problem, places = state.discretisation.problem, {}
    assert state.point is not None
    for name, dofs in state.discretisation.frames.items():
        moments, frame = span_moments(state.discretisation, state.point, name), dofs.body
        used, share = moments.use(frame)
        chosen = np.flatnonzero(used > 1 + state.allowed_excess)
        new = places_on(frame, chosen, share[chosen])
        first = of_kind(given.bodies, Frame)[name]
        old = frame.position[:, ~np.isin(frame.names, first.names)]
        near = NODES_APART * moments.length[chosen]
        away = np.linalg.norm(old[:, :, None] - new[:, None, :], axis=0)
        kept = old[:, np.all(away > near, axis=1)]
        places[name] = np.concatenate([kept, new], axis=1)
    return with_nodes(given, problem, places)
