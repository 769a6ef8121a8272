"""What the answer of one solve leaves, also where nothing is turned over.

Residuals of powers are per what is turned over, and where that is nothing they are 0/0: a body that
moves as it is has the load factor zero, whatever round-off strains it. So powers are measured by a
little of what could be turned over, where that is more, and flow that is not possible by its rates.
"""

from dataclasses import asdict

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.program.certificate import certify
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.state import ProgramState

_POWERS = ("flow", "slip", "gap", "load")
_POSSIBLE = ("penetration", "divergence", "normalisation")  # of a velocity alone
_IDLE = 1e-3  # of what all cones would turn over at the largest speed: a power to be compared with
_NOTHING = 1e-6  # of that: so little is round-off


def dilates_besides(program: KinematicProgram) -> bool:
    """Whether flow has rates besides its own (T52, S-step): no residual counts their power."""
    return any(group.dilates_besides for group in program.groups)


def left_over(
    program: KinematicProgram, point: ProgramState, contact: FrozenContact
) -> tuple[str, float]:
    """Name and size of the worst residual by a frozen contact; infinite where one is not finite."""
    found: dict[str, float] = asdict(certify(program, point, contact))
    power, least = _powers(program, point, contact)
    share = power / max(power, least) if max(power, least) > 0 else 1.0
    for name in _POWERS:
        found[name] *= share
    if idle(program, point, contact):
        found["divergence"] = impossible(program, point)  # of soils it is a power
        if not np.any(program.dead_load):
            # No stress at all is in equilibrium: the load factor is between zero and this power.
            found = {name: found[name] for name in _POSSIBLE}
            found["load"] = abs(point.load_factor) / (max(power, least) or 1.0)
    if not np.all(np.isfinite(list(found.values()))):
        return next(name for name, size in found.items() if not np.isfinite(size)), np.inf
    name = max(found, key=lambda one: found[one])
    return name, found[name]


def judged_left(
    program: KinematicProgram, point: ProgramState, contact: FrozenContact, bar: float
) -> tuple[str, float]:
    """As its certificate says, and where that is above a bar by 0/0, as `left_over` does."""
    name, left = certify(program, point, contact).worst
    if not left <= bar and idle(program, point, contact):
        return left_over(program, point, contact)
    return name, left if np.isfinite(left) else np.inf


def idle(program: KinematicProgram, point: ProgramState, contact: FrozenContact) -> bool:
    """Whether nothing is turned over, but for round-off: per what could be at the load's speed.

    A mode that no load drives may have any speed.
    """
    power, least = _powers(program, point, contact)
    fastest = float(np.abs(point.velocity).max(initial=0.0))
    return power * fastest * float(np.abs(program.reference_load).sum()) <= _NOTHING * least


def _powers(
    program: KinematicProgram, point: ProgramState, contact: FrozenContact
) -> tuple[float, float]:
    """What is turned over, and a little of what could be."""
    velocity, at = point.velocity, program.at_state(point.velocity, point.mean_stress)
    friction = at.friction_dissipation(velocity, contact.bound)
    dead = abs(float(at.dead_load @ velocity))
    # What certificates measure powers by, but for what dilating friction lifts.
    power = at.plastic_dissipation(velocity) + friction + dead
    return power, _IDLE * could_turn_over(program, velocity)


def could_turn_over(program: KinematicProgram, velocity: Floats) -> float:
    """What all cones, and the dead loads, would turn over at the largest speed."""
    total = float(np.abs(program.dead_load).sum())
    for group in program.groups:
        squares = np.asarray(group.rows.multiply(group.rows).sum(axis=1)).reshape(-1, group.dim)
        strength = group.bound
        if group.surfaces is not None:  # of soils each cone has that of its strongest surface
            strength = group.surfaces.strength.max(axis=1)
        total += float((group.weights * strength) @ np.sqrt(squares.sum(axis=1)))
    return total * float(np.abs(velocity).max(initial=0.0))


def impossible(program: KinematicProgram, point: ProgramState) -> float:
    """Largest rate of flow that is not possible, per strain rate, or speed per length of it all."""
    velocity, groups = point.velocity, program.at_state(point.velocity, point.mean_stress).groups
    area = sum(float(group.weights.sum()) for group in groups)
    scale = float(np.abs(velocity).max(initial=0.0)) / np.sqrt(area or 1.0)
    rates = [np.linalg.norm(group.cone_vectors(velocity), axis=1) for group in groups]
    scale = max([scale, *(float(rate.max(initial=0.0)) for rate in rates)])
    worst = [float(group.impossible(velocity).max(initial=0.0)) for group in groups]
    return max(worst, default=0.0) / (scale or 1.0)
