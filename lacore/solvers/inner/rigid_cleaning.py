"""Smallest changes of the velocities of rigid parts that make them admissible.

In scaled units the power of a light block is solved as accurately as that of a heavy one
(`lacore.solvers.inner.rescaling`). Its velocity, power divided by its small force, has an error
that is large compared with the velocities of others.
"""

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_matrix, hstack, vstack

from lacore.numerics.arrays import Floats
from lacore.numerics.linear_program import least
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.part_forces import part_forces
from lacore.program.state import ProgramState

_LIGHTEST = 1e-6  # cost of changes of a light part's velocity; that of a heavy one is 1


def cleaned(program: KinematicProgram, point: ProgramState, contact: FrozenContact) -> ProgramState:
    """Return the state with a velocity without penetration; unchanged if none is found.

    It minimises the sum of changes, each times the force of its part, subject to ``F0.u = 1``,
    ``u_n + s >= d |u_t|`` and no slip where that is excluded. Continua keep their velocities. Only
    rows of one tangential direction are supported (plane problems).
    """
    rows = program.contact
    size = float(np.abs(point.velocity).max(initial=0.0))
    if rows.tangent_dim != 1 or not size > 0:
        return point
    strained = sum(
        (abs(g.rows).sum(axis=0) for g in program.groups), start=np.zeros((1, program.n))
    )
    free = np.flatnonzero(np.asarray(strained).ravel() == 0)
    if not free.size:
        return point
    stick, dilated = (
        np.isinf(contact.bound),
        csr_matrix(rows.tangential.multiply(contact.dilatancy[:, None])),
    )
    inequal = csr_matrix(vstack([rows.normal - dilated, rows.normal + dilated]))
    shift = np.concatenate([contact.shift, contact.shift]) / size
    load = np.abs(program.reference_load).max()
    equal = csr_matrix(vstack([program.reference_load[None, :] / load, rows.tangential[stick]]))
    wanted = np.zeros(equal.shape[0])
    wanted[0] = 1 / (load * size)
    u = point.velocity / size
    forces = part_forces(program, point)
    price = np.maximum(forces / forces.max(), _LIGHTEST)[program.part[free]]
    over, even = inequal[:, free], equal[:, free]
    found = least(
        np.concatenate([price, price]),
        at_most=(csr_matrix(hstack([-over, over])), inequal @ u + shift),
        equal=(csr_matrix(hstack([even, -even])), wanted - equal @ u),
        lower=np.zeros(2 * free.size),
        upper=np.full(2 * free.size, np.inf),
    )
    if found is None:
        return point
    change = np.zeros(program.n)
    more, less = np.split(found, 2)
    change[free] = (more - less) * size
    velocity: Floats = point.velocity + change
    return replace(point, velocity=velocity)
