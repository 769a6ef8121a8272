"""K- and S-steps, and their alternation: what the loops on friction are made of (T12, T52).

A K-step minimises over velocities at frozen reactions, an S-step maximises over statically
admissible states inside the Coulomb cones at frozen slip. Both are the same kinematic program with
other contact terms, the S-step read off its multipliers. The velocity of one with the reactions of
the other is an admissible pair; one without a gap is a Coulomb limit state.

Where strain rates harden the loop begins with rough solves. Slip at associated friction is off by a
sixth or more; an S-step at it has slip of its own, and each brings what is off down to a fifth,
whatever its digits: to a tolerance of 1e-4 they take half of the iterations. K- and S-step after
them make a pair that holds as a rule, where the loop from the associated state takes two
(docs/design-decisions.md). Along a path they begin at the slip of the step before, which is off by
as much as that at associated friction, at a solve less. Its reactions are off by a tenth, too much
for a pair: velocities jump from slip line to slip line.
"""

from collections.abc import Callable
from contextlib import closing

import numpy as np

from lacore.coupling.freezing import at_pressing, at_slip, friction_of, pressing
from lacore.coupling.run import Iterate, Run, paired
from lacore.numerics.arrays import Floats
from lacore.program.kinematic import associated_contact, shift_contact
from lacore.program.state import ProgramState
from lacore.reporting.status import Status

FALLS = 0.9  # of the least gap so far: anything above is a stall
_VANISHED = 1e-6  # of the associated load factor, in a structure without dead loads
_SOON = 8  # solves, with which a loop from the associated state is through as a rule
_LOOKS = 3  # rough S-steps, at most
_NEAR = 0.01  # gap of one on its own, from which the next pair holds as a rule
_NOISE = 3e-4  # of the largest reaction: what rough solves leave where there is none

Blend = Callable[[Floats, Floats, Floats], Floats]
"""Next frozen reaction from the last one and those of the S- and the K-step after it."""


def mean(_: Floats, s: Floats, k: Floats) -> Floats:
    """Between the reactions of both steps: the fewest solves, on large walls above all (T12b)."""
    return (s + k) / 2


def static_alone(_last: Floats, s: Floats, _k: Floats) -> Floats:
    """Those of the S-step: the gap falls from step to step, or stalls for good (T12)."""
    return s


def alternate(
    run: Run,
    static: ProgramState,
    kind: str,
    patience: int,
    blend: Blend,
    most: int | None = None,
    falls: float = FALLS,
) -> Iterate | None:
    """K- and S-steps from a static state; the iterate that ends the loop, or None after a stall.

    Args:
        run: the loop.
        static: a statically admissible state.
        kind: of K-steps, for the history.
        patience: rounds without progress that are borne in a row.
        blend: what the next K-step freezes.
        most: solves of the loop, from its start, after which it ends; None: as many as it has.
        falls: share of the least gap that a round has to come to, to count as progress.
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
    """K- and S-steps from friction nearby; None unless a pair that holds comes soon.

    Args:
        run: a loop at its start. The first K-step freezes the reactions of its `near`; without
            them, what rough solves find.
        blend, patience: see `alternate`.
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
    """Normal reactions at slip that is nearly theirs; None where rough solves find none.

    From a slip nearby, else from the associated state.
    """
    assert run.prepare_roughly is not None
    rows = run.program.contact
    with closing(run.prepare_roughly(run.program)) as solver:
        if slip is None:
            last = run.solve("rough associated", associated_contact(rows), solver=solver)
        else:
            last = run.solve("rough S", shift_contact(rows, slip), solver=solver)
        for _ in range(_LOOKS):
            point = last.inner.point
            if point is None or gap(last) <= _NEAR:
                break
            slip = np.asarray(np.linalg.norm(rows.slip(point.velocity), axis=1))
            last = run.solve("rough S", shift_contact(rows, slip), solver=solver)
    point = last.inner.point
    if point is None:
        return None
    reactions = pressing(run.program, point)
    return np.where(reactions > _NOISE * reactions.max(initial=0.0), reactions, 0.0)


def feasible_k_step(
    run: Run, reactions: Floats, static: ProgramState, kind: str
) -> tuple[Floats, Iterate]:
    """A K-step, and what it froze: more where that is less than any admissible state needs."""
    k = k_step(run, reactions, static, kind)
    if k.inner.status is Status.UNSAFE:
        reactions = np.maximum(reactions, pressing(run.program, static))
        k = k_step(run, reactions, static, kind)
    return reactions, k


def k_step(run: Run, reactions: Floats, static: ProgramState | None, kind: str) -> Iterate:
    """``u = argmin`` of (T5) at frozen friction, judged with the static state before, if any."""
    program = run.program
    frozen = at_pressing(program, reactions)
    partner = None if static is None else lambda k: paired(k, static)
    k = run.solve(kind, frozen.contact, partner=partner, program=frozen.program)
    if k.inner.point is not None:
        image = pressing(program, k.inner.point)
        run.mapped("K", friction_of(program, reactions), friction_of(program, image))
    return k


def s_step(run: Run, kinematic: ProgramState, reactions: Floats) -> Iterate:
    """``(t, alpha) = argmax`` over SA, t in K, of ``alpha - sum w mu ||u_t|| t_n`` (T12).

    Args:
        run: the loop.
        kinematic: a K-step's.
        reactions: what it froze.
    """
    frozen = at_slip(run.program, kinematic.velocity, reactions)
    partner = lambda s: paired(kinematic, s)  # noqa: E731
    return run.solve("S", frozen.contact, partner=partner, program=frozen.program)


def s_steps(run: Run) -> list[Iterate]:
    """S-steps so far with states that carry a load."""
    return [
        one
        for one in run.iterates
        if one.kind == "S"
        and one.certificate is not None
        and one.inner.point is not None
        and not vanishes(run, one.inner.point)
    ]


def closest(run: Run, static: ProgramState) -> ProgramState:
    """The statically admissible state of the pair with the least gap so far."""
    steps = s_steps(run)
    best = min(steps, key=gap, default=None)
    point = None if best is None else best.inner.point
    return static if point is None else point


def least_gap(run: Run) -> float:
    """Of S-steps so far with states that carry a load; inf where there are none."""
    return min(map(gap, s_steps(run)), default=np.inf)


def gap(iterate: Iterate) -> float:
    """Of the pair of an iterate; inf where there is none."""
    return np.inf if iterate.certificate is None else iterate.certificate.gap


def proves_load(run: Run, iterate: Iterate) -> bool:
    """Whether an iterate is a proven state with a load.

    Zero is a Coulomb state of weightless contact that any load may meet: none to settle at.
    """
    return run.proven(iterate) and not run.free(iterate)


def vanishes(run: Run, static: ProgramState) -> bool:
    """Whether reactions are on their way to weightless contact, which carries nothing."""
    first = run.iterates[0].inner.point
    if first is None or np.any(run.program.dead_load):
        return False
    return abs(static.load_factor) <= _VANISHED * abs(first.load_factor)
