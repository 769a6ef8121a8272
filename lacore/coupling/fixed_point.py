"""Fixed-point loops on Coulomb friction (T9-T11).

A loop freezes the friction bounds ``mu t_n``, the shifts ``mu ||u_t||``, or a share of both, solves
the convex program, and repeats with the values of its solution.
"""

import numpy as np

from lacore.coupling.run import Coupled, Run
from lacore.numerics.anderson import Anderson
from lacore.numerics.arrays import Floats
from lacore.program.kinematic import (
    FrozenContact,
    KinematicProgram,
    associated_contact,
    family_contact,
    frictionless_contact,
)
from lacore.program.state import ProgramState
from lacore.reporting.status import Status


def reaction_loop(run: Run) -> Coupled:
    """Iterate on the normal reactions (T9), with damping and acceleration."""
    return _family_loop(run, "reaction", 0.0)


def shift_loop(run: Run) -> Coupled:
    """Iterate on the slip rates (T10), with damping and acceleration."""
    return _family_loop(run, "shift", 1.0)


def slip_rate(program: KinematicProgram, state: ProgramState) -> Floats:
    """Return ``||u_t||`` at the contact points, shape (m,)."""
    return np.asarray(np.linalg.norm(program.contact.slip(state.velocity), axis=1))


def _family_loop(run: Run, kind: str, kappa: float) -> Coupled:
    rows = run.program.contact
    zero = frictionless_contact(rows)
    if not rows.coulomb.any():
        return run.finish(run.solve("single", zero))

    start = run.options.start
    if start == "associated":
        first = run.solve(start, associated_contact(rows))
        if first.inner.status is Status.LOCKED:  # with friction the load factor may be finite (T13)
            start = "zero"
    if start == "zero":
        first = run.solve(start, zero)
        if first.inner.status is Status.UNSAFE:
            return run.end(Status.INVALID_START)
    if first.inner.point is None:
        return run.end(first.inner.status)
    return fixed_point(
        run, kind, kappa, first.inner.point, Anderson(run.options.anderson, run.options.damping)
    )


def fixed_point(
    run: Run, kind: str, kappa: float, start: ProgramState, mixing: Anderson
) -> Coupled:
    """Iterate from a state until one is proven or the budget is spent."""
    program, rows = run.program, run.program.contact
    reaction_size = _size(start.normal_reaction)
    slip_size = _size(start.velocity)

    def read(state: ProgramState) -> Floats:
        reaction, slip = state.normal_reaction, slip_rate(program, state)
        return np.concatenate([(1 - kappa) / reaction_size * reaction, kappa / slip_size * slip])

    def freeze(values: Floats) -> FrozenContact:
        reaction, slip = np.split(values, 2)
        reaction = reaction * reaction_size / (1 - kappa) if kappa < 1 else reaction
        slip = slip * slip_size / kappa if kappa > 0 else slip
        return family_contact(rows, kappa, reaction, slip)

    values = np.maximum(read(start), 0.0)
    while not run.exhausted:
        iterate = run.solve(kind, freeze(values))
        point, status = iterate.inner.point, iterate.inner.status
        # These statuses hold at the frozen values only, not for the Coulomb problem (T13).
        if status is Status.UNSAFE or (status is Status.LOCKED and kappa > 0):
            return run.end(Status.NOT_CONVERGED)
        out_of_budget = status in (Status.ITERATION_LIMIT, Status.TIME_LIMIT)
        if point is None or out_of_budget or run.proven(iterate) or run.free(iterate):
            return run.finish(iterate)
        image = read(point)
        run.mapped(kind, values, image)
        values = np.maximum(mixing.step(values, image), 0.0)
    status = run.iterates[-1].inner.status
    finished = status in (Status.SOLVED, Status.ALMOST_SOLVED)
    return run.end(Status.NOT_CONVERGED if finished else status)


def _size(values: Floats) -> float:
    """Return the largest absolute value, or 1 if all values are zero."""
    return float(np.abs(values).max(initial=0.0)) or 1.0
