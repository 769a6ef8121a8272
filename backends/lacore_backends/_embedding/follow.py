"""The way of the embedding from its start to an answer, or to a proof that there is none."""

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

_AWAY = 0.97  # of the way to the boundary of the cones
_CORRECTORS = 2  # of Gondzio
_FURTHER = 0.3  # how much longer a step they aim at
_GAIN = 0.1  # share of that which they must gain
_BAND = (0.1, 10.0)  # of sigma mu: where products stay as they are
_SHORTEST = 1e-5  # step that leads nowhere
_ROUND_OFF = 10.0  # tolerances that may be left where round-off ends the way
_NOTHING = 0.01  # of the tolerance, per elastic power: a load factor that is zero
_NEAR, _LOST = 1e-4, 1e3  # residuals that are next to an answer, and times as much: lost again
_SUMMED = 100.0  # tolerances that forces out of balance may work: what certificates allow


_STUCK = ("no progress", "singular matrix", "iteration limit")


@dataclass(frozen=True)
class EmbeddingResult:
    """Where the iteration ended, or was at its best."""

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
    """From a start, and the power that its velocity turns over, to the end.

    Args:
        other: solves the same equations, slower, and goes on where forces are lost to round-off.
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
        if least <= _NEAR and left > _LOST * least:  # round-off is all that is left of the way
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
    """The step and its share."""
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
    """How it ends here; empty where it goes on.

    Args:
        power: of the elastic velocity, which turns a size of tau into one of power.
    """
    at, conic, left = place.at, place.conic, place.left
    if nothing(place, power) <= goal.tolerance:
        return "nothing to overcome"
    if largest(*residuals(place, power)) <= goal.tolerance:
        return "solved"
    # A ray of multipliers: whatever has F0.u = 1 would do more work than nothing at no cost.
    gain = place.bound + place.rising / (2 * at.tau)
    force = np.abs(place.force + at.load * conic.load).max(initial=0.0)
    size = float(np.abs(conic.load).max(initial=0.0))
    if gain > 0 and largest(force / size, at.tau * power) <= goal.tolerance * gain:
        return "locked"
    # A ray of velocities: the dead loads work more than it dissipates.
    missed = largest(place.missed, abs(left.load) / size, at.tau / size)
    if place.cost < 0 and missed <= goal.tolerance * place.fastest:
        gained = -goal.tolerance * largest(place.cost, place.dissipating)
        if at.tau * power <= gained:
            return "unsafe"
    return ""


def nothing(place: Place, power: float) -> float:
    """How far it is from a load factor of zero: powers and forces per those of the elastic body.

    What is left per a load that vanishes never ends.
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
    """Of powers, forces and velocities, relative; of forces, the power of those out of balance too.

    Of many small nodal forces none shows beside the loads, and all of them together move the load.
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
