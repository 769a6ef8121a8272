"""Check that a velocity dissipates nothing, relative to the strength and weight of each part.

A strength of 10 kPa is negligible compared with that of a steel block, and so is the weight of a
stone compared with that of a wall. Sums over a structure therefore do not distinguish a motion
without resistance from a motion against a small one.
"""

import numpy as np
from scipy.sparse import csr_matrix

from lacore.numerics.arrays import Floats, Sparse
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.part_forces import forces_at_points, own_loads, part_forces
from lacore.program.state import ProgramState

NO_POWER = 1e-7
"""Power per stress, length and velocity that counts as zero: interior-point round-off."""


def without_dissipation(
    program: KinematicProgram, state: ProgramState, contact: FrozenContact, tolerance: float
) -> bool:
    """Whether neither strengths, friction nor loads have a power at the velocity of a state.

    Strain rates, and slip against a limit of friction, are relative to the largest velocity. The
    power of friction that follows the reactions, and of dilatancy, is relative to the smaller of
    the forces on the two parts that touch, and the power of loads to the loads. The result is false
    if a value is NaN.

    Args:
        program: Dimensionless program.
        state: State with an admissible velocity.
        contact: Friction bounds and dilatancies of the dissipation.
        tolerance: Tolerance for each ratio.
    """
    u, rows = state.velocity, program.contact
    parts = program.part
    speed = np.zeros(int(parts.max(initial=0)) + 1)
    with np.errstate(invalid="ignore"):  # NaN stays, and is no motion
        np.maximum.at(speed, parts, np.abs(u))
    if not speed.max() > 0:
        return False
    for group in program.groups:
        length = np.sqrt(float(group.weights.sum()))
        strain = np.linalg.norm(group.cone_vectors(u), axis=1)
        if group.surfaces is not None:  # a change of volume is a strain as well
            volume = np.abs(group.volumetric @ u).reshape(strain.size, -1)
            strain = np.maximum(strain, volume.max(axis=1, initial=0.0))
        if not np.all(length * strain <= tolerance * speed.max()):
            return False
    loads = own_loads(program, 0.0)
    scale = float(loads @ speed)
    slip = np.linalg.norm(rows.slip(u), axis=1)
    fastest = _fastest(rows.tangential, rows.tangent_dim, speed[parts])
    strong = np.where(np.isfinite(rows.limit), rows.limit, 0.0) > 0
    if not np.all(slip[strong] <= tolerance * speed.max()):
        return False
    t_n = np.maximum(state.normal_reaction, 0.0)
    bound = np.where(strong | ~np.isfinite(contact.bound), 0.0, contact.bound)
    rubbed = rows.weights * (bound + contact.dilatancy * t_n) * slip
    if scale > 0:
        largest = tolerance * forces_at_points(program, part_forces(program, state)) * fastest
        powers = tolerance * scale
    else:
        powers = NO_POWER * max(1.0, float(speed.max()))
        largest = np.full(rows.count, powers)
    dead = abs(float(program.dead_load @ u))
    weakest = tolerance * _weakest(program, loads)
    return bool(np.all(rubbed <= largest) and dead <= powers and abs(state.load_factor) <= weakest)


def _weakest(program: KinematicProgram, loads: Floats) -> float:
    """Return the least of all strengths, limits of friction and dead loads on parts, or 1.

    A load factor is compared with it. The largest velocity is not a scale for the load factor,
    because the velocity of a mode that no load drives is arbitrary.
    """
    limit = program.contact.limit
    sizes = np.concatenate([*(g.bound for g in program.groups), limit[np.isfinite(limit)], loads])
    return float(sizes[sizes > 0].min()) if np.any(sizes > 0) else 1.0


def _fastest(rows: Sparse, dim: int, speed: Floats) -> Floats:
    """Return the speed of the fastest part that a cone or point belongs to, shape (m,)."""
    own = csr_matrix(abs(rows)).tocoo()
    result = np.zeros(rows.shape[0] // dim)
    np.maximum.at(result, own.row // dim, speed[own.col])
    return result
