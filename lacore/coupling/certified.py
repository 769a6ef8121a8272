"""The certified loop (T12, T13): every step feasible, every pair judged, never a guess.

It alternates K- and S-steps (`lacore.coupling.steps`) until the velocity of one with the reactions
of the other is a pair without a gap: a Coulomb limit state.

Which reactions the next K-step gets is free. Measured on 300 random walls and on walls of 1 000
blocks: the mean of those of both steps needs the fewest solves and certifies 92 %; the damped
reaction iteration needs twice as many and certifies 99 %; the S-step's alone (T12) certify 79 %.
They are tried in this order: together 99.7 %. Of rigid blocks central paths of the problem itself
come second (`lacore.coupling.blocks.central_path`): they end on tall walls, and on domes and
vaults, whose reactions are a continuum as a rule (T74), where all of these stall. Walls of
thousands of blocks begin with them: K- and S-steps from a place on the way need the least time.
"""

from dataclasses import replace

import numpy as np

from lacore.coupling.blocks.central_path import by_places, central_path
from lacore.coupling.bounds import kinematic_power, lower_bound, upper_bound
from lacore.coupling.fixed_point import fixed_point
from lacore.coupling.freezing import associated, at_pressing, frictionless, generous
from lacore.coupling.run import Coupled, Iterate, Run, worst
from lacore.coupling.settling import drifted, settled
from lacore.coupling.steps import alternate, closest, mean, resumed, s_step, static_alone
from lacore.numerics.anderson import Anderson
from lacore.program.kinematic import frictionless_contact
from lacore.program.state import ProgramState
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Status

_PATIENCE = 4  # steps in a row without progress
_LONG = 20  # of an iteration whose gap rises and falls on its way
_GENEROUS = (1e2, 1e5)  # reactions of the anchor, of total load over contact length
_OUTSIDE, _TRIVIAL = (Finding(Kind.LOAD_OUTSIDE_CONES),), (Finding(Kind.NO_REACTIONS),)
_LIMITS = (Status.ITERATION_LIMIT, Status.TIME_LIMIT)


def certified_loop(run: Run) -> Coupled:
    """Alternate K- and S-steps from the associated state; escape from stalls (T12, T12b, T13).

    Where strain rates harden, S-steps take the yield stresses of the K-step before, in a program of
    their own that `Run.prepare` gets a solver for: two velocities would not harden alike.

    There no pair with the associated state would hold, and it begins with friction that is nearly
    right, of a state nearby or from rough solves (`lacore.coupling.steps.resumed`).
    """
    program = run.program
    if program.associated_flow:
        return run.finish(run.solve("single", frictionless_contact(program.contact)))
    if not program.hardens or program.frictional or run.prepare_roughly is None:
        return _from_associated(run)
    found = resumed(run, mean, _PATIENCE)
    if found is not None:
        return run.finish(found)
    # Restart with the full budget, so that a failed shortcut never loses a result.
    again = _from_associated(run.afresh())
    return replace(again, iterates=(*run.iterates, *again.iterates))


def _from_associated(run: Run) -> Coupled:
    """The loop from the associated state."""
    program = run.program
    frozen = associated(program)
    first = run.solve("associated", frozen.contact, program=frozen.program)
    anchor = anchored(run) if first.inner.status is Status.LOCKED else first
    static = anchor.inner.point
    if run.free(anchor):
        return run.finish(anchor, findings=_OUTSIDE if anchor is first else _TRIVIAL)
    if static is None or anchor.inner.status in _LIMITS or run.proven(anchor):
        return run.finish(anchor)
    of_contact = (by_places, averaged, central_path, _damped, _alternated, _shifted)
    for attempt in (averaged, settled, drifted) if program.frictional else of_contact:
        found = attempt(run, closest(run, static))
        if found is None and run.relax_tolerance():
            found = run.best_proven()
        if found is not None:
            return _bounded(run, found, first)
    return _undecided(run, first)


def _bounded(run: Run, found: Iterate, first: Iterate) -> Coupled:
    """The end of the loop, where the associated load factor, an upper bound (T14), may refute it.

    That the frictionless one is below needs no solve: friction only adds to ``D(u) - Fd.u`` of an
    admissible velocity, and penetration is judged by the power that it could turn over.
    """
    state = found.state
    if state is None or not run.program.homogeneous:
        return run.finish(found)
    upper = upper_bound(run.program.associated(), first.inner, run.options.tolerance)
    slack = run.options.tolerance * kinematic_power(run.program, state)
    if state.load_factor <= upper + slack:
        return run.finish(found)
    refuted = Finding(Kind.LOWER_MECHANISM, severity=Severity.REASON)
    return run.end(Status.NOT_CERTIFIED, found, findings=(refuted,))


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
        reactions = generous(program, factor * load / length)
        frozen = at_pressing(program, reactions)
        k = run.solve("generous", frozen.contact, program=frozen.program)
        if k.inner.status is not Status.UNSAFE:
            break
    return k if k.inner.point is None else s_step(run, k.inner.point, reactions)


def averaged(run: Run, static: ProgramState) -> Iterate | None:
    """Between the reactions of both steps: the fewest solves, on large walls above all (T12b)."""
    return alternate(run, static, "K", _PATIENCE, mean)


def _damped(run: Run, static: ProgramState) -> Iterate | None:
    """The damped reaction iteration; S-steps only look for a pair. Slow, and rarely in vain."""
    return alternate(run, static, "damped K", _LONG, lambda last, _, k: (last + k) / 2)


def _alternated(run: Run, static: ProgramState) -> Iterate | None:
    """Reactions of S-steps alone: the gap falls from step to step, or stalls for good (T12)."""
    return alternate(run, static, "K", _PATIENCE, static_alone)


def _shifted(run: Run, static: ProgramState) -> Iterate | None:
    """The shift iteration with Anderson's acceleration: the last resort."""
    if run.exhausted:
        return None
    coupled = fixed_point(run, "shift", 1.0, static, Anderson(5, 1.0))
    return coupled.final if coupled.status is Status.SOLVED else None


def _undecided(run: Run, first: Iterate) -> Coupled:
    """No certificate within the budget: the Coulomb bounds of T14, and no number."""
    trivial = next((iterate for iterate in run.iterates if run.free(iterate)), None)
    if trivial is not None:
        return run.end(Status.FREE, trivial, findings=_TRIVIAL)
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
