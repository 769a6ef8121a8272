"""The certified loop (T12, T13): every step feasible, every pair judged, never a guess.

A K-step minimises over velocities at frozen reactions, an S-step maximises over statically
admissible states inside the Coulomb cones at frozen slip. Both are the same kinematic program with
other contact terms, the S-step read off its multipliers. The velocity of one with the reactions of
the other is an admissible pair; one without a gap is a Coulomb limit state.

Which reactions the next K-step gets is free. Measured on 300 random walls and on walls of 1 000
blocks: the mean of those of both steps needs the fewest solves and certifies 92 %; the damped
reaction iteration needs twice as many and certifies 99 %; the S-step's alone (T12) certify 79 %.
They are tried in this order: together 99.7 %.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from lacore.arrays import Floats
from lacore.backend import PreparedSolver
from lacore.coupling.bounds import kinematic_power, lower_bound, upper_bound
from lacore.coupling.fixed_point import OnIterate, fixed_point
from lacore.coupling.freezing import (
    associated,
    at_pressing,
    at_slip,
    friction_of,
    frictionless,
    generous,
    pressing,
)
from lacore.coupling.run import Coupled, CouplingOptions, Iterate, Run, paired, worst
from lacore.numerics.anderson import Anderson
from lacore.program import (
    KinematicProgram,
    frictionless_contact,
)
from lacore.state import ProgramState
from lacore.status import Status

_FALLS = 0.9  # of the least gap so far: anything above is a stall
_VANISHED = 1e-6  # of the associated load factor, in a structure without dead loads
_PATIENCE = 4  # steps in a row without progress
_DRIFT, _LOOK = 40, 10  # damped steps: fewer do not get far; and after how many an S-step looks
_ENOUGH = 40  # solves of soils, where what is accepted may be reached by then
_LONG = 20  # of an iteration whose gap rises and falls on its way
_GENEROUS = (1e2, 1e5)  # reactions of the anchor, of total load over contact length
_OUTSIDE = (
    "the load lies outside of the friction cones: no reactions within them carry a part of it"
)
_ABOVE = "the residuals are small, but the associated law has a mechanism at a lower load factor"
_TRIVIAL = "no reactions were found that carry a load, though the associated friction law has some"
_LIMITS = (Status.ITERATION_LIMIT, Status.TIME_LIMIT)

Blend = Callable[[Floats, Floats, Floats], Floats]
"""Next frozen reaction from the last one and those of the S- and the K-step after it."""


def certified_loop(
    program: KinematicProgram,
    solver: PreparedSolver,
    regularised: bool,
    options: CouplingOptions,
    on_iterate: OnIterate,
    prepare: Callable[[KinematicProgram], PreparedSolver] | None = None,
) -> Coupled:
    """Alternate K- and S-steps from the associated state; escape from stalls (T12, T12b, T13).

    Where strain rates harden, S-steps take the yield stresses of the K-step before, in a program of
    their own that `prepare` gets a solver for: two velocities would not harden alike.
    """
    run = Run(program, solver, regularised, options, on_iterate, prepare)
    rows = program.contact
    if not (rows.coulomb.any() or program.frictional):
        return run.judged(run.solve("single", frictionless_contact(rows)))
    frozen = associated(program)
    first = run.solve("associated", frozen.contact, program=frozen.program)
    anchor = anchored(run) if first.inner.status is Status.LOCKED else first
    static = anchor.inner.point
    if run.free(anchor):
        return replace(run.judged(anchor), note=_OUTSIDE if anchor is first else _TRIVIAL)
    if static is None or anchor.inner.status in _LIMITS or run.proven(anchor):
        return run.judged(anchor)
    of_contact = (averaged, _damped, _alternated, _shifted)
    for attempt in (averaged, settled, drifted) if program.frictional else of_contact:
        found = attempt(run, _closest(run, static)) or run.accept()
        if found is not None:
            return _bounded(run, run.judged(found), first)
    return _undecided(run, first)


def _bounded(run: Run, coupled: Coupled, first: Iterate) -> Coupled:
    """The end of the loop, unless the associated load factor, an upper bound (T14), refutes it.

    That the frictionless one is below needs no solve: friction only adds to ``D(u) - Fd.u`` of an
    admissible velocity, and penetration is judged by the power that it could turn over.
    """
    state = coupled.final.state
    if state is None or not run.program.homogeneous:
        return coupled
    upper = upper_bound(run.program.associated(), first.inner, run.options.tolerance)
    slack = run.options.tolerance * kinematic_power(run.program, state)
    if state.load_factor <= upper + slack:
        return coupled
    return replace(coupled, status=Status.NOT_CERTIFIED, note=_ABOVE)


def _closest(run: Run, static: ProgramState) -> ProgramState:
    """The statically admissible state of the pair with the least gap so far."""
    gaps = [(np.inf, static)]
    for iterate in run.iterates:
        state = iterate.inner.point
        if iterate.kind != "S" or iterate.certificate is None or state is None:
            continue
        if not _vanishes(run, state):
            gaps.append((iterate.certificate.gap, state))
    return min(gaps, key=lambda pair: pair[0])[1]


def anchored(run: Run) -> Iterate:
    """A state to start from where the associated problem has no mechanism (T13).

    The velocities that a K-step admits do not depend on its bounds: LOCKED there is LOCKED for any
    friction. From its mechanism the S-step has a value, unless no state at all is admissible.
    """
    program, rows = run.program, run.program.contact
    load = float(np.abs(program.dead_load).sum() + np.abs(program.reference_load).sum())
    area = sum(float(group.weights.sum()) for group in program.groups)
    length = float(rows.weights.sum()) if rows.coulomb.any() else area**0.5
    for factor in _GENEROUS:
        frozen = at_pressing(program, generous(program, factor * load / length))
        k = run.solve("generous", frozen.contact, program=frozen.program)
        if k.inner.status is not Status.UNSAFE:
            break
    return k if k.inner.point is None else _s_step(run, k.inner.point)


def averaged(run: Run, static: ProgramState) -> Iterate | None:
    """Between the reactions of both steps: the fewest solves, on large walls above all (T12b)."""
    return _alternate(run, static, "K", _PATIENCE, lambda _, s, k: (s + k) / 2)


def _damped(run: Run, static: ProgramState) -> Iterate | None:
    """The damped reaction iteration; S-steps only look for a pair. Slow, and rarely in vain."""
    return _alternate(run, static, "damped K", _LONG, lambda last, _, k: (last + k) / 2)


def _alternated(run: Run, static: ProgramState) -> Iterate | None:
    """Reactions of S-steps alone: the gap falls from step to step, or stalls for good (T12)."""
    return _alternate(run, static, "K", _PATIENCE, lambda _last, s, _k: s)


def _alternate(
    run: Run, static: ProgramState, kind: str, patience: int, blend: Blend, most: int | None = None
) -> Iterate | None:
    """K- and S-steps from a static state; the iterate that ends the loop, or None after a stall.

    Or after `most` solves of the loop.
    """
    pressed, least, failed = pressing(run.program, static), np.inf, 0
    while not run.exhausted and failed <= patience and len(run.iterates) < (most or np.inf):
        pressed, k = _carried_k_step(run, pressed, static, kind)
        if k.inner.point is None or run.free(k) or run.proven(k):
            return k if _carries(run, k) else None
        s = _s_step(run, k.inner.point)
        if s.inner.point is None or run.free(s) or run.proven(s):
            return s if _carries(run, s) else None
        assert s.certificate is not None
        static, gap = s.inner.point, s.certificate.gap
        if _vanishes(run, static):
            return None
        failed = 0 if gap <= _FALLS * least else failed + 1
        least = min(least, gap)
        both = pressing(run.program, static), pressing(run.program, k.inner.point)
        pressed = blend(pressed, *both)
    return None


def _shifted(run: Run, static: ProgramState) -> Iterate | None:
    """The shift iteration with Anderson's acceleration: the last resort."""
    if run.exhausted:
        return None
    coupled = fixed_point(run, "shift", 1.0, static, Anderson(5, 1.0))
    return coupled.final if coupled.status is Status.SOLVED else None


