"""Whether a structure that its reference load cannot move collapses under its dead load alone.

"No admissible mechanism feels the reference load" does not say that there is equilibrium: what the
load holds in place may stand beside what falls down.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.arrays import Floats
from lacore.backend import PreparedSolver, checked_answer
from lacore.certificate import certify
from lacore.program import FrozenContact, KinematicProgram


def collapses(
    program: KinematicProgram,
    contact: FrozenContact,
    prepare: Callable[[KinematicProgram], PreparedSolver],
    tolerance: float,
) -> bool:
    """Whether a velocity with ``F0.u >= 0`` is driven by the dead load: ``Fd.u > D(u)``.

    Then no load factor keeps equilibrium as long as no ``F0.u > 0`` is admissible (T13).

    Args:
        program: dimensionless.
        contact: of one solve; dilatant points for a statement of Coulomb friction.
        prepare: sets an exact backend to work on a program.
        tolerance: bar for the residuals of the velocity.
    """
    size = float(np.abs(program.dead_load).sum())
    if not size > 0:
        return False
    driven, frozen = _driven(program, contact, size)
    solver = prepare(driven)
    try:
        point = checked_answer(driven, False, solver.solve(frozen)).point
    finally:
        solver.close()
    if point is None:
        return False
    seen = certify(driven, point, frozen)
    if not all(v <= tolerance for v in (seen.penetration, seen.divergence, seen.normalisation)):
        return False
    u = point.velocity
    dissipated = driven.plastic_dissipation(u) + driven.friction_dissipation(u, frozen.bound)
    return dissipated < (1 - tolerance) * size


def _driven(
    program: KinematicProgram, contact: FrozenContact, size: float
) -> tuple[KinematicProgram, FrozenContact]:
    """The program driven by its dead load per `size`, with ``F0.u >= 0`` as one more point."""
    rows, n = program.contact, program.n
    against = csr_matrix(program.reference_load / np.abs(program.reference_load).sum())

    def more(values: Floats, last: float) -> Floats:
        return np.append(values, last)

    driven = replace(
        program,
        contact=replace(
            rows,
            normal=csr_matrix(vstack([rows.normal, against])),
            tangential=csr_matrix(vstack([rows.tangential, csr_matrix((rows.tangent_dim, n))])),
            weights=more(rows.weights, 1.0),
            coefficient=more(rows.coefficient, 0.0),
            limit=more(rows.limit, 0.0),
            dilatancy=more(rows.dilatancy, 0.0),
            interface=np.append(rows.interface, 0),
        ),
        reference_load=program.dead_load / size,
        dead_load=np.zeros(n),
    )
    frozen = FrozenContact(
        more(contact.bound, 0.0), more(contact.dilatancy, 0.0), more(contact.shift, 0.0)
    )
    return driven, frozen
