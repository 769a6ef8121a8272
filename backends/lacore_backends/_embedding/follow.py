"""Iteration of the embedding from its start to an answer, or to a proof that there is none."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.numerics.linear_algebra import SingularError
from lacore_backends._embedding.arrays import Multipliers
from lacore_backends._embedding.directions import Directions
from lacore_backends._embedding.place import Place, Step, largest
from lacore_backends._embedding.system import System
from lacore_backends._goal import Goal

_AWAY = 0.97  # share of the way to the boundary of the cones
_CORRECTORS = 2  # number of Gondzio's correctors
_FURTHER = 0.3  # increase of the step length that they aim at
_GAIN = 0.1  # share of this increase that they must achieve
_BAND = (0.1, 10.0)  # band of products around sigma mu within which they are not changed
_SHORTEST = 1e-5  # shortest useful step
_ROUND_OFF = 10.0  # allowed residual in tolerances where round-off ends the iteration
_NOTHING = 0.01  # tolerance of a zero load factor, in tolerances per elastic power
# residuals close to an answer, and the factor of growth that shows its loss
_NEAR, _LOST = 1e-4, 1e3
_SUMMED = 100.0  # allowed power of unbalanced forces, in tolerances: that of certificates


_STUCK = ("no progress", "singular matrix", "iteration limit")


@dataclass(frozen=True)
class EmbeddingResult:
    """Last or best iterate."""

    native: str
    iterations: int
    velocity: Floats
    multipliers: Multipliers


def follow(
    system: System,
    goal: Goal,
    at: Step,
    power: float,
    other: Callable[[], System] | None = None,
) -> EmbeddingResult:
    """Iterate from a start to the end.

    Args:
        system: equations of a step.
        goal: tolerance and limits.
        at: first iterate.
        power: power that its velocity dissipates.
        other: makes a slower solver of the same equations, which continues where forces are lost to
            round-off.
    """
    conic = at.conic
    before, lost = at, np.inf
    native, iteration = "iteration limit", 0
    best, least = Place(conic, at), np.inf
    for iteration in range(goal.max_iterations + 1):
        place = Place(conic, at)
        native = judged(place, goal, power)
        every = residuals(place, power)
        left = largest(*every)
        if native or left < least:
            best, least = place, left
        if native:
            break
        if least <= _NEAR and left > _LOST * least:  # Only round-off remains.
            native = "no progress"
            break
        if iteration == goal.max_iterations:
            native = "iteration limit"
            break
        if time.perf_counter() > goal.deadline:
            native = "time limit"
            break
        if other is not None and every[1] > lost and max(every[0], every[2]) < _NEAR:
            system, other, at = other(), None, before
            continue
        before, lost = at, max(goal.tolerance, every[1])
        try:
            step, share = chosen(place, Directions(place, system), goal)
        except (SingularError, np.linalg.LinAlgError):
            native = "singular matrix"
            break
        moved = at.plus(step, share)
        if share < _SHORTEST or not Place(conic, moved).sound:
            native = "no progress"
            break
        at = moved
    if native in _STUCK and least <= _ROUND_OFF * goal.tolerance:
        native = "solved to round-off"
    return EmbeddingResult(native, iteration, *best.solution)


def chosen(place: Place, directions: Directions, goal: Goal) -> tuple[Step, float]:
    """Return the step and the share of it to take."""
    ahead = directions.to_edges()
    alpha = min(1.0, place.farthest(ahead.step))
    sigma = (1 - alpha) ** 4
    mu = sigma * place.mu
    found, aim = directions.to_centre(mu, 1 - sigma, ahead)
    share = min(1.0, _AWAY * place.farthest(found.step))
    for _ in range(_CORRECTORS):
        if share >= 0.9:
            break
        target = min(1.0, share + _FURTHER)
        more = directions.banded(found.step, target, (_BAND[0] * mu, _BAND[1] * mu))
        further = aim.more(*more)
        other = directions.towards(further, found)
        longer = min(1.0, _AWAY * place.farthest(other.step))
        if longer < share + _GAIN * _FURTHER:
            break
        found, share, aim = other, longer, further
    step = directions.exactly(found, goal.tolerance)
    return step, min(1.0, _AWAY * place.farthest(step))


def judged(place: Place, goal: Goal, power: float) -> str:
    """Return the native status of an iterate; empty if the iteration continues.

    Args:
        place: the iterate.
        goal: tolerance.
        power: power of the elastic velocity, which converts tau to a power.
    """
    at, conic, left = place.at, place.conic, place.left
    if nothing(place, power) <= goal.tolerance:
        return "nothing to overcome"
    if largest(*residuals(place, power)) <= goal.tolerance:
        return "solved"
    # A ray of multipliers proves that every velocity with F0.u = 1 would have a negative cost.
    gain = place.bound + place.rising / (2 * at.tau)
    force = np.abs(place.force + at.load * conic.load).max(initial=0.0)
    size = float(np.abs(conic.load).max(initial=0.0))
    if gain > 0 and largest(force / size, at.tau * power) <= goal.tolerance * gain:
        return "locked"
    # A ray of velocities: the dead loads do more work than it dissipates.
    missed = largest(place.missed, abs(left.load) / size, at.tau / size)
    if place.cost < 0 and missed <= goal.tolerance * place.fastest:
        gained = -goal.tolerance * largest(place.cost, place.dissipating)
        if at.tau * power <= gained:
            return "unsafe"
    return ""


def nothing(place: Place, power: float) -> float:
    """Return the error of a zero load factor: powers and forces by those of the elastic body.

    Residuals by a load that vanishes would never meet a tolerance.
    """
    at, conic = place.at, place.conic
    scale = at.tau * min(1.0, power)
    loads = scale * float(np.abs(conic.load).sum()) + at.tau * conic.weight
    lost = place.lost / at.tau
    return largest(
        largest(abs(place.cost), abs(place.bound), lost) / scale / _NOTHING,
        place.unbalanced / loads,
        residuals(place, power)[2],
    )


def residuals(place: Place, power: float) -> tuple[float, float, float]:
    """Return the relative residuals of powers, forces and velocities.

    That of the forces includes the power of all unbalanced forces: many small nodal forces can move
    the load together although each of them is negligible.
    """
    at, conic, left = place.at, place.conic, place.left
    floor = _NOTHING * min(1.0, power)
    turned = max(abs(place.cost) / at.tau, abs(place.bound) / at.tau, floor)
    gap = abs(place.cost - place.bound) / at.tau / turned
    lost = place.lost / at.tau**2 / turned
    loads = abs(at.load) / at.tau * float(np.abs(conic.load).sum())
    loads += conic.weight
    force = place.unbalanced / at.tau / max(loads, 1e-300)
    slow = place.missed / max(place.fastest, 1e-300)
    return gap, largest(force, lost / _SUMMED), largest(slow, abs(left.load) / at.tau)
