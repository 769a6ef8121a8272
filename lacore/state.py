"""Primal and dual variables of a kinematic program (T7), in the units of the program."""

from dataclasses import dataclass

import numpy as np

from lacore.arrays import Floats
from lacore.program import KinematicProgram
from lacore.showing import Compact


@dataclass(frozen=True, repr=False)
class ProgramState(Compact):
    """A velocity and the stresses and reactions that go with it.

    Signs: tension positive in the body; ``normal_reaction >= 0`` is compression on the slave;
    ``tangential_reaction`` acts on the slave, against its slip.

    Attributes:
        velocity: U, shape (n,).
        load_factor: alpha, the multiplier of ``F0.U = 1``.
        stress: conjugate of each group's cone rows, shape (m, dim) each.
        mean_stress: conjugate of each group's volumetric rows, shape (m,) each, (m L,) of surfaces
            that feel L of them.
        normal_reaction: t_n at the contact points, shape (m,).
        tangential_reaction: t_t, shape (m, tangent_dim).
    """

    velocity: Floats
    load_factor: float
    stress: tuple[Floats, ...]
    mean_stress: tuple[Floats, ...]
    normal_reaction: Floats
    tangential_reaction: Floats


def internal_force(program: KinematicProgram, state: ProgramState) -> Floats:
    """Nodal forces of the stresses, shape (n,)."""
    total = np.zeros(program.n)
    for group, stress, mean in zip(program.groups, state.stress, state.mean_stress, strict=True):
        total += group.rows.T @ (group.weights[:, None] * stress).ravel()
        total += group.volumetric.T @ (group.volume_weights * mean)
    return total


def contact_force(program: KinematicProgram, state: ProgramState) -> Floats:
    """Nodal forces of the contact tractions on the body, shape (n,)."""
    contact = program.contact
    weighted = contact.weights[:, None] * state.tangential_reaction
    return np.asarray(
        contact.normal.T @ (contact.weights * state.normal_reaction)
        + contact.tangential.T @ weighted.ravel()
    )


def out_of_balance(program: KinematicProgram, state: ProgramState) -> Floats:
    """Internal less external nodal forces, shape (n,): zero in equilibrium (T7)."""
    return (
        internal_force(program, state)
        - contact_force(program, state)
        - state.load_factor * program.reference_load
        - program.dead_load
    )
