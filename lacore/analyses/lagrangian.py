"""Load factor as a saddle point, and its derivative by any number of the problem (T81)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import lsqr

from lacore.assembly.discretisation import Discretisation
from lacore.assembly.discretise import discretise
from lacore.coupling.kinds import COUPLINGS
from lacore.limit.state import LimitState
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.program.dissipation import DissipationGroup
from lacore.program.kinematic import KinematicProgram, associated_contact
from lacore.program.state import ProgramState, internal_force

_STEP = 1e-6  # by a number: differences of assembled programs, which are free of solver errors


@dataclass(frozen=True)
class Frozen:
    """A solution of a program: its velocity, its stresses, and the multipliers of its strengths.

    Attributes:
        discretisation: the solved problem.
        coupling: coupling of its state.
        point: velocity of all unknowns, stresses, reactions, SI.
        flows: for each group: rates ``||d||``, shape (m,), or multipliers of its planes, (m, k).
    """

    discretisation: Discretisation
    coupling: str
    point: ProgramState
    flows: tuple[Floats, ...]


def frozen(state: LimitState) -> Frozen:
    """Return the variables of a state that are fixed while numbers of its problem change."""
    assert state.point is not None
    velocity = state.point.velocity
    flows = tuple(_flow(group, velocity) for group in state.program.groups)
    return Frozen(state.discretisation, state.coupling, state.point, flows)


class NotComparableError(Exception):
    """Raised if a change of a number changes the unknowns or contact points."""


def slope(solution: Frozen, at: Callable[[float], Problem], value: float, size: float) -> float:
    """Return the central derivative of the load factor by a number at frozen variables (T81).

    Raises:
        InputError: a neighbouring value is not valid.
        NotComparableError: the number changes the unknowns or contact points.
    """
    step = _STEP * size
    above, below = (_load_factor(solution, at(value + sign * step)) for sign in (1, -1))
    return (above - below) / (2 * step)


def _load_factor(solution: Frozen, problem: Problem) -> float:
    """Return the Lagrangian of a problem at the variables of another one."""
    stated = discretise(problem)
    program, point = stated.full, solution.point
    _require_alike(program, solution.discretisation.full)
    u = _admissible(stated, solution)
    total = float(u @ internal_force(program, point))
    for group, stress, mean, flow in zip(
        program.groups, point.stress, point.mean_stress, solution.flows, strict=True
    ):
        size = np.linalg.norm(stress, axis=1)
        if group.surfaces is None:
            left = flow * (group.bound - size)
        else:
            surfaces = group.surfaces.associated()
            left = np.sum(flow * (surfaces.strength - surfaces.use(size, mean)), axis=1)
        total += float(group.weights @ left)
    rows = program.contact
    laws = COUPLINGS[solution.coupling].laws_of(rows) or associated_contact(rows)
    t_n, t_t = point.normal_reaction, point.tangential_reaction
    total -= float((rows.weights * t_n) @ rows.opening(u))
    total -= float(np.sum(rows.weights[:, None] * t_t * rows.slip(u)))
    slip = np.linalg.norm(solution.discretisation.full.contact.slip(point.velocity), axis=1)
    bound = np.where(np.isfinite(laws.bound), laws.bound, 0.0)
    room = bound + laws.dilatancy * t_n - np.linalg.norm(t_t, axis=1)
    total += float((rows.weights * slip) @ np.where(np.isfinite(laws.bound), room, 0.0))
    total -= float(program.dead_load @ u)
    return total - point.load_factor * (float(program.reference_load @ u) - 1)


def _admissible(stated: Discretisation, solution: Frozen) -> Floats:
    """Return the velocity, projected onto what supports and rigid members of a problem allow."""
    basis, known = stated.free_basis, solution.discretisation.free_basis
    u = solution.point.velocity
    if basis.shape == known.shape and abs(basis - known).nnz == 0:
        return u
    motion = lsqr(basis, u, atol=1e-15, btol=1e-15)[0]
    return np.asarray(basis @ motion)


def _require_alike(program: KinematicProgram, known: KinematicProgram) -> None:
    sizes = [
        (
            own.n,
            own.contact.count,
            [(group.name, group.weights.size) for group in own.groups],
        )
        for own in (program, known)
    ]
    if sizes[0] != sizes[1]:
        raise NotComparableError


def _flow(group: DissipationGroup, velocity: Floats) -> Floats:
    if group.surfaces is None:
        return group.rates(velocity)
    surfaces = group.surfaces.associated()
    return surfaces.multipliers(group.rates(velocity), group.volume_rates(velocity))
