"""Exactly admissible stresses from those of a solver (T26c), without a second solve if possible."""

from dataclasses import replace

import numpy as np

from lacore.bounds.constants import (
    BELOW,
    FRICTION_MARGIN,
    LENT_COHESION,
    MOST_FRICTION_MARGIN,
    NEGLIGIBLE_STRENGTH,
    STRENGTH_MARGIN,
    TRACTION_NOISE,
    WIDER_MARGINS,
    WIDEST_MARGIN,
    ZERO_LOAD_FACTOR,
)
from lacore.program.dissipation import DissipationGroup
from lacore.program.kinematic import KinematicProgram
from lacore.program.state import ProgramState


def margins(program: KinematicProgram, tolerance: float) -> list[float]:
    """Return the reductions of all strengths for a nominal tolerance; none if scaling suffices."""
    if not (np.any(program.dead_load) or np.any(program.contact.dilatancy)):
        return [0.0]
    least, strength = max(STRENGTH_MARGIN, 4 * tolerance), _least_strength(program)
    least /= strength if strength < NEGLIGIBLE_STRENGTH else 1.0
    shares = list(dict.fromkeys(min(factor * least, WIDEST_MARGIN) for factor in WIDER_MARGINS))
    return [*shares, *LENT_COHESION] if program.pressure_dependent else shares


def _least_strength(program: KinematicProgram) -> float:
    """Return the least strength without pressure of dimensionless surfaces; inf without any."""
    strengths = [own.surfaces.strength for own in program.groups if own.surfaces is not None]
    return min((float(own[own > 0].min(initial=np.inf)) for own in strengths), default=np.inf)


def weaker(program: KinematicProgram, margin: float) -> KinematicProgram:
    """Return the program with reduced strengths, and slightly reduced friction of soils."""
    contact, left = program.contact, 1 - margin
    return replace(
        program,
        groups=tuple(_less_rubbed(group.times(left), margin) for group in program.groups),
        contact=replace(contact, limit=left * contact.limit, dilatancy=left * contact.dilatancy),
    )


def _less_rubbed(group: DissipationGroup, margin: float) -> DissipationGroup:
    """Return the group with surfaces about the same apex that are within the original ones."""
    own = group.surfaces
    if own is None:
        return group
    left = np.where(own.normed > 0, 1 - min(FRICTION_MARGIN * margin, MOST_FRICTION_MARGIN), 1.0)
    surfaces = replace(own, slope=left[:, None] * own.slope, strength=left * own.strength)
    return replace(group, surfaces=surfaces)


def lacking(program: KinematicProgram, state: ProgramState) -> float:
    """Return the share of its strength by which a stress exceeds a surface; 0 if none does."""
    lack = 0.0
    for group, stress, mean in zip(program.groups, state.stress, state.mean_stress, strict=True):
        if group.surfaces is not None and group.weights.size:
            own = group.surfaces
            excess = own.use(np.linalg.norm(stress, axis=1), mean) - own.strength
            lack = max(lack, float((excess / own.strength).max(initial=0.0)))
    return lack


def within_friction(program: KinematicProgram, state: ProgramState, margin: float) -> ProgramState:
    """Return the state with reactions moved into their cones, and noise removed."""
    rows = program.contact
    forces = abs(state.load_factor) * np.abs(program.reference_load).sum()
    mean = (forces + np.abs(program.dead_load).sum()) / max(rows.weights.sum(), 1.0)
    noise = max(TRACTION_NOISE, margin / 10) * max(state.normal_reaction.max(initial=0.0), mean)
    t_n = np.where(state.normal_reaction > noise, state.normal_reaction, 0.0)
    room = (1 - margin) * (rows.limit + rows.dilatancy * t_n)
    size = np.linalg.norm(state.tangential_reaction, axis=1)
    share = np.where(size > room, room / np.where(size > 0, size, 1.0), 1.0)
    return replace(
        state,
        normal_reaction=t_n,
        tangential_reaction=share[:, None] * state.tangential_reaction,
    )


def _terms(program: KinematicProgram, state: ProgramState, use: float) -> float:
    """Return the size of the terms in the use of strengths, by that use; at least 1.

    It is larger for pressed soil.
    """
    most = 1.0
    for group, stress, mean in zip(program.groups, state.stress, state.mean_stress, strict=True):
        if group.surfaces is not None and group.weights.size:
            own = group.surfaces
            sizes = replace(own, slope=np.abs(own.slope))
            terms = sizes.use(np.linalg.norm(stress, axis=1), np.abs(mean))
            most = max(most, float((terms / own.strength).max(initial=0.0)) / use)
    return most


def scaled(program: KinematicProgram, state: ProgramState) -> ProgramState:
    """Return the state scaled to the limits of yield and friction; only without dead load.

    If the load factor is round-off of zero, the state without stresses is returned.
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
    carries = state.load_factor > ZERO_LOAD_FACTOR
    factor = float((1 - BELOW * _terms(program, state, use)) / use) if carries else 0.0
    return state.scaled(factor, load_factor=factor)
