"""K- and S-steps and their alternation, from which the loops on friction are built (T12, T52).

A K-step minimises over velocities at frozen reactions. An S-step maximises over statically
admissible states inside the Coulomb cones at frozen slip. Both are the same kinematic program with
different contact terms, and the state of an S-step consists of its multipliers. The velocity of one
step with the reactions of the other is an admissible pair; a pair without a gap is a Coulomb limit
state.

With hardening, the loop starts with rough solves. Slip at associated friction has an error of a
sixth or more. Each rough S-step reduces the error in slip fivefold, however loosely it is solved,
and a tolerance of 1e-4 halves its iterations. The K- and S-step after them usually make a valid
pair, whereas the loop from the associated state needs two pairs (docs/design-decisions.md). Along a
path the rough solves start at the slip of the step before, which has a similar error and saves a
solve. The reactions of that step have an error of a tenth, which is too much for a pair, because
velocities jump from one slip line to another.
"""

from collections.abc import Callable
from contextlib import closing

import numpy as np

from lacore.coupling.constants import FALLING_GAP, NEAR_GAP, NO_LOAD_FACTOR, NO_REACTION
from lacore.coupling.freezing import at_pressing, at_slip, friction_of, pressing
from lacore.coupling.run import Iterate, Run, paired
from lacore.numerics.arrays import Floats
from lacore.program.kinematic import associated_contact, shift_contact
from lacore.program.state import ProgramState
from lacore.reporting.status import Status

_SOON = 8  # solves, which a loop from the associated state usually needs
_ROUGH_STEPS = 3  # most rough S-steps

Blend = Callable[[Floats, Floats, Floats], Floats]
"""Returns the next frozen reaction, given the last one and those of the S- and K-step after it."""


def mean(_: Floats, s: Floats, k: Floats) -> Floats:
    """Return the mean reactions of both steps, which need the fewest solves (T12b)."""
    return (s + k) / 2


def static_alone(_last: Floats, s: Floats, _k: Floats) -> Floats:
    """Return the reactions of the S-step; the gap decreases from step to step, or stalls (T12)."""
    return s


def alternate(
    run: Run,
    static: ProgramState,
    kind: str,
    patience: int,
    blend: Blend,
    most: int | None = None,
    falls: float = FALLING_GAP,
) -> Iterate | None:
    """Alternate K- and S-steps from a static state.

    Args:
        run: The loop.
        static: A statically admissible state.
        kind: Kind of the K-steps, for the history.
        patience: Largest number of successive pairs without progress.
        blend: Function that returns the reactions which the next K-step freezes.
        most: Number of solves of the loop, from its start, after which it ends; None for its
            budget.
        falls: Share of the least gap that a pair must reach to count as progress.

    Returns:
        The iterate that ends the loop, if it proves a state with a load; else None.
    """
    reactions, least, failed = pressing(run.program, static), np.inf, 0
    while not run.exhausted and failed <= patience and len(run.iterates) < (most or np.inf):
        reactions, k = feasible_k_step(run, reactions, static, kind)
        if k.inner.point is None or run.free(k) or run.proven(k):
            return k if proves_load(run, k) else None
        s = s_step(run, k.inner.point, reactions)
        if s.inner.point is None or run.free(s) or run.proven(s):
            return s if proves_load(run, s) else None
        static, own = s.inner.point, gap(s)
        if vanishes(run, static):
            return None
        failed = 0 if own <= falls * least else failed + 1
        least = min(least, own)
        both = pressing(run.program, static), pressing(run.program, k.inner.point)
        reactions = blend(reactions, *both)
    return None


def resumed(run: Run, blend: Blend, patience: int) -> Iterate | None:
    """Alternate from the friction of another state; return None unless a pair soon holds.

    Args:
        run: A loop at its start. The first K-step freezes the reactions of its `friction_start`, or
            those of rough solves if it has none.
        blend, patience: See `alternate`.
    """
    start = run.friction_start
    reactions = (
        _found_roughly(run, start.slip) if start.normal_reaction is None else start.normal_reaction
    )
    if reactions is None:
        return None
    k = k_step(run, reactions, None, "K")
    if k.inner.point is None or run.free(k) or run.proven(k):
        return k if proves_load(run, k) else None
    s = s_step(run, k.inner.point, reactions)
    if s.inner.point is None or run.free(s) or run.proven(s):
        return s if proves_load(run, s) else None
    return alternate(run, s.inner.point, "K", patience, blend, _SOON)