def settled(run: Run, static: ProgramState) -> Iterate | None:
    """Friction of S-steps alone, of soils: the gap falls, if slowly, and rarely stalls (T57)."""
    most = None if run.options.accepted is None else len(run.iterates) + _ENOUGH
    return _alternate(run, static, "K", _LONG, lambda _last, s, _k: s, most)


def drifted(run: Run, static: ProgramState) -> Iterate | None:
    """Damped K-steps, which drift to lower loads and may never settle by themselves; then S (T57).

    Now and then an S-step looks for a pair.
    """
    pressed = pressing(run.program, static)
    for step in range(1, _DRIFT + 1):
        pressed, k = _carried_k_step(run, pressed, static, "damped K")
        if run.exhausted or k.inner.point is None or run.free(k) or run.proven(k):
            return k if _carries(run, k) else None
        pressed = (pressed + pressing(run.program, k.inner.point)) / 2
        if step % _LOOK == 0:
            s = _s_step(run, k.inner.point)
            if s.inner.point is None or run.free(s) or run.proven(s):
                return s if _carries(run, s) else None
            static = s.inner.point
    return settled(run, static)


def _carried_k_step(
    run: Run, pressed: Floats, static: ProgramState, kind: str
) -> tuple[Floats, Iterate]:
    """A K-step, and what it froze: more where that is less than any admissible state needs."""
    k = _k_step(run, pressed, static, kind)
    if k.inner.status is Status.UNSAFE:
        pressed = np.maximum(pressed, pressing(run.program, static))
        k = _k_step(run, pressed, static, kind)
    return pressed, k


