"""LOCKED, UNSAFE and a jam are claims like a load factor: proven here, or not made (T13)."""

from collections.abc import Callable
from contextlib import closing

import numpy as np

from lacore.backend import PreparedSolver, checked_answer, find_backend, read_options
from lacore.certificate import certify
from lacore.claims.dead_collapse import DeadCollapse, dead_collapse
from lacore.claims.locking_ray import LockingRay, locking_ray
from lacore.inner.preparing import preparing
from lacore.program import FrozenContact, KinematicProgram
from lacore.solvers.registry import JUDGE
from lacore.status import Status

Prepare = Callable[[KinematicProgram], PreparedSolver]
Ray = LockingRay | DeadCollapse
CLAIMED = (Status.LOCKED, Status.UNSAFE, Status.JAM)


def judged_claim(
    status: Status,
    program: KinematicProgram,
    admitting: FrozenContact,
    carrying: FrozenContact,
    prepare: Prepare,
    tolerance: float,
) -> tuple[Status, str, Ray | None]:
    """What a claim is worth, in words why another status takes its place, and what proves it.

    A structure is UNSAFE by a mechanism of its dead load, also where it was called locked or
    jammed: what the load cannot move may stand beside what falls. It is LOCKED by reactions that
    carry the reference load alone. A claim that neither proves is NOT_CERTIFIED.

    Args:
        status: LOCKED, UNSAFE or JAM; any other is returned as it is.
        program: dimensionless; soils whose flow is not associated carry what they would if it were.
        admitting: contact whose velocities are admissible: that of the solve, or for a claim of
            Coulomb friction one without any.
        carrying: contact whose reactions are admissible: that of the solve, or the associated one.
        prepare: sets an exact backend to work on a program.
        tolerance: bar for the residuals of a velocity.
    """
    if status not in CLAIMED:
        return status, "", None
    collapse = dead_collapse(program.associated(), carrying, prepare, tolerance)
    if collapse is not None:
        return Status.UNSAFE, "", collapse
    if status is Status.JAM:
        return status, "", None
    if status is Status.UNSAFE:
        why = "the solver calls the structure unsafe, and no mechanism of the dead load proves it"
        return Status.NOT_CERTIFIED, why, None
    ray = locking_ray(program.at_friction(0.0), admitting)
    if ray is not None and ray.proves:
        return status, "", ray
    if why := _mechanism(program.at_friction(0.0), admitting, tolerance):
        return Status.NOT_CERTIFIED, why, None
    left = np.nan if ray is None else ray.residual
    why = (
        "the solver calls the load locked, and no reactions carry it alone: the closest leave"
        f" {left:.1e} of the forces"
    )
    return Status.NOT_CERTIFIED, why, None


def _mechanism(program: KinematicProgram, contact: FrozenContact, tolerance: float) -> str:
    """Return how a mechanism refutes that the load is locked; empty if none is found.

    It is asked of lacore's own backend, not of the one that made the claim.
    """
    judge = find_backend(JUDGE)
    with closing(preparing(judge, read_options(judge, {}))(program)) as solver:
        point = checked_answer(program, False, solver.solve(contact)).point
    if point is None:
        return ""
    found = certify(program, point, contact)
    sizes = {name: getattr(found, name) for name in ("penetration", "divergence", "normalisation")}
    if not all(size <= tolerance for size in sizes.values()):
        return ""
    shown = ", ".join(f"{name} {size:.1e}" for name, size in sizes.items())
    return (
        "the solver calls the load locked, but the program is feasible: backend"
        f" {JUDGE!r} finds an admissible mechanism with F0.U = 1 ({shown})"
    )
