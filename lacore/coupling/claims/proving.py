"""Prove that a program is LOCKED, UNSAFE or jammed, or withdraw the claim (T13)."""

from contextlib import closing

from lacore.coupling.claims.dead_collapse import DeadCollapse, dead_collapse
from lacore.coupling.claims.locking_ray import LockingRay, locking_ray
from lacore.program.certificate import Certificate
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Status
from lacore.solvers.backend import Prepare, checked_answer
from lacore.solvers.inner.preparing import preparer_named
from lacore.solvers.registry import PROVING_BACKEND

Ray = LockingRay | DeadCollapse
CLAIMED = (Status.LOCKED, Status.UNSAFE, Status.JAM)


def prove_claim(
    status: Status,
    program: KinematicProgram,
    kinematic_contact: FrozenContact,
    static_contact: FrozenContact,
    prepare: Prepare,
    tolerance: float,
) -> tuple[Status, Finding | None, Ray | None]:
    """Return the status that is proven in place of a claim, why it differs, and its proof.

    A mechanism of the dead load proves UNSAFE, even if the loop reported LOCKED or JAM: a part that
    the load cannot move may be next to a part that collapses. Reactions that carry the reference
    load alone prove LOCKED. A claim without either proof becomes NOT_CERTIFIED.

    Args:
        status: LOCKED, UNSAFE or JAM; any other status is returned unchanged.
        program: Dimensionless program. Soils with non-associated flow are taken to carry what they
            would carry with associated flow.
        kinematic_contact: Contact that defines the admissible velocities: that of the solve, or
            frictionless contact for a claim on Coulomb friction.
        static_contact: Contact that defines the admissible reactions: that of the solve, or
            associated contact.
        prepare: Function that prepares an exact backend for a program.
        tolerance: Tolerance for the residuals of a velocity.
    """
    if status not in CLAIMED:
        return status, None, None
    collapse = dead_collapse(program.associated(), static_contact, prepare, tolerance)
    if collapse is not None:
        return Status.UNSAFE, None, collapse
    if status is Status.JAM:
        return status, None, None
    if status is Status.UNSAFE:
        why = Finding(Kind.UNSAFE_NOT_PROVEN, severity=Severity.REASON)
        return Status.NOT_CERTIFIED, why, None
    ray = locking_ray(program.at_friction(0.0), kinematic_contact)
    if ray is not None and ray.proves:
        return status, None, ray
    if refuted := _mechanism(program.at_friction(0.0), kinematic_contact, tolerance):
        return Status.NOT_CERTIFIED, refuted, None
    kind, values = Kind.LOCKED_UNKNOWN, dict[str, float]()
    if ray is not None:
        kind, values = Kind.LOCKED_NOT_PROVEN, {"residual": ray.residual}
    why = Finding(kind, values=values, severity=Severity.REASON)
    return Status.NOT_CERTIFIED, why, None


def _mechanism(
    program: KinematicProgram, contact: FrozenContact, tolerance: float
) -> Finding | None:
    """Return how a mechanism refutes that the load is locked; None if none is found.

    The mechanism is computed by lacore's own backend, not by the one that made the claim.
    """
    with closing(preparer_named(PROVING_BACKEND, {})(program)) as solver:
        point = checked_answer(program, False, solver.solve(contact)).point
    if point is None:
        return None
    found = Certificate.of(program, point, contact)
    sizes = {name: getattr(found, name) for name in ("penetration", "divergence", "normalisation")}
    if not all(size <= tolerance for size in sizes.values()):
        return None
    return Finding(Kind.LOCKED_REFUTED, (), {"backend": PROVING_BACKEND, **sizes}, Severity.REASON)
