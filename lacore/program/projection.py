"""Projection of stresses onto exact equilibrium (T26c).

The nearest stresses in equilibrium, ``min sum (||ds||^2 + dp^2)`` over points, are the stresses
``ds = w D v, dp = w theta v`` of the velocity v under the unbalanced forces, which takes one sparse
solve. Points count equally whatever their weight w, because the residual nodal forces of a solver
are similar on all elements; if the smallest weights yielded first, the smallest elements would take
the changes of the others. If that proves nothing, points count by their weights. Reactions move
too, the less the closer they are to the tip of their cone, so that none leaves it. The load factor
stays unless statics alone determines it. All of this is floating point, not interval arithmetic:
"exact" means to round-off.
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
from lacore.program.constants import FINISHED, NO_STIFFNESS, REFINEMENTS, SHIFT, STIFF_LOAD
from lacore.program.kinematic import KinematicProgram
from lacore.program.state import ProgramState, out_of_balance

Moves = Callable[[Floats], Floats]
"""From weights of points per their mean to how far stresses move, per strain rate."""


def alike(weights: Floats) -> Floats:
    """Count points equally in the minimum."""
    return weights


def by_area(weights: Floats) -> Floats:
    """Count points by their weights: the smallest move as far as others for the same strain rate.

    On slivers of a soil with almost no cohesion this keeps stresses within strength.
    """
    return np.ones_like(weights)


class Balancing(Protocol):
    """Projection of stresses and reactions onto equilibrium."""

    def __call__(self, state: ProgramState, refinements: int = REFINEMENTS) -> ProgramState:
        """Return the nearest state in equilibrium, to round-off if refined.

        Else the closest one.
        """


@contextmanager
def onto_equilibrium(
    program: KinematicProgram, state: ProgramState, moves: Moves
) -> Iterator[Balancing]:
    """Yield the projection of states with similar reactions; the matrix is factorised once.

    Args:
        program: dimensionless program.
        state: state close to equilibrium, with reactions inside their cones.
        moves: how far the stress of a point moves by its weight, `alike` or `by_area`.
    """
    moving = _Moving.of(program, state, moves)
    stiffness = _stiffness(program, moving)
    diagonal = stiffness.diagonal()
    most = float(diagonal.max(initial=0.0)) or 1.0
    # A block without friction has no stiffness along its base, where any scale will do.
    scale = 1 / np.sqrt(np.where(diagonal > NO_STIFFNESS * most, diagonal, most))
    scaled = csr_matrix(diags_array(scale) @ stiffness @ diags_array(scale))
    matrix = csr_matrix(scaled + SHIFT * eye_array(program.n, format="csr"))
    matrix.sort_indices()
    try:
        solver = factorised(matrix)
    except SingularError:
        yield lambda state, refinements=0: state  # The unbalanced residual shows the result.
        return

    def driven(force: Floats) -> Floats:
        return np.asarray(scale * solver.solve(scale * force))

    reference = driven(program.reference_load)
    give = float(program.reference_load @ reference) + STIFF_LOAD

    def nearest(state: ProgramState, refinements: int = REFINEMENTS) -> ProgramState:
        force = out_of_balance(program, state)
        for _ in range(refinements):
            velocity = driven(-force)
            more = -float(program.reference_load @ velocity) / give
            moved = moving.moved(program, state, velocity + more * reference)
            moved = replace(moved, load_factor=state.load_factor + more)
            left = out_of_balance(program, moved)
            if not np.abs(left).max() < np.abs(force).max():
                break
            done = np.abs(left).max() > FINISHED * np.abs(force).max()
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
    """Change of stresses and reactions per strain rate and velocity of the points.

    Attributes:
        stress: factors of each group, shape (m,).
        normal, tangential: factors of reactions, shape (m,) and (m tangent_dim,).
    """

    stress: tuple[Floats, ...]
    normal: Floats
    tangential: Floats

    @classmethod
    def of(cls, program: KinematicProgram, state: ProgramState, moves: Moves) -> "_Moving":
        """Return the factors, with reactions in units of the largest possible change.

        The support of a body that is far stronger than its weight must not be soft compared with
        the body, or its rigid motions would be lost in the shift.
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
        """Return the state with the stresses of a velocity added."""
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
