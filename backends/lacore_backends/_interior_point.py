"""Newton's method for the laws as cones, along the central path. Not a backend.

Slacks and multipliers of the cones (`lacore_backends._conic_laws`) satisfy ``t o z = mu e``, which
is smooth for arbitrarily small penalties. During the iteration mu goes to zero, by Mehrotra's
predictor and corrector in the Nesterov-Todd scaling. Only the stiffness of the velocities is
factorised, which is positive definite.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.numerics.linear_algebra import Gram, SingularError, SymmetricSolver
from lacore.numerics.second_order_cones import outside
from lacore.program import KinematicProgram
from lacore.program.regularization import escaped
from lacore_backends._conic_laws import ConicLaws
from lacore_backends._conic_points import Place, Points
from lacore_backends._goal import Goal

_AWAY = 0.99  # share of the way to the boundary of the cones
_SHORTEST = 1e-6  # shortest useful step
# shifts by the largest curvature, tried until the matrix is definite
_SHIFTS = (1e-16, 1e-14, 1e-12, 1e-10)
_POWER = 1e-2  # share of the tolerance: values are as exact as the gap, stresses as its root
_NEAR = 1e-8  # distance to the edge of a cone that counts as zero
_ALMOST = 1e3  # residual, in tolerances, of an iteration that is almost converged


@dataclass(frozen=True)
class BarrierResult:
    """Last iterate; the multiplier is that of ``F0.U = 1``."""

    native: str
    iterations: int
    velocity: Floats
    multiplier: float
    places: tuple[Place, ...]


class _Linearised:
    """Conditions of a minimum, linearised and factorised at one iterate."""

    def __init__(
        self,
        program: KinematicProgram,
        gram: Gram,
        solver: SymmetricSolver,
        points: Sequence[Points],
    ) -> None:
        """Factorise; raises `SingularError` if no shift makes the stiffness definite."""
        self._program, self._solver, self._points = program, solver, points
        matrix = gram.matrix([one.stiffness for one in points])
        plain = matrix.diagonal()
        for last, shift in enumerate(_SHIFTS, 1 - len(_SHIFTS)):
            matrix.setdiag(plain + shift * plain.max(initial=0.0))
            try:
                solver.factorise(matrix)
                break
            except SingularError:
                if last == 0:
                    raise
        self._by_load = solver.solve(program.reference_load)

    def step(
        self, aims: Sequence[Sequence[Floats]], velocity: Floats, multiplier: float
    ) -> tuple[Floats, float, list[Place]]:
        """Return changes of velocity, multiplier and points towards aims and equilibrium."""
        program, points = self._program, self._points
        load = program.reference_load
        rights = [one.right(aim) for one, aim in zip(points, aims, strict=True)]
        pulled = sum(one.force(right) for one, right in zip(points, rights, strict=True))
        change = self._solver.solve(_out_of_balance(program, points, multiplier) - pulled)
        more = float((1 - load @ velocity - load @ change) / (load @ self._by_load))
        change = change + more * self._by_load
        steps = [one.step(right, change) for one, right in zip(points, rights, strict=True)]
        return change, more, steps


def _out_of_balance(
    program: KinematicProgram, points: Sequence[Points], multiplier: float
) -> Floats:
    """Return ``lambda F0 + Fd`` minus the forces of the stresses, shape (n,)."""
    force = multiplier * program.reference_load + program.dead_load
    for one in points:
        force = force - one.law.force(one.place.stress)
    return force


def follow(
    program: KinematicProgram,
    laws: ConicLaws,
    gram: Gram,
    solver: SymmetricSolver,
    goal: Goal,
) -> BarrierResult:
    """Follow the central path, starting from stresses without cones.

    Args:
        program: the program.
        laws: its laws.
        gram: patterns of the rows of the laws.
        solver: factorises the stiffness.
        goal: stopping criteria.
    """
    points = [Points.start(law) for law in laws.each]
    u, multiplier = np.zeros(program.n), 0.0
    places = [one.place for one in points]
    try:
        linearised = _Linearised(program, gram, solver, points)
    except SingularError:
        return BarrierResult("singular matrix", 0, u, float("nan"), tuple(places))
    u, multiplier, places = linearised.step([one.at_rest() for one in points], u, multiplier)
    places = _inside(places)
    for iteration in range(1, goal.max_iterations + 1):
        points = [Points.at(law, place, u) for law, place in zip(laws.each, places, strict=True)]
        here = (iteration, u, multiplier, tuple(places))
        left = _left(program, points, u, multiplier) / goal.tolerance
        if left <= 1:
            return BarrierResult("converged", *here)
        if escaped(u):
            return BarrierResult("diverged", *here)
        if time.perf_counter() > goal.deadline:
            return BarrierResult("time limit", *here)
        stuck = "converged to round-off" if left <= _ALMOST else "no progress"
        try:
            linearised = _Linearised(program, gram, solver, points)
        except SingularError:
            return BarrierResult(stuck, *here)
        *_, ahead = linearised.step([one.to_edges() for one in points], u, multiplier)
        centring = (1 - min(1.0, _farthest(places, ahead))) ** 3
        mu = centring * sum(one.gap for one in points) / sum(one.volume for one in points)
        aims = [one.to_centre(mu, step) for one, step in zip(points, ahead, strict=True)]
        change, more, steps = linearised.step(aims, u, multiplier)
        share = min(1.0, _AWAY * _farthest(places, steps))
        moved = [place.moved(step, share) for place, step in zip(places, steps, strict=True)]
        if not (share > _SHORTEST and all(place.sound for place in moved)):
            return BarrierResult(stuck, *here)
        u, multiplier, places = u + share * change, multiplier + share * more, moved
    return BarrierResult("iteration limit", goal.max_iterations, u, multiplier, tuple(places))


def _inside(places: Sequence[Place]) -> list[Place]:
    """Return all slacks and all multipliers, moved to bring the outermost one inside."""
    slack = max(outside(part) for place in places for part in place.slacks)
    multiplier = max(outside(part) for place in places for part in place.multipliers)
    by = [1 + out if out > -_NEAR else 0.0 for out in (slack, multiplier)]
    return [place.raised(*by) for place in places]


def _farthest(places: Sequence[Place], steps: Sequence[Place]) -> float:
    return min(place.farthest(step) for place, step in zip(places, steps, strict=True))


def _left(
    program: KinematicProgram, points: Sequence[Points], velocity: Floats, multiplier: float
) -> float:
    """Return the relative residual of all conditions."""
    dead = program.dead_load
    power = abs(multiplier) + abs(float(dead @ velocity))
    forces = abs(multiplier) * float(np.abs(program.reference_load).sum())
    forces += float(np.abs(dead).sum())
    balance = float(np.abs(_out_of_balance(program, points, multiplier)).max()) / forces
    left = sum(one.gap + one.missed_power for one in points) / max(power, 1.0)
    fastest = max(float(np.abs(velocity).max()), 1.0)
    missed = max(one.missed(fastest) for one in points)
    return max(balance, missed, left / _POWER)
