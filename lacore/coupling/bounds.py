"""Bounds of all Coulomb load factors of a discrete program (T14).

A lower bound needs only admissible stresses and reactions, an upper bound only an admissible
velocity. The frictionless value of a discrete program may exceed the load factors of the continuum,
whose bounds are in `lacore.analyses.ranges.continuum`.
"""

import numpy as np

from lacore.coupling.claims.locking_ray import locking_ray
from lacore.program.certificate import Certificate
from lacore.program.kinematic import (
    FrozenContact,
    KinematicProgram,
    associated_contact,
    frictionless_contact,
)
from lacore.program.power import kinematic_load_factor
from lacore.program.state import ProgramState, out_of_balance
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution


def lower_bound(program: KinematicProgram, inner: InnerSolution, tolerance: float) -> float:
    """Return the bound of stresses and reactions of a frictionless solve; -inf if they prove none.

    The power of unbalanced forces and of tensions, at the velocity of the solve, is subtracted. The
    bound is inf if reactions carry the reference load alone.
    """
    contact = frictionless_contact(program.contact)
    if inner.status is Status.LOCKED:
        ray = locking_ray(program, contact)
        return np.inf if ray is not None and ray.proves else -np.inf
    if inner.point is None:
        return -np.inf
    seen = Certificate.of(program, inner.point, contact)
    if not all(v <= tolerance for v in (seen.equilibrium, seen.yield_violation, seen.cone)):
        return -np.inf
    tension = program.contact.weights @ np.maximum(-inner.point.normal_reaction, 0.0)
    wrong = float(np.abs(out_of_balance(program, inner.point)).sum() + tension)
    power = wrong * float(np.abs(inner.point.velocity).max())
    return inner.point.load_factor - power - _gap(program, inner.point, contact)


def upper_bound(
    program: KinematicProgram,
    inner: InnerSolution,
    tolerance: float,
    contact: FrozenContact | None = None,
) -> float:
    """Return the bound of the velocity of a solve; inf if it proves none.

    The power of the reactions of the solve on the penetration is added.

    Args:
        program: Program of the solve.
        inner: Its answer.
        tolerance: Tolerance for the residuals of the velocity.
        contact: Contact of the solve; None for associated contact.
    """
    rows, contact = program.contact, contact or associated_contact(program.contact)
    if inner.point is None:
        return np.inf
    seen = Certificate.of(program, inner.point, contact)
    if not all(v <= tolerance for v in (seen.penetration, seen.divergence, seen.normalisation)):
        return np.inf
    u = inner.point.velocity
    opening, slip = rows.opening(u), np.linalg.norm(rows.slip(u), axis=1)
    sticks = np.isinf(contact.bound)
    inward = np.where(sticks, np.maximum(slip, -opening), contact.dilatancy * slip - opening)
    pressed = np.maximum(inner.point.normal_reaction, 0.0)
    held = np.linalg.norm(inner.point.tangential_reaction[sticks], axis=1)
    total = float(rows.weights @ pressed) + float(rows.weights[sticks] @ held)
    power = total * float(inward.max(initial=0.0))
    value = kinematic_load_factor(program, inner.point, contact)
    return value + power + _gap(program, inner.point, contact)


def _gap(program: KinematicProgram, point: ProgramState, contact: FrozenContact) -> float:
    """Return the difference of the kinematic and the static value of one solve."""
    return abs(kinematic_load_factor(program, point, contact) - point.load_factor)
