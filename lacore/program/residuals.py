"""Residuals of the answer of one solve, also if no power is dissipated.

Residuals of powers are divided by the dissipated power, which is 0/0 without dissipation: a rigid
motion has the load factor zero, whatever its round-off strains. Powers are therefore divided by a
small share of the power that could be dissipated if that is larger, and inadmissible flow is
measured by its rates.
"""

from dataclasses import asdict

import numpy as np

from lacore.program.certificate import Certificate
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.power import kinematic_power, largest_power
from lacore.program.state import ProgramState

_POWERS = ("flow", "slip", "gap", "load")
_POSSIBLE = ("penetration", "divergence", "normalisation")  # residuals of a velocity alone
_IDLE = 1e-3  # scale of powers, by the power that all cones would dissipate at the largest speed
_NOTHING = 1e-6  # share of it that counts as round-off


def dilates_besides(program: KinematicProgram) -> bool:
    """Return whether flow has prescribed rates (T52, S-step), whose power no residual includes."""
    return any(group.dilates_besides for group in program.groups)


def scaled_residual(
    program: KinematicProgram, point: ProgramState, contact: FrozenContact
) -> tuple[str, float]:
    """Return name and size of the largest residual; the size is infinite if one is not finite."""
    found: dict[str, float] = asdict(Certificate.of(program, point, contact))
    power, least = _powers(program, point, contact)
    share = power / max(power, least) if max(power, least) > 0 else 1.0
    for name in _POWERS:
        found[name] *= share
    if idle(program, point, contact):
        found["divergence"] = impossible(program, point)  # For soils it is a power.
        if not np.any(program.dead_load):
            # Zero stress is in equilibrium, so the load factor is between zero and this power.
            found = {name: found[name] for name in _POSSIBLE}
            found["load"] = abs(point.load_factor) / (max(power, least) or 1.0)
    if not np.all(np.isfinite(list(found.values()))):
        return next(name for name, size in found.items() if not np.isfinite(size)), np.inf
    name = max(found, key=lambda one: found[one])
    return name, found[name]


def solve_residual(
    program: KinematicProgram, point: ProgramState, contact: FrozenContact, bar: float
) -> tuple[str, float]:
    """Return the worst residual of the certificate, or of `scaled_residual` if it is 0/0."""
    name, left = Certificate.of(program, point, contact).worst
    if not left <= bar and idle(program, point, contact):
        return scaled_residual(program, point, contact)
    return name, left if np.isfinite(left) else np.inf


def idle(program: KinematicProgram, point: ProgramState, contact: FrozenContact) -> bool:
    """Return whether the dissipated power is round-off, by the possible power at the load's speed.

    The speed of a mode without load is arbitrary.
    """
    power, least = _powers(program, point, contact)
    fastest = float(np.abs(point.velocity).max(initial=0.0))
    return power * fastest * float(np.abs(program.reference_load).sum()) <= _NOTHING * least


def _powers(
    program: KinematicProgram, point: ProgramState, contact: FrozenContact
) -> tuple[float, float]:
    """Return the dissipated power, and a small share of the possible power.

    The first is the scale of powers in certificates, except for dilatant friction.
    """
    power = kinematic_power(program, point, contact)
    return power, _IDLE * largest_power(program, point.velocity)


def impossible(program: KinematicProgram, point: ProgramState) -> float:
    """Return the largest rate of inadmissible flow, by the strain rate or the speed per length."""
    velocity, groups = point.velocity, program.at_state(point.velocity, point.mean_stress).groups
    area = sum(float(group.weights.sum()) for group in groups)
    scale = float(np.abs(velocity).max(initial=0.0)) / np.sqrt(area or 1.0)
    rates = [np.linalg.norm(group.cone_vectors(velocity), axis=1) for group in groups]
    scale = max([scale, *(float(rate.max(initial=0.0)) for rate in rates)])
    worst = [float(group.impossible(velocity).max(initial=0.0)) for group in groups]
    return max(worst, default=0.0) / (scale or 1.0)
