"""Searches for limit states of soils whose flow is not associated (T57).

Friction of soils is frozen and made anew as that of contact is (`lacore.coupling.steps`). Where
load factors are unique undamped K-steps come nearer several times as fast as any other; where they
are not, they jump between low ones, from which damped ones drift, and S-steps alone stay near where
they start.
"""

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

_UNDAMPED, _DRIFT = 10, 40  # K-steps: those that are not damped, and all; fewer do not get far
_LOOKS = (6, 10, 20, 30, 40)  # of them, after which an S-step looks for a pair
_BATCH = 4  # undamped K-steps before a look that tries whether they come nearer
_ENOUGH = 40  # solves, where what is accepted may be reached by then
_LONG = 20  # rounds without progress of an iteration whose gap rises and falls on its way
_FAST = 0.4  # of the least gap: what a round of S-steps comes to as long as these are fast
_HALF = 0.5  # of the gap of the last look, so that undamped K-steps go on


def settled(run: Run, static: ProgramState) -> Iterate | None:
    """Friction of S-steps alone, of soils: the gap falls, if slowly, and rarely stalls (T57).

    Where it falls slowly undamped K-steps are tried, and left again unless they halve it.
    """
    begun = len(run.iterates)
    most = None if run.options.accepted is None else begun + _ENOUGH
    return (
        alternate(run, static, "K", 0, static_alone, most, _FAST)
        or _hurried(run, static)
        or alternate(run, closest(run, static), "K", _LONG, static_alone, most)
    )


def _hurried(run: Run, static: ProgramState) -> Iterate | None:
    """Undamped K-steps from the least gap so far, as long as it halves from look to look."""
    static, least = closest(run, static), min(map(gap, s_steps(run)), default=0.0)
    reactions, step, own = pressing(run.program, static), 0, 0.0
    while own <= _HALF * least:
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
    """K-steps, first undamped, then damped, which drift to lower loads; then S-steps (T57).

    Now and then an S-step looks for a pair.
    """
    reactions = pressing(run.program, static)
    for step in range(1, _DRIFT + 1):
        kind, share = ("K", 1.0) if step <= _UNDAMPED else ("damped K", 0.5)
        reactions, k = feasible_k_step(run, reactions, static, kind)
        if run.exhausted or k.inner.point is None or run.free(k) or run.proven(k):
            return k if proves_load(run, k) else None
        frozen = reactions
        reactions = reactions + share * (pressing(run.program, k.inner.point) - reactions)
        if step in _LOOKS:
            s = s_step(run, k.inner.point, frozen)
            if s.inner.point is None or run.free(s) or run.proven(s):
                return s if proves_load(run, s) else None
            static = s.inner.point
    return settled(run, static)
