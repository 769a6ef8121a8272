"""Projection of velocities onto exact kinematic admissibility (T26c).

The nearest velocity without divergence, penetration and forbidden slip, ``min ||du||`` subject to
``A (u + du) = 0``, is one sparse solve with ``A A^T``. Dependent rows (theta around a crossing of
edges) get a shift, whose effect refinement removes.
"""

import numpy as np
from scipy.sparse import csr_matrix, diags_array, eye_array, vstack

from lacore.bounds.constants import (
    CLOSE_CONTACT,
    PENETRATION,
    PROJECTIONS,
)
from lacore.numerics.arrays import Bools, Floats, Sparse
from lacore.numerics.linear_algebra import SingularError, SymmetricSolver
from lacore.numerics.symmetric import factorised
from lacore.program.constants import FINISHED, REFINEMENTS, SHIFT
from lacore.program.kinematic import KinematicProgram


def admissible_velocity(program: KinematicProgram, velocity: Floats) -> Floats:
    """Return the nearest admissible velocity with ``F0.u = 1``, to round-off; else the closest one.

    Args:
        program: dimensionless program.
        velocity: almost admissible velocity, shape (n,).
    """
    contact = program.contact
    fastest = float(np.abs(velocity).max())
    close = _beyond(program, velocity) > -CLOSE_CONTACT * fastest
    rests = np.isinf(contact.limit)  # mask of points, as all masks here
    rests |= (
        close & (contact.dilatancy > 0) & (_sliding(program, velocity) < CLOSE_CONTACT * fastest)
    )
    moved = velocity
    for _ in range(PROJECTIONS):
        moved = _nearest(_conditions(program, velocity, close, rests), velocity)
        wrong = _beyond(program, moved) > PENETRATION * fastest
        if not np.any(wrong & ~(close & (rests | (contact.dilatancy == 0)))):
            break
        # Slip that was noise has reversed, or an open contact has closed, so there is no motion.
        close, rests = close | wrong, rests | (wrong & (contact.dilatancy > 0))
    return moved / float(program.reference_load @ moved)


def _sliding(program: KinematicProgram, velocity: Floats) -> Floats:
    """Return the slip rates of contact points, shape (m,)."""
    return np.asarray(np.linalg.norm(program.contact.slip(velocity), axis=1))


def _beyond(program: KinematicProgram, velocity: Floats) -> Floats:
    """Return the penetration of contact points against the dilation of their slip, shape (m,)."""
    contact = program.contact
    dilated = contact.dilatancy * _sliding(program, velocity)
    return np.asarray(dilated - contact.opening(velocity))


def _nearest(rows: Sparse, velocity: Floats) -> Floats:
    """Return the nearest velocity on which all rows vanish, to round-off if that is possible."""
    length = np.sqrt(np.asarray(rows.multiply(rows).sum(axis=1)).ravel())
    rows = csr_matrix(diags_array(1 / length[length > 0]) @ rows[length > 0])
    matrix = csr_matrix(rows @ rows.T + SHIFT * eye_array(rows.shape[0], format="csr"))
    matrix.sort_indices()
    if not rows.shape[0]:
        return velocity
    try:
        solver = factorised(matrix)
    except SingularError:
        return velocity  # The residual shows the result.
    try:
        return _projected(rows, velocity, solver)
    finally:
        solver.close()


def _projected(rows: Sparse, velocity: Floats, solver: SymmetricSolver) -> Floats:
    wrong = rows @ velocity
    for _ in range(REFINEMENTS):
        moved = velocity - rows.T @ solver.solve(wrong)
        left = rows @ moved
        if not np.abs(left).max() < np.abs(wrong).max():
            break
        done = np.abs(left).max() > FINISHED * np.abs(wrong).max()
        velocity, wrong = moved, left
        if done:
            break
    return velocity


def _conditions(program: KinematicProgram, velocity: Floats, close: Bools, rests: Bools) -> Sparse:
    """Return the rows that must be zero: slip at resting contact, penetration, divergence.

    Divergence counts only where strength does not depend on pressure. Contact that is clearly open
    has no effect. Contact that is hardly open counts as closed, because dependent rows of a body
    that is held on all sides are contradictory unless all require zero. Where dilatant points slip,
    the cone of their law is one of its faces, or in three dimensions its plane in the direction of
    slip; where they hardly slip, they stick.

    Args:
        program: dimensionless program.
        velocity: velocity whose slip determines the face.
        close: contact points that touch, shape (m,).
        rests: those that do not slip, shape (m,).
    """
    contact = program.contact
    parts = [
        *(group.volumetric for group in program.groups if group.surfaces is None),
        contact.tangential[np.repeat(rests, contact.tangent_dim)],
        csr_matrix(contact.normal - _dilating(program, velocity))[close],
    ]
    rows = csr_matrix(vstack(parts, format="csr"))
    return csr_matrix(rows[np.asarray(abs(rows).sum(axis=1)).ravel() > 0])


def _dilating(program: KinematicProgram, velocity: Floats) -> Sparse:
    """Return the rows of the opening of contact by slip along its direction, shape (m, n)."""
    contact = program.contact
    slip, size = contact.slip(velocity), _sliding(program, velocity)
    along = slip / np.where(size > 0, size, 1.0)[:, None]
    count, d = along.shape
    entries = ((contact.dilatancy[:, None] * along).ravel(), np.arange(count * d))
    start = d * np.arange(count + 1)
    return csr_matrix(csr_matrix((*entries, start), (count, count * d)) @ contact.tangential)
