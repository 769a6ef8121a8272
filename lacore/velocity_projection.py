"""Projection of velocities onto exact kinematic admissibility (T26c).

The nearest velocity without divergence, penetration and forbidden slip, ``min ||du||`` subject to
``A (u + du) = 0``, is one sparse solve with ``A A^T``. Rows that depend on each other (theta around
a crossing of edges) get a shift, which refinement undoes.
"""

import numpy as np
from scipy.sparse import csr_matrix, diags_array, eye_array, vstack

from lacore.arrays import Floats, Sparse
from lacore.linear_algebra import SingularError, SuperLU
from lacore.program import KinematicProgram

_SHIFT = 1e-11  # of rows of length 1
_REFINEMENTS = 5
_FINISHED = 0.5  # a refinement that leaves more than this has come to round-off
_CLOSE = 1e-6  # of the largest speed: contact that could be lost by the projection


def admissible_velocity(program: KinematicProgram, velocity: Floats) -> Floats:
    """The nearest admissible velocity with ``F0.u = 1``, to round-off; else what came closest.

    Args:
        program: dimensionless.
        velocity: almost admissible, shape (n,).
    """
    rows = _conditions(program, velocity)
    length = np.sqrt(np.asarray(rows.multiply(rows).sum(axis=1)).ravel())
    rows = csr_matrix(diags_array(1 / length) @ rows)
    matrix = csr_matrix(rows @ rows.T + _SHIFT * eye_array(rows.shape[0], format="csr"))
    matrix.sort_indices()
    solver = SuperLU()
    try:
        if rows.shape[0]:
            solver.factorise(matrix)
            velocity = _projected(rows, velocity, solver)
    except SingularError:
        pass  # what is left tells
    finally:
        solver.close()
    return velocity / float(program.reference_load @ velocity)


def _projected(rows: Sparse, velocity: Floats, solver: SuperLU) -> Floats:
    wrong = rows @ velocity
    for _ in range(_REFINEMENTS):
        moved = velocity - rows.T @ solver.solve(wrong)
        left = rows @ moved
        if not np.abs(left).max() < np.abs(wrong).max():
            break
        done = np.abs(left).max() > _FINISHED * np.abs(wrong).max()
        velocity, wrong = moved, left
        if done:
            break
    return velocity


def _conditions(program: KinematicProgram, velocity: Floats) -> Sparse:
    """Rows that must be zero: no divergence, no slip that sticks, no penetration.

    Contact that is open by far plays no part; where it hardly is, it is closed: rows that depend
    on each other, of a body that is held all around, contradict unless all ask for zero. Where
    dilatant points slip, the cone of their law is one of its faces; where they hardly do, they
    stick.
    """
    contact = program.contact
    opening, slip = contact.opening(velocity), contact.slip(velocity)[:, 0]
    fastest = float(np.abs(velocity).max())
    stick = np.isinf(contact.limit)
    close = opening - contact.dilatancy * np.abs(slip) < _CLOSE * fastest
    slow = close & (contact.dilatancy > 0) & (np.abs(slip) < _CLOSE * fastest)
    face = diags_array(contact.dilatancy * np.sign(slip)) @ contact.tangential
    parts = [
        *(group.volumetric for group in program.groups),
        contact.tangential[stick | slow],
        csr_matrix(contact.normal - face)[close],
    ]
    rows = csr_matrix(vstack(parts, format="csr"))
    return csr_matrix(rows[np.asarray(abs(rows).sum(axis=1)).ravel() > 0])
