"""Searches for limit states of soils with non-associated flow (T57).

The friction of soils is frozen and updated as that of contact (`lacore.coupling.steps`). If load
factors are unique, undamped K-steps converge several times as fast as other choices. If they are
not, undamped K-steps jump between low load factors and damped ones drift to lower ones, while
S-steps alone stay close to their start.
"""

from lacore.coupling.constants import FAST_GAP, HALVED_GAP, LONG_PATIENCE
from lacore.coupling.freezing import pressing
from lacore.coupling.run import Iterate, Run
from lacore.coupling.steps import (
    alternate,
    closest,
    feasible_k_step,
    gap,
    proves_load,
    s_step,
    s_steps,
    static_alone,
)
from lacore.program.state import ProgramState

_UNDAMPED, _DRIFT = 10, 40  # undamped K-steps, and all K-steps; fewer do not reach low loads
_PAIRED = (6, 10, 20, 30, 40)  # K-steps that an S-step completes to a pair
_BATCH = 4  # undamped K-steps between two checks of their gap
_ENOUGH = 40  # solves of a search that may end at the accepted tolerance


def settled(run: Run, static: ProgramState) -> Iterate | None:
    """Freeze the friction of S-steps: the gap decreases, if slowly, and rarely stalls (T57).

    If it decreases slowly, undamped K-steps are tried, and given up unless they halve it.
    """
    begun = len(run.iterates)
    most = None if run.options.accepted is None else begun + _ENOUGH
    return (
        alternate(run, static, "K", 0, static_alone, most, FAST_GAP)
        or _hurried(run, static)
        or alternate(run, closest(run, static), "K", LONG_PATIENCE, static_alone, most)
    )


def _hurried(run: Run, static: ProgramState) -> Iterate | None:
    """Take undamped K-steps from the least gap so far, as long as each check finds it halved."""
    static, least = closest(run, static), min(map(gap, s_steps(run)), default=0.0)
    reactions, step, own = pressing(run.program, static), 0, 0.0
    while own <= HALVED_GAP * least:
        reactions, k = feasible_k_step(run, reactions, static, "K")
        if run.exhausted or k.inner.point is None or run.free(k) or run.proven(k):
            return k if proves_load(run, k) else None
        frozen, reactions, step = reactions, pressing(run.program, k.inner.point), step + 1
        if step % _BATCH == 0:
            s = s_step(run, k.inner.point, frozen)
            if s.inner.point is None or run.free(s) or run.proven(s):
                return s if proves_load(run, s) else None
            static, least, own = s.inner.point, own or least, gap(s)
    return None


def drifted(run: Run, static: ProgramState) -> Iterate | None:
    """Take undamped and then damped K-steps, which drift to lower loads, and then S-steps (T57).

    After some K-steps an S-step completes a pair.
    """
    reactions = pressing(run.program, static)
    for step in range(1, _DRIFT + 1):
        kind, share = ("K", 1.0) if step <= _UNDAMPED else ("damped K", 0.5)
        reactions, k = feasible_k_step(run, reactions, static, kind)
        if run.exhausted or k.inner.point is None or run.free(k) or run.proven(k):
            return k if proves_load(run, k) else None
        frozen = reactions
        reactions = reactions + share * (pressing(run.program, k.inner.point) - reactions)
        if step in _PAIRED:
            s = s_step(run, k.inner.point, frozen)
            if s.inner.point is None or run.free(s) or run.proven(s):
                return s if proves_load(run, s) else None
            static = s.inner.point
    return settled(run, static)
