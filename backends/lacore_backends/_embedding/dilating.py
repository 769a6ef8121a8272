"""Prescribed dilation (T52, S-step) as an additional unknown with a given speed.

The laws of certificates have no prescribed dilation. With one more unknown, whose speed is given
and whose rows are the dilation, the same velocities can be certified.
"""

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_matrix, hstack

from lacore.numerics.arrays import Floats, Sparse
from lacore.program import KinematicProgram
from lacore.program.dissipation import DissipationGroup
from lacore.program.residuals import dilates_besides
from lacore.program.state import ProgramState


def as_moved(
    program: KinematicProgram, state: ProgramState
) -> tuple[KinematicProgram, ProgramState]:
    """Return an equivalent program without prescribed dilation, and its state.

    The program has one more unknown with a given speed. Program and state are returned unchanged if
    nothing has a prescribed dilation.
    """
    if not dilates_besides(program):
        return program, state
    u = state.velocity
    # The additional unknown is no faster than all others.
    speed = float(np.abs(u).max(initial=0.0)) or 1.0
    groups, force = [], 0.0
    for group, mean in zip(program.groups, state.mean_stress, strict=True):
        besides = np.zeros(group.volumetric.shape[0])
        if group.surfaces is not None:
            besides = -group.surfaces.besides / speed
        force += float(group.volume_weights @ (mean * besides))
        groups.append(_with(group, besides))
    contact = program.contact
    rows = replace(
        contact,
        normal=_wide(contact.normal, np.zeros(contact.normal.shape[0])),
        tangential=_wide(contact.tangential, np.zeros(contact.tangential.shape[0])),
    )
    moved = replace(
        program,
        groups=tuple(groups),
        contact=rows,
        reference_load=np.append(program.reference_load, 0.0),
        # The force on the additional unknown balances it.
        dead_load=np.append(program.dead_load, force),
        parts=np.append(program.part, program.part.max(initial=-1) + 1),
    )
    return moved, replace(state, velocity=np.append(u, speed))


def _with(group: DissipationGroup, besides: Floats) -> DissipationGroup:
    surfaces = None if group.surfaces is None else replace(group.surfaces, dilation=None)
    none = np.zeros(group.rows.shape[0])
    return replace(
        group,
        rows=_wide(group.rows, none),
        volumetric=_wide(group.volumetric, besides),
        surfaces=surfaces,
    )


def _wide(rows: Sparse, more: Floats) -> Sparse:
    return csr_matrix(hstack([rows, csr_matrix(more[:, None])]))
