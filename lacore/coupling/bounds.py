"""Bounds of every Coulomb load factor of a program, from admissible halves of states (T14).

Of a discrete program: its frictionless value may lie above the load factors of the continuum, whose
bounds are those of `lacore.analyses.ranges.continuum`.
"""

import numpy as np

from lacore.coupling.claims.locking_ray import locking_ray
from lacore.program.certificate import certify
from lacore.program.kinematic import (
    FrozenContact,
    KinematicProgram,
    associated_contact,
    frictionless_contact,
    reaction_contact,
)
from lacore.program.state import ProgramState, out_of_balance
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution


def lower_bound(program: KinematicProgram, inner: InnerSolution, tolerance: float) -> float:
    """Bound from stresses and reactions of a solve without friction; -inf where they prove none.

    Less by the power of what is out of balance and of tensions, at the solve's own velocity; inf
    where reactions carry the reference load alone.
    """
    contact = frictionless_contact(program.contact)
    if inner.status is Status.LOCKED:
        ray = locking_ray(program, contact)
        return np.inf if ray is not None and ray.proves else -np.inf
    if inner.point is None:
        return -np.inf
    seen = certify(program, inner.point, contact)
    if not all(v <= tolerance for v in (seen.equilibrium, seen.yield_violation, seen.cone)):
        return -np.inf
    tension = program.contact.weights @ np.maximum(-inner.point.normal_reaction, 0.0)
    wrong = float(np.abs(out_of_balance(program, inner.point)).sum() + tension)
    power = wrong * float(np.abs(inner.point.velocity).max())
    return inner.point.load_factor - power - _gap(program, inner.point, contact)


def upper_bound(program: KinematicProgram, inner: InnerSolution, tolerance: float) -> float:
    """Bound from the velocity of an associated solve; inf where it proves none.

    More by the power of the solve's own reactions on what it penetrates.
    """
    rows, contact = program.contact, associated_contact(program.contact)
    if inner.point is None:
        return np.inf
    seen = certify(program, inner.point, contact)
    if not all(v <= tolerance for v in (seen.penetration, seen.divergence, seen.normalisation)):
        return np.inf
    u = inner.point.velocity
    inward = contact.dilatancy * np.linalg.norm(rows.slip(u), axis=1) - rows.opening(u)
    pressed = float(rows.weights @ np.maximum(inner.point.normal_reaction, 0.0))
    power = pressed * float(inward.max(initial=0.0))
    value = kinematic_load_factor(program, inner.point, contact)
    return value + power + _gap(program, inner.point, contact)


def kinematic_load_factor(
    program: KinematicProgram, point: ProgramState, contact: FrozenContact | None
) -> float:
    """Load factor of a velocity, re-evaluated from it (T15b), friction at the reactions of `point`.

    With `contact` given, friction at its bounds instead.
    """
    u, rows = point.velocity, program.contact
    bound = (contact or reaction_contact(program.contact, point.normal_reaction)).bound
    plastic = program.at_state(u, point.mean_stress).plastic_dissipation(u)
    dissipated = plastic + program.friction_dissipation(u, bound)
    closed = float(rows.weights @ (point.normal_reaction * rows.lead))
    return (dissipated + closed - float(program.dead_load @ u)) / float(program.reference_load @ u)


def kinematic_power(program: KinematicProgram, point: ProgramState) -> float:
    """Power that a state turns over: the scale of (T15)."""
    u = point.velocity
    bound = reaction_contact(program.contact, point.normal_reaction).bound
    plastic = program.at_state(u, point.mean_stress).plastic_dissipation(u)
    dissipated = plastic + program.friction_dissipation(u, bound)
    return dissipated + abs(float(program.dead_load @ u))


def _gap(program: KinematicProgram, point: ProgramState, contact: FrozenContact) -> float:
    """Between the kinematic and the static value of one solve."""
    return abs(kinematic_load_factor(program, point, contact) - point.load_factor)
