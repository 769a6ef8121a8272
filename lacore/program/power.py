"""Powers of a state: dissipation, dead loads, and the load factor that follows from both (T15)."""

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.program.kinematic import FrozenContact, KinematicProgram, reaction_contact
from lacore.program.state import ProgramState


def kinematic_power(
    program: KinematicProgram, point: ProgramState, contact: FrozenContact | None = None
) -> float:
    """Return the dissipation at a velocity plus the size of the power of the dead loads.

    Args:
        program: In any units.
        point: The velocity, with the reactions that friction depends on.
        contact: Frozen friction bounds; None takes those of the reactions.
    """
    dead = abs(float(program.dead_load @ point.velocity))
    return _dissipation(program, point, contact) + dead


def kinematic_load_factor(
    program: KinematicProgram, point: ProgramState, contact: FrozenContact | None
) -> float:
    """Return the load factor of a velocity by its power balance (T15b).

    Args:
        program: In any units.
        point: The velocity, with the reactions that friction depends on.
        contact: Frozen friction bounds; None takes those of the reactions.
    """
    u, rows = point.velocity, program.contact
    dissipated = _dissipation(program, point, contact)
    closed = float(rows.weights @ (point.normal_reaction * rows.lead))
    return (dissipated + closed - float(program.dead_load @ u)) / float(program.reference_load @ u)


def _dissipation(
    program: KinematicProgram, point: ProgramState, contact: FrozenContact | None
) -> float:
    u = point.velocity
    bound = (contact or reaction_contact(program.contact, point.normal_reaction)).bound
    plastic = program.at_state(u, point.mean_stress).plastic_dissipation(u)
    return plastic + program.friction_dissipation(u, bound)


def largest_power(program: KinematicProgram, velocity: Floats) -> float:
    """Return the power of all cones and dead loads if everything moved at the largest speed."""
    total = float(np.abs(program.dead_load).sum())
    for group in program.groups:
        squares = np.asarray(group.rows.multiply(group.rows).sum(axis=1)).reshape(-1, group.dim)
        strength = group.bound
        if group.surfaces is not None:  # of soils each cone has that of its strongest surface
            strength = group.surfaces.strength.max(axis=1)
        total += float((group.weights * strength) @ np.sqrt(squares.sum(axis=1)))
    return total * float(np.abs(velocity).max(initial=0.0))
