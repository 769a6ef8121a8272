"""Stresses moved back within their strengths, while in equilibrium (T26c).

Half the squared distance from the strengths is smooth and convex on the stresses in equilibrium.
Steps along its gradient are alternating projections onto both, one solution each with the available
factors. With acceleration (Beck & Teboulle, SIAM J. Imaging Sci. 2, 2009) about forty of them
reduce the loss of projection alone on slivers to a tenth.
"""

from dataclasses import replace
from math import sqrt

import numpy as np

from lacore.bounds.constants import HOPELESS, SCALING_STEPS
from lacore.numerics.arrays import Floats
from lacore.program.kinematic import KinematicProgram
from lacore.program.projection import Balancing
from lacore.program.state import ProgramState


def within_strength(
    program: KinematicProgram,
    inside: KinematicProgram,
    state: ProgramState,
    nearest: Balancing,
    worth: float,
    aim: float,
) -> ProgramState:
    """Return the state with the smallest excess over strengths, or the first below `worth`.

    Args:
        program: dimensionless program with its strengths.
        inside: program with the strengths to which stresses are moved, no larger.
        state: state in equilibrium.
        nearest: projection onto equilibrium.
        worth: share of strengths at which to stop.
        aim: how far beyond `inside` stresses are left, by the largest share by which they exceed
            strengths: there may be no stress in equilibrium within them.
    """
    least = beyond(program, state)
    best = last = ahead = state
    speed = 1.0
    if not worth < least < HOPELESS:
        return state
    for _ in range(SCALING_STEPS):
        next_ = nearest(_returned(inside, ahead, 1 + aim * least), 1)
        faster = (1 + sqrt(1 + 4 * speed**2)) / 2
        ahead, last = _further(next_, last, (speed - 1) / faster), next_
        speed, over = faster, beyond(program, next_)
        if over < least:
            best, least = next_, over
        if least <= worth:
            break
    return nearest(best)


def beyond(program: KinematicProgram, state: ProgramState) -> float:
    """Return the largest share by which stresses exceed their strength; below 0 if none does."""
    parts = zip(program.groups, state.stress, state.mean_stress, strict=True)
    return max((group.use(stress, mean) for group, stress, mean in parts), default=0.0) - 1


def _returned(program: KinematicProgram, state: ProgramState, times: float) -> ProgramState:
    """Return the stresses shortened to a multiple of the strength at their pressure."""
    parts = zip(program.groups, state.stress, state.mean_stress, strict=True)
    stresses = []
    for group, stress, mean in parts:
        size, most = np.linalg.norm(stress, axis=1), times * group.strength_at(mean)
        share = np.where(size > most, most / np.where(size > 0, size, 1.0), 1.0)
        stresses.append(share[:, None] * stress)
    return replace(state, stress=tuple(stresses))


def _further(state: ProgramState, last: ProgramState, times: float) -> ProgramState:
    """Return the extrapolation from the last state by a factor."""

    def on(new: Floats, old: Floats) -> Floats:
        return np.asarray(new + times * (new - old))

    return replace(
        state,
        stress=tuple(map(on, state.stress, last.stress)),
        mean_stress=tuple(map(on, state.mean_stress, last.mean_stress)),
    )
