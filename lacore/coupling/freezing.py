"""Convex problems of the steps of a loop, with frozen friction (T12, T51, T52).

A point of a soil with non-associated flow is like a contact point with Coulomb friction: the mean
stress measured from the apex is the normal reaction, the volumetric strain rate the opening, and
the difference of both slopes the friction coefficient. One vector therefore lists the friction of
contact and soils.
"""

from dataclasses import dataclass, replace

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.program.kinematic import (
    FrozenContact,
    KinematicProgram,
    associated_contact,
    frictionless_contact,
    reaction_contact,
    shift_contact,
)
from lacore.program.state import ProgramState
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact


@dataclass(frozen=True, repr=False)
class Frozen(Compact):
    """A convex problem in place of one with friction.

    Attributes:
        program: Program whose groups have associated flow.
        contact: Frozen contact.
    """

    program: KinematicProgram
    contact: FrozenContact


def pressing(program: KinematicProgram, state: ProgramState) -> Floats:
    """Return the normal reactions of contact points, then the friction of soils, Pa; all >= 0."""
    reaction = np.maximum(state.normal_reaction, 0.0)
    if not program.frictional:
        return reaction
    return np.concatenate([reaction, program.friction(state.mean_stress)])


def generous(program: KinematicProgram, stress: float) -> Floats:
    """Return an array like that of `pressing` with one value, Pa, everywhere."""
    sizes = [group.volumetric.shape[0] for group in program.groups]
    friction = program.friction(tuple(np.zeros(size) for size in sizes))
    return np.full(program.contact.count + friction.size, stress)


def friction_of(program: KinematicProgram, reactions: Floats) -> Floats:
    """Return the friction bounds of contact points and soils, Pa, for an array of `pressing`."""
    reaction, friction = np.split(reactions, [program.contact.count])
    return np.concatenate([program.contact.coefficient * reaction, friction])


def at_pressing(program: KinematicProgram, reactions: Floats) -> Frozen:
    """Return the problem of a K-step, with friction frozen at an array of `pressing`."""
    reaction, friction = np.split(reactions, [program.contact.count])
    return Frozen(program.at_friction(friction), reaction_contact(program.contact, reaction))


def at_slip(program: KinematicProgram, velocity: Floats, reactions: Floats) -> Frozen:
    """Return the problem of an S-step, with slip, flow and hardening frozen at a velocity.

    Args:
        program: Program of the loop.
        velocity: Velocity of a K-step.
        reactions: Array that the K-step froze, which determines the surfaces on which a soil flows.
    """
    slip = np.asarray(np.linalg.norm(program.contact.slip(velocity), axis=1))
    friction = reactions[program.contact.count :]
    flowing = program.hardened(velocity).at_flow(velocity, friction)
    return Frozen(flowing, shift_contact(program.contact, slip))


def associated(program: KinematicProgram) -> Frozen:
    """Make all friction associated, which gives an upper bound of every load factor (T14, T54)."""
    return Frozen(program.associated(), associated_contact(program.contact))


def frictionless(program: KinematicProgram) -> Frozen:
    """Remove friction without dilation: a lower bound of every load factor (T14, T54)."""
    return Frozen(without_friction(program), frictionless_contact(program.contact))


def without_friction(program: KinematicProgram) -> KinematicProgram:
    """Return the program without the friction of soils that exceeds their dilation."""
    return program.at_friction(0.0)


def davis(program: KinematicProgram) -> KinematicProgram:
    """Return the program with Davis's strength of soils and associated flow (T55).

    Raises:
        InputError: No soil has non-associated flow, or one has no planes of slip.
    """
    if not program.frictional:
        raise InputError(
            "coupling",
            "davis",
            "flow of all bodies is associated, their strength needs no reduction",
            "give a soil a dilation_angle below its friction_angle, or take 'certified'",
        )
    return replace(program, groups=tuple(group.davis() for group in program.groups))
