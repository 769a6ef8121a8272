"""Whether a velocity dissipates nothing, each part judged by its own strength and weight.

Beside a steel block a floor of 10 kPa looks like none, and beside a wall a stone weightless: no sum
over the structure tells a motion without resistance from one that is only weak.
"""

import numpy as np
from scipy.sparse import csr_matrix

from lacore.numerics.arrays import Floats, Sparse
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.part_forces import forces_at_points, own_loads, part_forces
from lacore.program.state import ProgramState

_NO_POWER = 1e-7  # of stress * length * velocity: what interior-point round-off leaves of a zero


def without_dissipation(
    program: KinematicProgram, state: ProgramState, contact: FrozenContact, tolerance: float
) -> bool:
    """Whether nothing strains, rubs, rises or falls at the velocity of a state; false for NaN.

    Rates are judged per largest velocity, however strong what they would call on; friction that
    follows the reactions, and dilatancy, by the forces on the lesser of the parts that touch;
    powers of loads by the loads.

    Args:
        program: dimensionless.
        state: its velocity is admissible.
        contact: bounds and dilatancies that friction dissipates with.
        tolerance: of each ratio.
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
        if group.surfaces is not None:  # what grows strains, too
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
        powers = _NO_POWER * max(1.0, float(speed.max()))
        largest = np.full(rows.count, powers)
    dead = abs(float(program.dead_load @ u))
    weakest = tolerance * _weakest(program, loads)
    return bool(np.all(rubbed <= largest) and dead <= powers and abs(state.load_factor) <= weakest)


def _weakest(program: KinematicProgram, loads: Floats) -> float:
    """The least of all strengths, limits of friction and dead loads on parts; 1 without any.

    What a load factor is judged by. The largest velocity is no scale for it: a mode that no load
    drives may have any.
    """
    limit = program.contact.limit
    sizes = np.concatenate([*(g.bound for g in program.groups), limit[np.isfinite(limit)], loads])
    return float(sizes[sizes > 0].min()) if np.any(sizes > 0) else 1.0


def _fastest(rows: Sparse, dim: int, speed: Floats) -> Floats:
    """Speed of the fastest part that a cone or point moves with, shape (m,)."""
    own = csr_matrix(abs(rows)).tocoo()
    result = np.zeros(rows.shape[0] // dim)
    np.maximum.at(result, own.row // dim, speed[own.col])
    return result