def _found_roughly(run: Run, slip: Floats | None) -> Floats | None:
    """Return normal reactions of rough solves, up to a small error; None if these find none.

    They start at the given slip, or else at the associated state.
    """
    assert run.prepare_roughly is not None
    rows = run.program.contact
    with closing(run.prepare_roughly(run.program)) as solver:
        if slip is None:
            last = run.solve("rough associated", associated_contact(rows), solver=solver)
        else:
            last = run.solve("rough S", shift_contact(rows, slip), solver=solver)
        for _ in range(_ROUGH_STEPS):
            point = last.inner.point
            if point is None or gap(last) <= NEAR_GAP:
                break
            slip = np.asarray(np.linalg.norm(rows.slip(point.velocity), axis=1))
            last = run.solve("rough S", shift_contact(rows, slip), solver=solver)
    point = last.inner.point
    if point is None:
        return None
    reactions = pressing(run.program, point)
    return np.where(reactions > NO_REACTION * reactions.max(initial=0.0), reactions, 0.0)


def feasible_k_step(
    run: Run, reactions: Floats, static: ProgramState, kind: str
) -> tuple[Floats, Iterate]:
    """Return a K-step and the reactions it froze, which are raised if no state is admissible."""
    k = k_step(run, reactions, static, kind)
    if k.inner.status is Status.UNSAFE:
        reactions = np.maximum(reactions, pressing(run.program, static))
        k = k_step(run, reactions, static, kind)
    return reactions, k


def k_step(run: Run, reactions: Floats, static: ProgramState | None, kind: str) -> Iterate:
    """Solve ``u = argmin`` of (T5) at frozen friction, and pair it with a static state, if any."""
    program = run.program
    frozen = at_pressing(program, reactions)
    partner = None if static is None else lambda k: paired(k, static)
    k = run.solve(kind, frozen.contact, partner=partner, program=frozen.program)
    if k.inner.point is not None:
        image = pressing(program, k.inner.point)
        run.mapped("K", friction_of(program, reactions), friction_of(program, image))
    return k


def s_step(run: Run, kinematic: ProgramState, reactions: Floats) -> Iterate:
    """Solve ``(t, alpha) = argmax`` over SA, t in K, of ``alpha - sum w mu ||u_t|| t_n`` (T12).

    Args:
        run: The loop.
        kinematic: State of a K-step.
        reactions: Reactions that the K-step froze.
    """
    frozen = at_slip(run.program, kinematic.velocity, reactions)
    partner = lambda s: paired(kinematic, s)  # noqa: E731
    return run.solve("S", frozen.contact, partner=partner, program=frozen.program)


def s_steps(run: Run) -> list[Iterate]:
    """Return the S-steps so far whose states carry a load."""
    return [
        one
        for one in run.iterates
        if one.kind == "S"
        and one.certificate is not None
        and one.inner.point is not None
        and not vanishes(run, one.inner.point)
    ]


def closest(run: Run, static: ProgramState) -> ProgramState:
    """Return the statically admissible state of the pair with the least gap so far."""
    steps = s_steps(run)
    best = min(steps, key=gap, default=None)
    point = None if best is None else best.inner.point
    return static if point is None else point


def least_gap(run: Run) -> float:
    """Return the least gap of S-steps so far whose states carry a load; inf without any."""
    return min(map(gap, s_steps(run)), default=np.inf)


def gap(iterate: Iterate) -> float:
    """Return the gap of the pair of an iterate; inf without a certificate."""
    return np.inf if iterate.certificate is None else iterate.certificate.gap


def proves_load(run: Run, iterate: Iterate) -> bool:
    """Whether an iterate is a proven state with a load.

    Zero load is a Coulomb state of any weightless contact, so a loop must not converge to it.
    """
    return run.proven(iterate) and not run.free(iterate)


def vanishes(run: Run, static: ProgramState) -> bool:
    """Whether reactions tend to zero, which is a state of weightless contact without a load."""
    first = run.iterates[0].inner.point
    if first is None or np.any(run.program.dead_load):
        return False
    return abs(static.load_factor) <= NO_LOAD_FACTOR * abs(first.load_factor)
