"""The certified loop (T12, T13): it reports a limit state only with a certificate.

The loop alternates K- and S-steps (`lacore.coupling.steps`) until the velocity of one with the
reactions of the other is a pair without a gap, which is a Coulomb limit state. The next K-step may
freeze any reactions. `_OF_CONTACT` and `_OF_SOILS` list the choices in the order of the attempts.
"""

from dataclasses import replace

import numpy as np

from lacore.coupling.blocks.central_path import by_places, central_path
from lacore.coupling.bounds import lower_bound, upper_bound
from lacore.coupling.constants import LONG_PATIENCE, PATIENCE
from lacore.coupling.fixed_point import fixed_point
from lacore.coupling.freezing import associated, at_pressing, frictionless, generous
from lacore.coupling.run import Coupled, Iterate, Run, worst
from lacore.coupling.settling import drifted, settled
from lacore.coupling.steps import alternate, closest, mean, resumed, s_step, static_alone
from lacore.numerics.anderson import Anderson
from lacore.program.kinematic import frictionless_contact
from lacore.program.power import kinematic_power
from lacore.program.state import ProgramState
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Status

_GENEROUS = (1e2, 1e5)  # reactions of the anchor, per total load over contact length
_OUTSIDE, _TRIVIAL = (Finding(Kind.LOAD_OUTSIDE_CONES),), (Finding(Kind.NO_REACTIONS),)
_LIMITS = (Status.ITERATION_LIMIT, Status.TIME_LIMIT)


def certified_loop(run: Run) -> Coupled:
    """Alternate K- and S-steps until a pair is certified (T12, T12b, T13).

    With hardening, S-steps use the yield stresses of the K-step before, in a program for which
    `Run.prepare` prepares a solver, because two velocities would harden differently. The associated
    state then never yields a valid pair, so the loop starts from the friction of another state or
    of rough solves (`lacore.coupling.steps.resumed`).
    """
    program = run.program
    if program.associated_flow:
        return run.finish(run.solve("single", frictionless_contact(program.contact)))
    if not program.hardens or program.frictional or run.prepare_roughly is None:
        return _from_associated(run)
    found = resumed(run, mean, PATIENCE)
    if found is not None:
        return run.finish(found)
    # Restart with the full budget, so that a failed shortcut never loses a result.
    again = _from_associated(run.afresh())
    return replace(again, iterates=(*run.iterates, *again.iterates))


def _from_associated(run: Run) -> Coupled:
    """Run the loop from the associated state."""
    program = run.program
    frozen = associated(program)
    first = run.solve("associated", frozen.contact, program=frozen.program)
    anchor = anchored(run) if first.inner.status is Status.LOCKED else first
    static = anchor.inner.point
    if run.free(anchor):
        return run.finish(anchor, findings=_OUTSIDE if anchor is first else _TRIVIAL)
    if static is None or anchor.inner.status in _LIMITS or run.proven(anchor):
        return run.finish(anchor)
    for attempt in _OF_SOILS if program.frictional else _OF_CONTACT:
        found = attempt(run, closest(run, static))
        if found is None and run.relax_tolerance():
            found = run.best_proven()
        if found is not None:
            return _bounded(run, found, first)
    return _undecided(run, first)


def _bounded(run: Run, found: Iterate, first: Iterate) -> Coupled:
    """End the loop unless the associated load factor, an upper bound (T14), refutes its state.

    The frictionless load factor is below that of the state without a solve: friction only adds to
    ``D(u) - Fd.u`` of an admissible velocity, and the residual of penetration limits its power.
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
    """Find a state to start from if the associated problem has no mechanism (T13).

    The admissible velocities of a K-step do not depend on its friction bounds, so a K-step that is
    LOCKED is LOCKED for any friction. From its mechanism the S-step has a solution, unless no state
    is statically admissible.
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
    """Freeze the mean reactions of both steps, which needs the fewest solves (T12b)."""
    return alternate(run, static, "K", PATIENCE, mean)


def _damped(run: Run, static: ProgramState) -> Iterate | None:
    """Iterate on damped reactions of K-steps; S-steps only complete pairs."""
    return alternate(run, static, "damped K", LONG_PATIENCE, lambda last, _, k: (last + k) / 2)


def _alternated(run: Run, static: ProgramState) -> Iterate | None:
    """Freeze the reactions of S-steps; the gap decreases from step to step, or stalls (T12)."""
    return alternate(run, static, "K", PATIENCE, static_alone)


def _shifted(run: Run, static: ProgramState) -> Iterate | None:
    """Iterate on slip rates with Anderson's acceleration."""
    if run.exhausted:
        return None
    coupled = fixed_point(run, "shift", 1.0, static, Anderson(5, 1.0))
    return coupled.final if coupled.status is Status.SOLVED else None


_OF_SOILS = (averaged, settled, drifted)
_OF_CONTACT = (by_places, averaged, central_path, _damped, _alternated, _shifted)
"""Attempts of the loop, in their order, for soils with non-associated flow and for other programs.

Of 300 random walls and walls of 1000 blocks, `averaged` certifies 92 % with the fewest solves,
`_damped` 99 % with twice as many, and `_alternated` (T12) 79 %; together they certify 99.7 %.
`_shifted` is the last attempt. Rigid blocks have two more, along central paths of the problem
itself (`lacore.coupling.blocks.central_path`). `by_places` comes first on walls of thousands of
blocks, where K- and S-steps from places on the path need the least time. `central_path` converges
on tall walls, domes and vaults, whose reactions are usually not unique (T74), where the other
attempts stall.
"""


def _undecided(run: Run, first: Iterate) -> Coupled:
    """End the loop without a certificate, with the bounds of all Coulomb load factors (T14)."""
    trivial = next((iterate for iterate in run.iterates if run.free(iterate)), None)
    if trivial is not None:
        return run.end(Status.FREE, trivial, findings=_TRIVIAL)
    locked = first.inner.status is Status.LOCKED
    candidates = [iterate for iterate in run.iterates if iterate.certificate is not None]
    best = min(candidates, key=worst)
    if not run.program.homogeneous:  # the bounds of T14 need a limit problem
        return run.end(Status.NOT_CERTIFIED, best)
    upper = upper_bound(run.program.associated(), first.inner, run.options.tolerance)
    least = frictionless(run.program)
    smooth = run.solve("frictionless", least.contact, program=least.program).inner
    lower = lower_bound(least.program, smooth, run.options.tolerance)
    locked = locked and not run.program.frictional
    status = Status.JAM if locked and max(run.rates, default=0.0) >= 1 else Status.NOT_CERTIFIED
    return run.end(status, best, bracket=(lower, upper))
