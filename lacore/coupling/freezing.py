"""What the steps of loops freeze: friction of contact points and of soils alike (T12, T51, T52).

A point of a soil whose flow is not associated is a contact point with Coulomb friction: its mean
stress, counted from the apex, is the normal reaction, its volumetric rate the opening, and the
difference of both slopes the coefficient. So one vector holds the friction of both.
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
    """A convex problem that stands for one with friction.

    Attributes:
        program: with groups whose flow is associated.
        contact: with what is frozen of contact points.
    """

    program: KinematicProgram
    contact: FrozenContact


def pressing(program: KinematicProgram, state: ProgramState) -> Floats:
    """Normal reactions of contact points, then friction of soils, Pa; all >= 0."""
    reaction = np.maximum(state.normal_reaction, 0.0)
    if not program.frictional:
        return reaction
    return np.concatenate([reaction, program.friction(state.mean_stress)])


def generous(program: KinematicProgram, stress: float) -> Floats:
    """What `pressing` lists with one number, Pa, everywhere."""
    sizes = [group.volumetric.shape[0] for group in program.groups]
    friction = program.friction(tuple(np.zeros(size) for size in sizes))
    return np.full(program.contact.count + friction.size, stress)


def friction_of(program: KinematicProgram, reactions: Floats) -> Floats:
    """Friction bounds of contact points and soils, Pa, from what `pressing` lists."""
    reaction, friction = np.split(reactions, [program.contact.count])
    return np.concatenate([program.contact.coefficient * reaction, friction])


def at_pressing(program: KinematicProgram, reactions: Floats) -> Frozen:
    """Friction frozen at what `pressing` lists: the problem of a K-step."""
    reaction, friction = np.split(reactions, [program.contact.count])
    return Frozen(program.at_friction(friction), reaction_contact(program.contact, reaction))


def at_slip(program: KinematicProgram, velocity: Floats, reactions: Floats) -> Frozen:
    """Slip, flow and hardening frozen at a velocity: the problem of an S-step.

    Args:
        program: as it is stated.
        velocity: of a K-step.
        reactions: what it froze, which says on which surfaces of a soil it flows.
    """
    slip = np.asarray(np.linalg.norm(program.contact.slip(velocity), axis=1))
    friction = reactions[program.contact.count :]
    flowing = program.hardened(velocity).at_flow(velocity, friction)
    return Frozen(flowing, shift_contact(program.contact, slip))


def associated(program: KinematicProgram) -> Frozen:
    """All friction made associated: an upper bound of every load factor (T14, T54)."""
    return Frozen(program.associated(), associated_contact(program.contact))


def frictionless(program: KinematicProgram) -> Frozen:
    """Without friction beside what dilates: a lower bound of every load factor (T14, T54)."""
    return Frozen(without_friction(program), frictionless_contact(program.contact))


def without_friction(program: KinematicProgram) -> KinematicProgram:
    """Return the program without the friction of soils that exceeds their dilation."""
    return program.at_friction(0.0)


def davis(program: KinematicProgram) -> KinematicProgram:
    """The program with Davis's strength of soils and associated flow (T55).

    Raises:
        InputError: no soil whose flow is not associated; one without planes of slip.
    """
    if not program.frictional:
        raise InputError(
            "coupling",
            "davis",
            "flow of all bodies is associated, their strength needs no reduction",
            "give a soil a dilation_angle below its friction_angle, or take 'certified'",
        )
    return replace(program, groups=tuple(group.davis() for group in program.groups))
