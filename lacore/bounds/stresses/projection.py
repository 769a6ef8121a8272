"""Projection of stresses onto exact equilibrium (T26c).

The nearest stresses in equilibrium, ``min sum (||ds||^2 + dp^2)`` over points, are the stresses
``ds = w D v, dp = w theta v`` of the velocity v that the forces out of balance drive: one sparse
solve. Points count alike whatever their weight w: what a solver leaves of nodal forces is alike on
all elements, and where least weights are left to yield first, least elements pay for the others.
Where that proves nothing they count by their weights.
Reactions move too, the less the closer they are to the tip of their cone, so that none leaves it.
The load factor stays, unless statics alone fixes it. It is floating point, not interval arithmetic:
"exact" is round-off.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from scipy.sparse import csr_matrix, diags_array, eye_array

from lacore.numerics.arrays import Floats, Sparse
from lacore.numerics.linear_algebra import SingularError
from lacore.numerics.symmetric import factorised
from lacore.program.kinematic import KinematicProgram
from lacore.program.state import ProgramState, out_of_balance

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


Moves = Callable[[Floats], Floats]
"""From weights of points per their mean to how far stresses move, per strain rate."""


def alike(weights: Floats) -> Floats:
    """Points count alike in what is least."""
    return weights


def by_area(weights: Floats) -> Floats:
    """Points count by their weights: least ones move as far as others for the same strain rate.

    On slivers of a soil of next to no cohesion that is what leaves stresses within strength.
    """
    return np.ones_like(weights)


class Balancing(Protocol):
    """What moves stresses and reactions into equilibrium."""

    def __call__(self, state: ProgramState, refinements: int = _REFINEMENTS) -> ProgramState:
        """The nearest state in equilibrium, to round-off where refined; else what came closest."""


@contextmanager
def onto_equilibrium(
    program: KinematicProgram, state: ProgramState, moves: Moves
) -> Iterator[Balancing]:
    """Projection of states whose reactions are about those of a state; factorised once.

    Args:
        program: dimensionless.
        state: close to equilibrium, reactions inside their cones.
        moves: how far the stress of a point moves by its weight, `alike` or `by_area`.
    """
    moving = _Moving.of(program, state, moves)
    stiffness = _stiffness(program, moving)
    diagonal = stiffness.diagonal()
    most = float(diagonal.max(initial=0.0)) or 1.0
    # A block that nothing rubs has no stiffness along its base, and there any scale will do.
    scale = 1 / np.sqrt(np.where(diagonal > _NOTHING * most, diagonal, most))
    scaled = csr_matrix(diags_array(scale) @ stiffness @ diags_array(scale))
    matrix = csr_matrix(scaled + _SHIFT * eye_array(program.n, format="csr"))
    matrix.sort_indices()
    try:
        solver = factorised(matrix)
    except SingularError:
        yield lambda state, refinements=0: state  # what is left out of balance tells
        return

    def driven(force: Floats) -> Floats:
        return np.asarray(scale * solver.solve(scale * force))

    reference = driven(program.reference_load)
    give = float(program.reference_load @ reference) + _STIFF_LOAD

    def nearest(state: ProgramState, refinements: int = _REFINEMENTS) -> ProgramState:
        force = out_of_balance(program, state)
        for _ in range(refinements):
            velocity = driven(-force)
            more = -float(program.reference_load @ velocity) / give
            moved = moving.moved(program, state, velocity + more * reference)
            moved = replace(moved, load_factor=state.load_factor + more)
            left = out_of_balance(program, moved)
            if not np.abs(left).max() < np.abs(force).max():
                break
            done = np.abs(left).max() > _FINISHED * np.abs(force).max()
            state, force = moved, left
            if done:
                break
        return state

    try:
        yield nearest
    finally:
        solver.close()


@dataclass(frozen=True)
class _Moving:
    """How far stresses and reactions move, per strain rate and velocity of the points.

    Attributes:
        stress: of each group, shape (m,).
        normal, tangential: of reactions, shape (m,) and (m tangent_dim,).
    """

    stress: tuple[Floats, ...]
    normal: Floats
    tangential: Floats

    @classmethod
    def of(cls, program: KinematicProgram, state: ProgramState, moves: Moves) -> "_Moving":
        """Reactions in units of how far the largest of them may move.

        What carries a body far stronger than its weight must not be soft beside the body, or its
        rigid motions drown in the shift.
        """
        weights = [group.weights for group in program.groups]
        mean = float(np.mean(np.concatenate([np.zeros(0), *weights]))) if weights else 1.0
        rows = program.contact
        t_n = np.minimum(np.maximum(state.normal_reaction, 0.0), 1.0)
        room = np.minimum(rows.limit + rows.dilatancy * np.maximum(state.normal_reaction, 0.0), 1.0)
        unit = max(t_n.max(initial=0.0), room.max(initial=0.0)) or 1.0
        return cls(
            stress=tuple(moves(own / mean) for own in weights),
            normal=(t_n / unit) ** 2,
            tangential=np.repeat((room / unit) ** 2, rows.tangent_dim),
        )

    def moved(
        self, program: KinematicProgram, state: ProgramState, velocity: Floats
    ) -> ProgramState:
        """The state with the stresses of a velocity."""
        contact = program.contact
        slip = (self.tangential * (contact.tangential @ velocity)).reshape(-1, contact.tangent_dim)
        every = tuple(zip(program.groups, self.stress, strict=True))
        return replace(
            state,
            stress=tuple(
                stress + share[:, None] * group.cone_vectors(velocity)
                for stress, (group, share) in zip(state.stress, every, strict=True)
            ),
            mean_stress=tuple(
                mean + np.repeat(share, group.volumes) * (group.volumetric @ velocity)
                for mean, (group, share) in zip(state.mean_stress, every, strict=True)
            ),
            normal_reaction=state.normal_reaction - self.normal * contact.opening(velocity),
            tangential_reaction=state.tangential_reaction - slip,
        )


def _stiffness(program: KinematicProgram, moving: _Moving) -> Sparse:
    total = csr_matrix((program.n, program.n))
    for group, share in zip(program.groups, moving.stress, strict=True):
        for rows, dim in ((group.rows, group.dim), (group.volumetric, group.volumes)):
            weights = np.repeat(group.weights * share, dim)
            total = csr_matrix(total + rows.T @ (diags_array(weights) @ rows))
    contact = program.contact
    for rows, mobility, dim in (
        (contact.normal, moving.normal, 1),
        (contact.tangential, moving.tangential, contact.tangent_dim),
    ):
        weights = mobility * np.repeat(contact.weights, dim)
        total = csr_matrix(total + rows.T @ (diags_array(weights) @ rows))
    return total
