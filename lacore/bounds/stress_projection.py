"""Projection of stresses onto exact equilibrium (T26c).

The nearest stresses in equilibrium, ``min sum w (||ds||^2 + dp^2)``, are the elastic stresses
``ds = D v, dp = theta v`` of the velocity v that the forces out of balance drive: one sparse solve.
Reactions move too, the less the closer they are to the tip of their cone, so that none leaves it.
The load factor stays, unless statics alone fixes it. It is floating point, not interval arithmetic:
"exact" is round-off.
"""

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_matrix, diags_array, eye_array

from lacore.arrays import Floats, Sparse
from lacore.numerics.linear_algebra import SingularError, SuperLU
from lacore.program import KinematicProgram
from lacore.state import ProgramState, out_of_balance

# Multipliers of redundant rows (tractions at a vertex in which facets are in line) have no
# stiffness; this share of the diagonal lets the factorisation pass, and refinement undoes it.
_SHIFT = 1e-11
_REFINEMENTS = 5
# Of the load factor, dimensionless: far above the stiffness of a body against its load, of order
# one, far below that of a mode without any, 1/_SHIFT.
_STIFF_LOAD = 1e6
# Of the largest stiffness: no stress feels an unknown below it, such as a smooth footing that moves
# along its own face; far below what the shift adds.
_NOTHING = 1e-30
_FINISHED = 0.5  # a refinement that leaves more than this of the forces has come to round-off


def in_equilibrium(program: KinematicProgram, state: ProgramState) -> ProgramState:
    """The state with stresses and reactions moved into equilibrium; else unchanged.

    Args:
        program: dimensionless.
        state: close to equilibrium, reactions inside their cones.
    """
    normal, tangential = _mobility(program, state)
    stiffness = _stiffness(program, normal, tangential)
    diagonal = stiffness.diagonal()
    most = float(diagonal.max(initial=0.0)) or 1.0
    # A block that nothing rubs has no stiffness along its base, and there any scale will do.
    scale = 1 / np.sqrt(np.where(diagonal > _NOTHING * most, diagonal, most))
    scaled = csr_matrix(diags_array(scale) @ stiffness @ diags_array(scale))
    matrix = csr_matrix(scaled + _SHIFT * eye_array(program.n, format="csr"))
    matrix.sort_indices()
    solver = SuperLU()  # once: others are still loading when it is through
    try:
        solver.factorise(matrix)

        def driven(force: Floats) -> Floats:
            return np.asarray(scale * solver.solve(scale * force))

        reference, force = driven(program.reference_load), out_of_balance(program, state)
        give = float(program.reference_load @ reference) + _STIFF_LOAD
        for _ in range(_REFINEMENTS):
            velocity = driven(-force)
            more = -float(program.reference_load @ velocity) / give
            moved = _moved(program, state, velocity + more * reference, normal, tangential)
            moved = replace(moved, load_factor=state.load_factor + more)
            left = out_of_balance(program, moved)
            if not np.abs(left).max() < np.abs(force).max():
                break
            done = np.abs(left).max() > _FINISHED * np.abs(force).max()
            state, force = moved, left
            if done:
                break
    except SingularError:
        pass  # what is left out of balance tells
    finally:
        solver.close()
    return state


def _mobility(program: KinematicProgram, state: ProgramState) -> tuple[Floats, Floats]:
    """Squares of how far reactions may move: normal (m,), tangential (m tangent_dim,).

    In units of the largest of them: what carries a body far stronger than its weight must not be
    soft beside the body, or its rigid motions drown in the shift.
    """
    rows = program.contact
    t_n = np.minimum(np.maximum(state.normal_reaction, 0.0), 1.0)
    room = np.minimum(rows.limit + rows.dilatancy * np.maximum(state.normal_reaction, 0.0), 1.0)
    unit = max(t_n.max(initial=0.0), room.max(initial=0.0)) or 1.0
    return (t_n / unit) ** 2, np.repeat((room / unit) ** 2, rows.tangent_dim)


def _stiffness(program: KinematicProgram, normal: Floats, tangential: Floats) -> Sparse:
    total = csr_matrix((program.n, program.n))
    for group in program.groups:
        for rows, dim in ((group.rows, group.dim), (group.volumetric, group.volumes)):
            weights = np.repeat(group.weights, dim)
            total = csr_matrix(total + rows.T @ (diags_array(weights) @ rows))
    contact = program.contact
    for rows, mobility, dim in (
        (contact.normal, normal, 1),
        (contact.tangential, tangential, contact.tangent_dim),
    ):
        weights = mobility * np.repeat(contact.weights, dim)
        total = csr_matrix(total + rows.T @ (diags_array(weights) @ rows))
    return total


def _moved(
    program: KinematicProgram,
    state: ProgramState,
    velocity: Floats,
    normal: Floats,
    tangential: Floats,
) -> ProgramState:
    """The state with the elastic stresses of a velocity."""
    contact = program.contact
    slip = (tangential * (contact.tangential @ velocity)).reshape(-1, contact.tangent_dim)
    return replace(
        state,
        stress=tuple(
            stress + group.cone_vectors(velocity)
            for stress, group in zip(state.stress, program.groups, strict=True)
        ),
        mean_stress=tuple(
            mean + group.volumetric @ velocity
            for mean, group in zip(state.mean_stress, program.groups, strict=True)
        ),
        normal_reaction=state.normal_reaction - normal * contact.opening(velocity),
        tangential_reaction=state.tangential_reaction - slip,
    )
