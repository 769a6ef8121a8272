"""Exactly admissible stresses from those of a solver (T26c), without a second solve if possible."""

from dataclasses import replace
from typing import Any

import numpy as np

from lacore.program import KinematicProgram
from lacore.state import ProgramState

# Margins off all strengths, tried in turn where a state cannot be scaled: what the projection
# moves, up to 2e-8 measured, or four times the backend's tolerance, and then more.
_MARGIN, _WIDER = 1e-7, (1.0, 100.0, 10_000.0)
_WIDEST = 0.01
_HALF = 0.5  # of a cohesion that is next to none, lent to a sand (T45)
_NOISE = 1e-9  # of the largest reaction or the mean traction of the loads
_NOTHING = 1e-9  # load factor, dimensionless: what a solver leaves of zero
_BELOW_ONE = 1 - 4 * np.finfo(float).eps  # so that a scaled stress is not above by round-off


def margins(program: KinematicProgram, options: Any) -> list[float]:
    """Shares to take off all strengths; none where scaling makes any stress admissible."""
    if not (np.any(program.dead_load) or np.any(program.contact.dilatancy)):
        return [0.0]
    least = max(_MARGIN, 4 * float(getattr(options, "tolerance", 0.0)))
    shares = [min(factor * least, _WIDEST) for factor in _WIDER]
    return [*shares, _HALF] if program.presses else shares


def weaker(program: KinematicProgram, margin: float) -> KinematicProgram:
    """The program with a share taken off all strengths."""
    contact, left = program.contact, 1 - margin
    return replace(
        program,
        groups=tuple(group.times(left) for group in program.groups),
        contact=replace(contact, limit=left * contact.limit, dilatancy=left * contact.dilatancy),
    )


def within_friction(program: KinematicProgram, state: ProgramState, margin: float) -> ProgramState:
    """Reactions that a solver left just outside their cones moved into them, noise removed."""
    rows = program.contact
    forces = abs(state.load_factor) * np.abs(program.reference_load).sum()
    mean = (forces + np.abs(program.dead_load).sum()) / max(rows.weights.sum(), 1.0)
    noise = max(_NOISE, margin / 10) * max(state.normal_reaction.max(initial=0.0), mean)
    t_n = np.where(state.normal_reaction > noise, state.normal_reaction, 0.0)
    room = (1 - margin) * (rows.limit + rows.dilatancy * t_n)
    size = np.linalg.norm(state.tangential_reaction, axis=1)
    share = np.where(size > room, room / np.where(size > 0, size, 1.0), 1.0)
    return replace(
        state,
        normal_reaction=t_n,
        tangential_reaction=share[:, None] * state.tangential_reaction,
    )


def scaled(program: KinematicProgram, state: ProgramState) -> ProgramState:
    """The state as large as yield and limits of friction allow; without dead load only.

    Where the load factor is round-off of zero, the state without stresses.
    """
    contact, limited = program.contact, np.isfinite(program.contact.limit)
    limited &= program.contact.limit > 0
    rubbed = np.linalg.norm(state.tangential_reaction, axis=1)[limited]
    use = max(
        float((rubbed / contact.limit[limited]).max(initial=0.0)),
        *(
            group.use(stress, mean)
            for group, stress, mean in zip(
                program.groups, state.stress, state.mean_stress, strict=True
            )
        ),
    )
    factor = _BELOW_ONE / use if state.load_factor > _NOTHING else 0.0
    return replace(
        state,
        load_factor=factor * state.load_factor,
        stress=tuple(factor * stress for stress in state.stress),
        mean_stress=tuple(factor * mean for mean in state.mean_stress),
        normal_reaction=factor * state.normal_reaction,
        tangential_reaction=factor * state.tangential_reaction,
    )
