"""LOCKED, UNSAFE and a jam are claims like a load factor: proven here, or not made (T13)."""

from collections.abc import Callable

from lacore.backend import PreparedSolver
from lacore.claims.dead_collapse import dead_collapse
from lacore.claims.locking_ray import locking_ray
from lacore.program import FrozenContact, KinematicProgram
from lacore.status import Status

Prepare = Callable[[KinematicProgram], PreparedSolver]
CLAIMED = (Status.LOCKED, Status.UNSAFE, Status.JAM)


def judged_claim(
    status: Status,
    program: KinematicProgram,
    admitting: FrozenContact,
    carrying: FrozenContact,
    prepare: Prepare,
    tolerance: float,
) -> tuple[Status, str]:
    """What a claim is worth, and in words why another status takes its place; else no words.

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
        return status, ""
    if dead_collapse(program.associated(), carrying, prepare, tolerance) is not None:
        return Status.UNSAFE, ""
    if status is Status.JAM:
        return status, ""
    if status is Status.UNSAFE:
        return Status.NOT_CERTIFIED, (
            "the solver calls the structure unsafe, and no mechanism of the dead load proves it"
        )
    ray = locking_ray(program.at_friction(0.0), admitting)
    if ray.proves:
        return status, ""
    return Status.NOT_CERTIFIED, (
        "the solver calls the load locked, and no reactions carry it alone: the closest leave"
        f" {ray.residual:.1e} of the forces"
    )
