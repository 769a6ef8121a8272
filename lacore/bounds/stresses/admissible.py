"""Exactly admissible stresses from those of a solver (T26c), without a second solve if possible."""

from dataclasses import replace

import numpy as np

from lacore.program.dissipation import DissipationGroup
from lacore.program.kinematic import KinematicProgram
from lacore.program.state import ProgramState

# Margins off all strengths, tried in turn where a state cannot be scaled: what the projection
# moves, up to 2e-8 measured, or four times the backend's tolerance, and then more.
_MARGIN, _WIDER = 1e-7, (1.0, 100.0, 10_000.0)
_WIDEST = 0.01
_LENT = (0.05, 0.5)  # of a cohesion that is next to none, lent to a sand (T45)
# Of friction within a body, per share of all strengths: where pressure carries there is no strength
# to take it from. A share of 1e-5 costs a footing without cohesion 5e-5 of its load.
_RUBBED, _MOST_RUBBED = 10.0, 1e-5
_NOISE = 1e-9  # of the largest reaction or the mean traction of the loads
_NOTHING = 1e-9  # load factor, dimensionless: what a solver leaves of zero
_BELOW = 4 * np.finfo(float).eps  # of its terms: so that a scaled stress is not above by round-off


def margins(program: KinematicProgram, tolerance: float) -> list[float]:
    """Shares to take off all strengths, by a nominal tolerance; none where scaling is enough."""
    if not (np.any(program.dead_load) or np.any(program.contact.dilatancy)):
        return [0.0]
    least = max(_MARGIN, 4 * tolerance)
    shares = [min(factor * least, _WIDEST) for factor in _WIDER]
    return [*shares, *_LENT] if program.pressure_dependent else shares


def weaker(program: KinematicProgram, margin: float) -> KinematicProgram:
    """The program with a share taken off all strengths, and of soils a little off friction."""
    contact, left = program.contact, 1 - margin
    return replace(
        program,
        groups=tuple(_less_rubbed(group.times(left), margin) for group in program.groups),
        contact=replace(contact, limit=left * contact.limit, dilatancy=left * contact.dilatancy),
    )


def _less_rubbed(group: DissipationGroup, margin: float) -> DissipationGroup:
    """With surfaces that open less, about their apex: within them wherever they carry at all."""
    own = group.surfaces
    if own is None:
        return group
    left = np.where(own.normed > 0, 1 - min(_RUBBED * margin, _MOST_RUBBED), 1.0)
    surfaces = replace(own, slope=left[:, None] * own.slope, strength=left * own.strength)
    return replace(group, surfaces=surfaces)


def lacking(program: KinematicProgram, state: ProgramState) -> float:
    """Share of its own strength by which a stress is beyond a surface; 0 where none is."""
    lack = 0.0
    for group, stress, mean in zip(program.groups, state.stress, state.mean_stress, strict=True):
        if group.surfaces is not None and group.weights.size:
            own = group.surfaces
            excess = own.use(np.linalg.norm(stress, axis=1), mean) - own.strength
            lack = max(lack, float((excess / own.strength).max(initial=0.0)))
    return lack


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


def _terms(program: KinematicProgram, state: ProgramState, use: float) -> float:
    """What the use of strengths is summed from, per what is used; 1, and of pressed soil more."""
    most = 1.0
    for group, stress, mean in zip(program.groups, state.stress, state.mean_stress, strict=True):
        if group.surfaces is not None and group.weights.size:
            own = group.surfaces
            sizes = replace(own, slope=np.abs(own.slope))
            terms = sizes.use(np.linalg.norm(stress, axis=1), np.abs(mean))
            most = max(most, float((terms / own.strength).max(initial=0.0)) / use)
    return most


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
    carries = state.load_factor > _NOTHING
    factor = float((1 - _BELOW * _terms(program, state, use)) / use) if carries else 0.0
    return state.scaled(factor, load_factor=factor)
