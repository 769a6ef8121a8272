"""Which of many velocities of the same load moves the bodies along a path (T32)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from lacore.limit.conversion import point_in_program
from lacore.limit.state import LimitState
from lacore.numerics.arrays import Floats
from lacore.program.certificate import Certificate
from lacore.program.kinematic import (
    DissipationGroup,
    FrozenContact,
    KinematicProgram,
    dimensionless,
    reaction_contact,
)
from lacore.reporting.errors import InputError, require_positive
from lacore.reporting.showing import Compact
from lacore.solvers.backend import (
    Backend,
    check_capable,
    checked_answer,
    find_backend,
    read_options,
)
from lacore.solvers.inner.preparing import preparer

_STRENGTH = 1.0  # of the power that the norm may cost at the velocity as solved
_CLOSER = 0.8  # of the strength at which the excess would be the allowed one
_HALVINGS = 40  # most bisections between two velocities
_LARGEST = 0.1  # excess beyond which loads are not nearly the same


@dataclass(frozen=True, repr=False)
class LeastNorm(Compact):
    """Select the velocity with the least strain rates among those of nearly the same load (T32).

    The norm is ``sum w sigma_Y t^2``. It selects a velocity if hardening does not, and keeps the
    shape of bodies regular. It does not distinguish motions without strain.

    Attributes:
        within: Largest excess of dissipation over the minimum, relative to the dissipated power, at
            most 0.1. The load of the velocity that moves the bodies may exceed the load factor by
            this share.

    Example:
        >>> selection = la.LeastNorm(within=1e-4)
    """

    within: float = 1e-4

    def __post_init__(self) -> None:
        require_positive("LeastNorm.within", self.within)
        if self.within > _LARGEST:
            raise InputError(
                "LeastNorm.within",
                self.within,
                "such velocities have other loads",
                f"give at most {_LARGEST:g}",
            )


def require_selection(selection: LeastNorm | None, backend: Backend) -> None:
    """Raise `InputError` unless a backend supports the selection of velocities."""
    if selection is None:
        return
    if not isinstance(selection, LeastNorm):
        raise InputError("selection", selection, "no selection", "give lacore.LeastNorm(), or None")
    if backend.capabilities.regularised:
        raise InputError(
            "selection",
            selection,
            f"the viscosity of backend {backend.name!r} selects velocities already",
            "leave it out, or take an exact backend such as 'clarabel'",
        )


@dataclass(frozen=True, repr=False)
class Selected(Compact):
    """A velocity of nearly the same load as that of a limit state.

    Attributes:
        velocity: Velocity of all unknowns, m/s at ``F0.u = 1``; admissible like that of the state.
        width: Distance ``||u - u_state||/||u_state||`` in the norm of `LeastNorm`.
        excess: Additional dissipation, relative to the dissipated power; may be negative by
            round-off.
        solves: Number of solves.
    """

    velocity: Floats
    width: float
    excess: float
    solves: int


def least_norm(state: LimitState, within: float, tries: int = 2) -> Selected | None:
    """A velocity of small norm whose load is within a share of that of a limit state.

    The norm joins the costs of the program at frozen reactions, as hardening does, ever weaker
    until the excess is what is allowed; what is still too much is taken back on the straight way
    to the velocity of the state: costs are convex, constraints too.

    Args:
        state: a certified one of an exact backend.
        within: see `LeastNorm`.
        tries: solves at most.

    Returns:
        None where the solver has no admissible velocity.
    """
    d, point = state.discretisation, state.point
    assert point is not None
    program, frozen_point = dimensionless(d.program, d.natural), point_in_program(d, point)
    program = program.at_friction(program.friction(frozen_point.mean_stress))
    contact = reaction_contact(program.contact, frozen_point.normal_reaction)
    u = frozen_point.velocity
    least, power = _cost(program, contact, u), _power(program, contact, u)
    strengths = _strengths(program, frozen_point.mean_stress)
    size = _norm(program, strengths, u)
    if not size > 0:
        return Selected(point.velocity, 0.0, 0.0, 0)
    strength = _STRENGTH * power / size**2

    def excess(velocity: Floats) -> float:
        return (_cost(program, contact, velocity) - least) / power

    found, solves = None, 0
    while solves < tries:
        solves += 1
        velocity = _solved(_regular(program, strengths, strength), contact, state)
        if velocity is None:
            break
        found, more = velocity, excess(velocity)
        if more <= within:
            break
        strength *= _CLOSER * sqrt(within / more)
    if found is None:
        return None
    way = found - u
    share = _furthest(lambda part: excess(u + part * way), within)
    return Selected(
        velocity=point.velocity + np.asarray(d.free_basis @ way) * (share * d.natural.velocity),
        width=share * _norm(program, strengths, way) / size,
        excess=excess(u + share * way),
        solves=solves,
    )


def _solved(program: KinematicProgram, contact: FrozenContact, state: LimitState) -> Floats | None:
    """The velocity of one solve; None where it is not admissible to the tolerance of the state."""
    backend = find_backend(state.backend)
    check_capable(backend, program)
    prepare = preparer(backend, read_options(backend, state.options))
    solver = prepare(program)
    try:
        point = checked_answer(program, False, solver.solve(contact)).point
    finally:
        solver.close()
    if point is None:
        return None
    seen = Certificate.of(program, point, contact)
    kept = (seen.penetration, seen.divergence, seen.normalisation)
    return point.velocity if all(value <= state.tolerance for value in kept) else None


def _strengths(program: KinematicProgram, means: Sequence[Floats]) -> list[Floats]:
    """What the norm weighs strain rates by, in each group of shape (m,), Pa.

    Where strength depends on pressure its mean over the points: next to a free surface a sand has
    none, and there, too, it is to stay regular.
    """
    return [
        group.bound
        if group.surfaces is None
        else np.full(group.bound.size, np.average(group.strength_at(mean), weights=group.weights))
        for group, mean in zip(program.groups, means, strict=True)
    ]


def _regular(
    program: KinematicProgram, strengths: Sequence[Floats], factor: float
) -> KinematicProgram:
    """The program with half of `factor` times the norm squared among its costs."""
    groups = zip(program.groups, strengths, strict=True)
    return replace(
        program, groups=tuple(replace(g, modulus=g.rise + factor * own) for g, own in groups)
    )


def _cost(program: KinematicProgram, contact: FrozenContact, velocity: Floats) -> float:
    """What the program minimises (T29)."""
    hardened = sum(float(g.weights * g.rise @ _squares(g, velocity)) for g in program.groups)
    dissipated = program.plastic_dissipation(velocity) + hardened / 2
    friction = program.friction_dissipation(velocity, contact.bound)
    return dissipated + friction - float(program.dead_load @ velocity)


def _power(program: KinematicProgram, contact: FrozenContact, velocity: Floats) -> float:
    dead = float(program.dead_load @ velocity)
    return _cost(program, contact, velocity) + dead + abs(dead)


def _norm(program: KinematicProgram, strengths: Sequence[Floats], velocity: Floats) -> float:
    groups = zip(program.groups, strengths, strict=True)
    return sqrt(sum(float(g.weights * own @ _squares(g, velocity)) for g, own in groups))


def _squares(group: DissipationGroup, velocity: Floats) -> Floats:
    return np.asarray(np.sum(group.cone_vectors(velocity) ** 2, axis=1))


def _furthest(excess: Callable[[float], float], within: float) -> float:
    """The largest share of a way on which a convex excess, 0 at its beginning, is allowed."""
    if excess(1.0) <= within:
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if excess(middle) <= within else (low, middle)
    return low
