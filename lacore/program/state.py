"""Primal and dual variables of a kinematic program (T7), in the units of the program."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.program.kinematic import KinematicProgram
from lacore.reporting.showing import Compact

_NO_POWER = 1e-12  # of the sum of sizes: the round-off in a power that vanishes


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

    @classmethod
    def unstressed(
        cls, program: KinematicProgram, velocity: Floats, load_factor: float
    ) -> "ProgramState":
        """Return a velocity of a program without stresses and reactions."""
        rows = program.contact
        return cls(
            velocity=velocity,
            load_factor=load_factor,
            stress=tuple(np.zeros((group.weights.size, group.dim)) for group in program.groups),
            mean_stress=tuple(np.zeros(group.volumetric.shape[0]) for group in program.groups),
            normal_reaction=np.zeros(rows.count),
            tangential_reaction=np.zeros((rows.count, rows.tangent_dim)),
        )

    def scaled(
        self, stress: float, *, load_factor: float = 1.0, velocity: float = 1.0
    ) -> "ProgramState":
        """Return the state with stresses and reactions, load factor and velocity multiplied."""
        return ProgramState(
            velocity=velocity * self.velocity,
            load_factor=load_factor * self.load_factor,
            stress=tuple(stress * own for own in self.stress),
            mean_stress=tuple(stress * own for own in self.mean_stress),
            normal_reaction=stress * self.normal_reaction,
            tangential_reaction=stress * self.tangential_reaction,
        )

    def plus(self, other: "ProgramState", factor: float) -> "ProgramState":
        """Return the velocity with load factor, stresses and reactions of a sum of two states."""
        sums = [
            tuple(own + factor * added for own, added in zip(mine, theirs, strict=True))
            for mine, theirs in (
                (self.stress, other.stress),
                (self.mean_stress, other.mean_stress),
            )
        ]
        return ProgramState(
            velocity=self.velocity,
            load_factor=self.load_factor + factor * other.load_factor,
            stress=sums[0],
            mean_stress=sums[1],
            normal_reaction=self.normal_reaction + factor * other.normal_reaction,
            tangential_reaction=self.tangential_reaction + factor * other.tangential_reaction,
        )


def misfit(program: KinematicProgram, state: ProgramState) -> str:
    """Return the first part of a state that has another shape than in a program, or nothing."""
    groups = len(program.groups)
    for given in (state.stress, state.mean_stress):
        if len(given) != groups:
            return f"stresses for {len(given)} of {groups} groups"
    for name, values, shape in _parts(program, state):
        own = np.asarray(values).shape
        if own != shape:
            return f"a {name} of shape {own} instead of {shape}"
    return ""


def fault_of_point(program: KinematicProgram, state: ProgramState) -> str:
    """Return why a state is no solution of a program, whatever its residuals; empty if it may be.

    A solution has the shapes of the program, finite numbers, and a velocity on which the reference
    load does work.
    """
    if found := misfit(program, state):
        return found
    for name, values, _ in _parts(program, state):
        array = np.asarray(values)
        if array.dtype.kind not in "fiu" or not np.isfinite(array).all():
            return f"a {name} with NaN, infinity or no numbers at all"
    power = float(program.reference_load @ state.velocity)
    size = float(np.abs(program.reference_load) @ np.abs(state.velocity))
    if not abs(power) > _NO_POWER * size:
        return f"a velocity with F0.U = {power:.3g}, where the program requires F0.U = 1"
    return ""


def _parts(
    program: KinematicProgram, state: ProgramState
) -> Iterator[tuple[str, object, tuple[int, ...]]]:
    """Yield the name, the numbers and the required shape of all parts of a state.

    The state has as many groups of stresses as the program.
    """
    contact = program.contact
    yield "velocity", state.velocity, (program.n,)
    yield "load_factor", state.load_factor, ()
    yield "normal_reaction", state.normal_reaction, (contact.count,)
    yield "tangential_reaction", state.tangential_reaction, (contact.count, contact.tangent_dim)
    for group, stress, mean in zip(program.groups, state.stress, state.mean_stress, strict=True):
        yield f"stress of {group.name!r}", stress, (group.weights.size, group.dim)
        yield f"mean_stress of {group.name!r}", mean, (group.volumetric.shape[0],)


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
