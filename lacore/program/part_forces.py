"""How large the forces on each part of a structure are: by what its own residuals are judged.

A part is a body, a rigid block or a frame (`KinematicProgram.parts`). A stone of 1 N on a wall of
10 kN may be out of balance altogether, and no residual per total load shows it.
"""

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.program.kinematic import KinematicProgram
from lacore.program.state import ProgramState

_SUMMED = 1e-13  # of the largest force: smaller ones are round-off of sums


def own_loads(program: KinematicProgram, load_factor: float) -> Floats:
    """Sum of the sizes of all loads on each part, shape (parts,)."""
    loads = abs(load_factor) * np.abs(program.reference_load) + np.abs(program.dead_load)
    return np.asarray(np.bincount(program.part, weights=loads, minlength=1), dtype=float)


def part_forces(program: KinematicProgram, state: ProgramState) -> Floats:
    """Sum of the sizes of loads and contact forces on each part, shape (parts,), all > 0.

    No less than the least load on any part: what is out of balance by less on a part that nothing
    loads matters to none.
    """
    rows = program.contact
    pressed = np.abs(rows.weights * state.normal_reaction)
    rubbed = np.abs(rows.weights[:, None] * state.tangential_reaction).ravel()
    normal, tangential = rows.sizes
    touching = normal @ pressed + tangential @ rubbed
    loads = own_loads(program, state.load_factor)
    total = loads + np.bincount(program.part, weights=touching, minlength=1)
    loaded = loads[loads > _SUMMED * loads.max(initial=0.0)]
    least = float(loaded.min()) if loaded.size else float(total.max()) or 1.0
    return np.asarray(np.maximum(total, least))


def forces_at_points(program: KinematicProgram, forces: Floats) -> Floats:
    """The lesser of the forces of the parts that meet at each contact point, shape (m,)."""
    point, unknown = program.contact.meeting
    least = np.full(program.contact.count, float(forces.max(initial=1.0)))
    with np.errstate(invalid="ignore"):  # NaN stays, and is refused
        np.minimum.at(least, point, forces[program.part[unknown]])
    return least
