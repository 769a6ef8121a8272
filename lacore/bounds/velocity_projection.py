"""Projection of velocities onto exact kinematic admissibility (T26c).

The nearest velocity without divergence, penetration and forbidden slip, ``min ||du||`` subject to
``A (u + du) = 0``, is one sparse solve with ``A A^T``. Rows that depend on each other (theta around
a crossing of edges) get a shift, which refinement undoes.
"""

import numpy as np
from scipy.sparse import csr_matrix, diags_array, eye_array, vstack

from lacore.numerics.arrays import Bools, Floats, Sparse
from lacore.numerics.linear_algebra import SingularError, SymmetricSolver
from lacore.numerics.symmetric import factorised
from lacore.program.kinematic import KinematicProgram

_SHIFT = 1e-11  # of rows of length 1
_REFINEMENTS = 5
_FINISHED = 0.5  # a refinement that leaves more than this has come to round-off
_ROUND_OFF = 1e-13  # of the largest speed: penetration that is none
_ROUNDS = 4  # of projections, each with what the one before has closed
_CLOSE = 1e-6  # of the largest speed: contact that could be lost by the projection


def admissible_velocity(program: KinematicProgram, velocity: Floats) -> Floats:
    """The nearest admissible velocity with ``F0.u = 1``, to round-off; else what came closest.

    Args:
        program: dimensionless.
        velocity: almost admissible, shape (n,).
    """
    contact = program.contact
    fastest = float(np.abs(velocity).max())
    close = _beyond(program, velocity) > -_CLOSE * fastest
    rests = np.isinf(contact.limit)  # of points, as all masks here
    rests |= close & (contact.dilatancy > 0) & (_sliding(program, velocity) < _CLOSE * fastest)
    moved = velocity
    for _ in range(_ROUNDS):
        moved = _nearest(_conditions(program, velocity, close, rests), velocity)
        wrong = _beyond(program, moved) > _ROUND_OFF * fastest
        if not np.any(wrong & ~(close & (rests | (contact.dilatancy == 0)))):
            break
        # Slip that was noise has turned round, or what was open has closed: no motion there.
        close, rests = close | wrong, rests | (wrong & (contact.dilatancy > 0))
    return moved / float(program.reference_load @ moved)


def _sliding(program: KinematicProgram, velocity: Floats) -> Floats:
    """How fast contact points slip, shape (m,)."""
    return np.asarray(np.linalg.norm(program.contact.slip(velocity), axis=1))


def _beyond(program: KinematicProgram, velocity: Floats) -> Floats:
    """How far contact points penetrate, against what their slip dilates, shape (m,)."""
    contact = program.contact
    dilated = contact.dilatancy * _sliding(program, velocity)
    return np.asarray(dilated - contact.opening(velocity))


def _nearest(rows: Sparse, velocity: Floats) -> Floats:
    """The nearest velocity on which all rows vanish, to round-off if that can be."""
    length = np.sqrt(np.asarray(rows.multiply(rows).sum(axis=1)).ravel())
    rows = csr_matrix(diags_array(1 / length[length > 0]) @ rows[length > 0])
    matrix = csr_matrix(rows @ rows.T + _SHIFT * eye_array(rows.shape[0], format="csr"))
    matrix.sort_indices()
    if not rows.shape[0]:
        return velocity
    try:
        solver = factorised(matrix)
    except SingularError:
        return velocity  # what is left tells
    try:
        return _projected(rows, velocity, solver)
    finally:
        solver.close()


def _projected(rows: Sparse, velocity: Floats, solver: SymmetricSolver) -> Floats:
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


def _conditions(program: KinematicProgram, velocity: Floats, close: Bools, rests: Bools) -> Sparse:
    """Rows that must be zero: no slip where contact rests, no penetration, no divergence.

    Divergence only where strength feels no pressure. Contact that is open by far plays no part;
    where it hardly is, it is closed: rows that depend on each other, of a body that is held all
    around, contradict unless all ask for zero. Where dilatant points slip, the cone of their law is
    one of its faces, in space its plane at the direction of slip; where they hardly do, they stick.

    Args:
        program: dimensionless.
        velocity: whose slip says which face.
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
    """Rows of how fast contact opens by slip along its direction, shape (m, n)."""
    contact = program.contact
    slip, size = contact.slip(velocity), _sliding(program, velocity)
    along = slip / np.where(size > 0, size, 1.0)[:, None]
    count, d = along.shape
    entries = ((contact.dilatancy[:, None] * along).ravel(), np.arange(count * d))
    start = d * np.arange(count + 1)
    return csr_matrix(csr_matrix((*entries, start), (count, count * d)) @ contact.tangential)
