"""Prove by one conic program that a structure carries its dead load alone, or that it does not.

    minimise  D(u)/S + |q|   subject to  Fd.u/S + q = 1,  u admissible,   S = sum |Fd|

The value beta, in [0, 1], is the largest share of the dead load that stresses and reactions can
carry (T7); the multipliers are such stresses and reactions. If beta is below 1, the velocity is a
mechanism that the dead load drives, ``Fd.u > D(u)``, and nothing can carry the dead load. The
program has a solution for every structure, and the residuals of each answer are recomputed here.
"""

from contextlib import closing
from dataclasses import dataclass, replace

import numpy as np

from lacore.coupling.constants import SOME_LOAD
from lacore.numerics.arrays import Floats
from lacore.program.certificate import Certificate
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.state import ProgramState
from lacore.reporting.showing import Compact
from lacore.solvers.backend import Prepare, checked_answer
from lacore.solvers.inner.own_unknown import with_own_unknown


@dataclass(frozen=True, repr=False)
class DeadLoadProof(Compact):
    """Proof of at most one of two statements, in the units of the program.

    Attributes:
        equilibrium: Stresses and reactions in equilibrium with the dead load alone, within all
            strengths and friction cones. Velocity and load factor are zero.
        mechanism: Mechanism of the dead load, ``Fd.u = 1``, with the stresses and reactions that
            carry the largest share of it. The load factor is zero.
        residual: Largest residual of the proof; NaN if nothing is proven.
    """

    equilibrium: ProgramState | None
    mechanism: ProgramState | None
    residual: float


def prove_dead_loads(
    program: KinematicProgram,
    contact: FrozenContact,
    prepare: Prepare,
    tolerance: float,
) -> DeadLoadProof:
    """Prove that the dead load alone is carried, or that it is not.

    Args:
        program: Dimensionless, homogeneous program.
        contact: Contact whose reactions are admissible; associated contact for a statement on
            Coulomb friction.
        prepare: Function that prepares an exact backend for a program.
        tolerance: Tolerance for the residuals of either proof.
    """
    dead = _weights(program)
    size = float(np.abs(dead).sum())
    if not size > 0:
        unloaded = ProgramState.unstressed(program, np.zeros(program.n), 0.0)
        return DeadLoadProof(replace(unloaded, normal_reaction=program.contact.pull), None, 0.0)
    shared, frozen = _shared(program, contact, size)
    with closing(prepare(shared)) as solver:
        point = checked_answer(shared, False, solver.solve(frozen)).point
    if point is None:
        return DeadLoadProof(None, None, np.nan)
    static, velocity = _static(point, size), point.velocity[:-1]
    if (share := point.load_factor) > SOME_LOAD:
        equilibrium = replace(static.scaled(1 / share), velocity=np.zeros(program.n))
        seen = Certificate.of(_alone(program), equilibrium, contact)
        residual = float(np.max([seen.equilibrium, seen.yield_violation, seen.cone]))
        if residual <= tolerance:
            return DeadLoadProof(equilibrium, None, residual)
    driven = float(dead @ velocity)
    if driven > SOME_LOAD * size:
        mechanism = replace(static, velocity=velocity / driven)
        residual = _mechanism_residual(program, contact, mechanism, tolerance)
        if residual <= tolerance:
            return DeadLoadProof(None, mechanism, residual)
    return DeadLoadProof(None, None, np.nan)


def _mechanism_residual(
    program: KinematicProgram, contact: FrozenContact, mechanism: ProgramState, tolerance: float
) -> float:
    """Return the largest residual of a mechanism.

    It is infinite if the mechanism dissipates all of the power of the dead load.
    """
    held = program.held_shut
    program = replace(program, reference_load=program.dead_load - held, dead_load=held)
    u, seen = mechanism.velocity, Certificate.of(program, mechanism, contact)
    dissipated = program.plastic_dissipation(u) + program.friction_dissipation(u, contact.bound)
    dissipated -= float(held @ u)
    if not dissipated < 1 - tolerance:
        return np.inf
    return float(np.max([seen.penetration, seen.divergence, seen.normalisation]))


def _weights(program: KinematicProgram) -> Floats:
    """Return the dead load without the tension that holds contact shut, shape (n,).

    That tension is a strength.
    """
    return np.asarray(program.dead_load - program.held_shut)


def _alone(program: KinematicProgram) -> KinematicProgram:
    """Return the program without its reference load."""
    return replace(program, reference_load=np.zeros(program.n))


def _shared(
    program: KinematicProgram, contact: FrozenContact, size: float
) -> tuple[KinematicProgram, FrozenContact]:
    """Return the program of the largest share, with forces in units of the whole dead load."""
    rows = program.contact
    relative = replace(
        program,
        groups=tuple(group.times(1 / size) for group in program.groups),
        contact=replace(
            rows,
            limit=rows.limit / size,
            tension=None if rows.tension is None else rows.tension / size,
        ),
        reference_load=_weights(program) / size,
        dead_load=program.held_shut / size,
    )
    shared = with_own_unknown(relative, "share that is not carried", reference=1.0)
    return shared, replace(contact, bound=contact.bound / size)


def _static(point: ProgramState, size: float) -> ProgramState:
    """Return the stresses and reactions of a solution, without those of the additional unknown."""
    own = replace(point, stress=point.stress[:-1], mean_stress=point.mean_stress[:-1])
    return replace(own.scaled(size), load_factor=0.0)
