"""Whether a structure carries its dead load by itself, proven either way by one conic program.

    minimise  D(u)/S + |q|   subject to  Fd.u/S + q = 1,  u admissible,   S = sum |Fd|

Its value beta, in [0, 1], is the largest share of the dead load, up to all of it, that stresses and
reactions can carry (T7): the multipliers do. Below 1 the velocity is a mechanism that the dead load
drives, ``Fd.u > D(u)``, and nothing can carry it. The program has a solution whatever the
structure, and each answer is judged by residuals of our own.
"""

from contextlib import closing
from dataclasses import dataclass, replace

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.program.certificate import certify
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.state import ProgramState
from lacore.reporting.showing import Compact
from lacore.solvers.backend import Prepare, checked_answer
from lacore.solvers.inner.own_unknown import with_own_unknown

_SOME = 1e-3  # share, or power of the dead load per S: less is noise of a solver


@dataclass(frozen=True, repr=False)
class Carrying(Compact):
    """What is proven, in the units of the program; at most one of the two.

    Attributes:
        carried: stresses and reactions in equilibrium with the dead load alone, within all
            strengths and friction cones; its velocity and load factor are zero.
        falling: the mechanism of the dead load, ``Fd.u = 1``, with the stresses and reactions that
            carry the largest share of it; its load factor is zero.
        residual: the largest one of what is proven; NaN where nothing is.
    """

    carried: ProgramState | None
    falling: ProgramState | None
    residual: float


def carrying(
    program: KinematicProgram,
    contact: FrozenContact,
    prepare: Prepare,
    tolerance: float,
) -> Carrying:
    """Whether the dead load of a program is carried, without its reference load.

    Args:
        program: dimensionless, homogeneous.
        contact: whose reactions are admissible: associated, for a statement of Coulomb friction.
        prepare: sets an exact backend to work on a program.
        tolerance: bar for the residuals of either proof.
    """
    dead = _weights(program)
    size = float(np.abs(dead).sum())
    if not size > 0:
        unloaded = ProgramState.unstressed(program, np.zeros(program.n), 0.0)
        return Carrying(replace(unloaded, normal_reaction=program.contact.pull), None, 0.0)
    shared, frozen = _shared(program, contact, size)
    with closing(prepare(shared)) as solver:
        point = checked_answer(shared, False, solver.solve(frozen)).point
    if point is None:
        return Carrying(None, None, np.nan)
    static, mechanism = _static(point, size), point.velocity[:-1]
    if (share := point.load_factor) > _SOME:
        carried = replace(static.scaled(1 / share), velocity=np.zeros(program.n))
        seen = certify(_alone(program), carried, contact)
        residual = float(np.max([seen.equilibrium, seen.yield_violation, seen.cone]))
        if residual <= tolerance:
            return Carrying(carried, None, residual)
    driven = float(dead @ mechanism)
    if driven > _SOME * size:
        falling = replace(static, velocity=mechanism / driven)
        residual = _residual_of_fall(program, contact, falling, tolerance)
        if residual <= tolerance:
            return Carrying(None, falling, residual)
    return Carrying(None, None, np.nan)


def _residual_of_fall(
    program: KinematicProgram, contact: FrozenContact, falling: ProgramState, tolerance: float
) -> float:
    """Largest residual of a mechanism; infinite where it takes the power of the dead load."""
    held = program.held_shut
    program = replace(program, reference_load=program.dead_load - held, dead_load=held)
    u, seen = falling.velocity, certify(program, falling, contact)
    taken = program.plastic_dissipation(u) + program.friction_dissipation(u, contact.bound)
    taken -= float(held @ u)
    if not taken < 1 - tolerance:
        return np.inf
    return float(np.max([seen.penetration, seen.divergence, seen.normalisation]))


def _weights(program: KinematicProgram) -> Floats:
    """The dead load without what holds contact shut, which is a strength, shape (n,)."""
    return np.asarray(program.dead_load - program.held_shut)


def _alone(program: KinematicProgram) -> KinematicProgram:
    return replace(program, reference_load=np.zeros(program.n))


def _shared(
    program: KinematicProgram, contact: FrozenContact, size: float
) -> tuple[KinematicProgram, FrozenContact]:
    """The program of the largest share, forces in units of the whole dead load."""
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
    """Stresses and reactions of a solution, without those of its own unknown."""
    own = replace(point, stress=point.stress[:-1], mean_stress=point.mean_stress[:-1])
    return replace(own.scaled(size), load_factor=0.0)