def _k_step(run: Run, pressed: Floats, static: ProgramState, kind: str) -> Iterate:
    """``u = argmin`` of (T5) at frozen friction, judged with the static state before."""
    program = run.program
    frozen, partner = at_pressing(program, pressed), lambda k: paired(k, static)
    k = run.solve(kind, frozen.contact, partner=partner, program=frozen.program)
    if k.inner.point is not None:
        image = pressing(program, k.inner.point)
        run.mapped("K", friction_of(program, pressed), friction_of(program, image))
    return k


def _s_step(run: Run, kinematic: ProgramState) -> Iterate:
    """``(t, alpha) = argmax`` over SA, t in K, of ``alpha - sum w mu ||u_t|| t_n`` (T12)."""
    frozen = at_slip(run.program, kinematic.velocity)
    partner = lambda s: paired(kinematic, s)  # noqa: E731
    return run.solve("S", frozen.contact, partner=partner, program=frozen.program)


def _carries(run: Run, iterate: Iterate) -> bool:
    """Whether an iterate is a proven state with a load.

    Zero is a Coulomb state of weightless contact that any load may meet: none to settle at.
    """
    return run.proven(iterate) and not run.free(iterate)


def _vanishes(run: Run, static: ProgramState) -> bool:
    """Whether reactions are on their way to weightless contact, which carries nothing."""
    first = run.iterates[0].inner.point
    if first is None or np.any(run.program.dead_load):
        return False
    return abs(static.load_factor) <= _VANISHED * abs(first.load_factor)


def _undecided(run: Run, first: Iterate) -> Coupled:
    """No certificate within the budget: the Coulomb bounds of T14, and no number."""
    trivial = next((iterate for iterate in run.iterates if run.free(iterate)), None)
    if trivial is not None:
        return replace(run.end(Status.FREE, trivial), note=_TRIVIAL)
    locked = first.inner.status is Status.LOCKED
    candidates = [iterate for iterate in run.iterates if iterate.certificate is not None]
    best = min(candidates, key=worst)
    if not run.program.homogeneous:  # T14 knows of no hardening and of no distance to close
        return run.end(Status.NOT_CERTIFIED, best)
    upper = upper_bound(run.program.associated(), first.inner, run.options.tolerance)
    least = frictionless(run.program)
    smooth = run.solve("frictionless", least.contact, program=least.program).inner
    lower = lower_bound(least.program, smooth, run.options.tolerance)
    locked = locked and not run.program.frictional
    status = Status.JAM if locked and max(run.rates, default=0.0) >= 1 else Status.NOT_CERTIFIED
    return run.end(status, best, bracket=(lower, upper))
