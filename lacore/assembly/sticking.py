"""Sticking interfaces that meet other conditions: their limit is the strength of the body.

STICK forbids slip up to the last vertex of an interface. If a footing begins there, or any
condition on a moving side, no mesh may have an admissible velocity. No body carries more shear than
its strength, so the Tresca law with that limit is the same in the continuum. All of such an
interface has it on every mesh, and others stick as before. Shear that grows with pressure has no
such limit: an interface between bodies that all have internal friction sticks everywhere.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf, isinf

import numpy as np

from lacore.assembly.slips import asked_of, contact_facets, meetings
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.conditions.footings import Footing
from lacore.model.contact.interfaces import Interface
from lacore.model.materials.friction import STICK, Tresca
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Ints
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Status


def yielding(
    problem: Problem, bodies: Mapping[str, BodyDofs], footings: Sequence[Footing]
) -> tuple[Interface, ...]:
    """Return the interfaces of a problem, with a Tresca limit for those that need it.

    Only straight triangles in the plane are changed, as in `lacore.assembly.slips`.
    """
    touched = [
        {} if interface.bonded else contact_facets(problem, index)
        for index, interface in enumerate(problem.interfaces)
    ]
    return tuple(
        _yielding(interface, index, problem, bodies, footings, touched)
        for index, interface in enumerate(problem.interfaces)
    )


def _yielding(
    interface: Interface,
    index: int,
    problem: Problem,
    bodies: Mapping[str, BodyDofs],
    footings: Sequence[Footing],
    touched: Sequence[Mapping[str, Ints]],
) -> Interface:
    """Return the interface with a number and its effective law; `touched`: facets by body."""
    deformable = [bodies[name] for name in touched[index] if name in bodies]
    most = min((body.strength for body in deformable), default=inf)
    if isinf(most) or not isinf(interface.law.terms().limit):
        return interface
    # Along a face a body slips at its strength, as past a support (T90).
    if any(body.body.dimension == 3 for body in deformable) or any(
        _meets_moving(index, name, problem, bodies[name], footings, touched)
        for name in touched[index]
        if name in bodies and bodies[name].linear
    ):
        return replace(interface, friction=Tresca(most))
    return interface


def _meets_moving(
    index: int,
    name: str,
    problem: Problem,
    body: BodyDofs,
    footings: Sequence[Footing],
    touched: Sequence[Mapping[str, Ints]],
) -> bool:
    """Return whether an interface meets a footing or another moving side on a body."""
    moves = [interface.obstacle is None for interface in problem.interfaces]
    asked, owner = asked_of(problem, name, body, footings)
    beside = [np.unique(asked.nodes[moves[index] | (owner >= 0)])]
    beside += [
        own[name]
        for other, own in enumerate(touched)
        if other != index and name in own and (moves[other] or moves[index])
    ]
    return any(meetings(body, touched[index][name], other)[0].any() for other in beside)


def opening(problem: Problem, status: Status) -> Finding | None:
    """Return a finding on the interface that sticks and opens; None if there is none."""
    sticks = [interface.name for interface in problem.interfaces if interface.law == STICK]
    if not sticks or status not in (Status.FREE, Status.UNSAFE):
        return None
    return Finding(Kind.OPENS, (sticks[0],))
