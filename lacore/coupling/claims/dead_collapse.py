"""Whether a structure collapses under its dead load alone, whatever the load factor is (T13).

No load factor keeps equilibrium if and only if a velocity that the reference load does not feel is
driven by the dead load: ``F0.u = 0, Fd.u > D(u)``. A solver's word for it is no proof; the velocity
is, and our own code judges it.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix, diags_array, eye_array, hstack, vstack

from lacore.numerics.arrays import Floats
from lacore.numerics.linear_program import least
from lacore.program.certificate import certify
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.part_forces import own_loads
from lacore.program.state import ProgramState
from lacore.reporting.showing import Compact
from lacore.solvers.backend import Prepare, checked_answer
from lacore.solvers.inner.rescaling import PartUnits
from lacore.solvers.inner.rigid_cleaning import cleaned


@dataclass(frozen=True, repr=False)
class DeadCollapse(Compact):
    """Why a structure is unsafe: a mechanism by which the dead load falls, whatever is added (T13).

    Attributes:
        power: of the dead loads, ``Fd.u``, what holds contact shut among them: 1 but for round-off.
        carried: ``D(u)``, the share of the dead load that this mechanism could carry, below 1.
        felt: ``|F0.u|`` per sum of the sizes of F0 and largest velocity: 0 but for round-off.
        impossible: the larger of penetration and divergence, as in `Certificate`.
        point: its velocity, all unknowns, m/s, and no stresses or reactions.
            ``dataclasses.replace(state, point=state.ray.point).velocity`` shows it by body.
    """

    power: float
    carried: float
    felt: float
    impossible: float
    point: ProgramState

    def proves(self, tolerance: float) -> bool:
        """Whether nothing can carry the dead loads, by a bar for the residuals; false for NaN."""
        residuals = (abs(self.power - 1), self.felt, self.impossible)
        return all(value <= tolerance for value in residuals) and self.carried < 1 - tolerance

    def __str__(self) -> str:
        return (
            f"dissipated {self.carried:.3g} of the power of the dead loads, power of the reference"
            f" load {self.felt:.1e}, not possible {self.impossible:.1e}: a mechanism falls"
        )


def dead_collapse(
    program: KinematicProgram,
    contact: FrozenContact,
    prepare: Prepare,
    tolerance: float,
) -> DeadCollapse | None:
    """The mechanism by which the dead load falls; None where none is found that proves it.

    Args:
        program: dimensionless.
        contact: of one solve; dilatant points for a statement of Coulomb friction.
        prepare: sets an exact backend to work on a program.
        tolerance: bar for the residuals of the velocity.
    """
    if not np.any(program.dead_load):
        return None
    driven, frozen = _driven(program, contact)
    found = [_by_cones(driven, frozen, prepare)]
    if driven.largest_cone <= 1 and not (driven.hardens or driven.pressure_dependent):
        found.insert(0, _by_lines(driven, frozen))
    for velocity in found:
        if velocity is not None:
            collapse = _judged(program, driven, frozen, velocity, tolerance)
            if collapse.proves(tolerance):
                return collapse
    return None


def _judged(
    program: KinematicProgram,
    driven: KinematicProgram,
    frozen: FrozenContact,
    velocity: Floats,
    tolerance: float,
) -> DeadCollapse:
    """The collapse by a velocity, cleaned of what penetrates, with its residuals, recomputed."""
    moving = ProgramState.unstressed(driven, velocity, 1.0)
    if not certify(driven, moving, frozen).penetration <= tolerance:
        moving = cleaned(driven, moving, frozen)
    u, seen = moving.velocity, certify(driven, moving, frozen)
    load, fastest = np.abs(program.reference_load).sum(), np.abs(u).max() or 1.0
    return DeadCollapse(
        power=float(program.dead_load @ u),
        carried=driven.plastic_dissipation(u) + driven.friction_dissipation(u, frozen.bound),
        felt=float(abs(program.reference_load @ u) / (load * fastest)),
        impossible=float(np.max([seen.penetration, seen.divergence])),
        point=ProgramState.unstressed(program, u, 0.0),
    )


def _driven(
    program: KinematicProgram, contact: FrozenContact
) -> tuple[KinematicProgram, FrozenContact]:
    """The program driven by its dead load, with ``F0.u = 0`` as one more point, which sticks."""
    rows, n = program.contact, program.n
    held = csr_matrix(program.reference_load / np.abs(program.reference_load).sum())
    still = csr_matrix((rows.tangent_dim - 1, n))

    def more(values: Floats, last: float) -> Floats:
        return np.append(values, last)

    driven = replace(
        program,
        contact=replace(
            rows,
            normal=csr_matrix(vstack([rows.normal, csr_matrix((1, n))])),
            tangential=csr_matrix(vstack([rows.tangential, held, still])),
            weights=more(rows.weights, 1.0),
            coefficient=more(rows.coefficient, 0.0),
            limit=more(rows.limit, np.inf),
            dilatancy=more(rows.dilatancy, 0.0),
            interface=np.append(rows.interface, 0),
            tension=None if rows.tension is None else more(rows.tension, 0.0),
            closing=None if rows.closing is None else more(rows.closing, 0.0),
        ),
        reference_load=program.dead_load,
        dead_load=np.zeros(n),
    )
    # A row of zeros, strictly held: the point presses nothing.
    frozen = FrozenContact(
        more(contact.bound, np.inf), more(contact.dilatancy, 0.0), more(contact.shift, 1.0)
    )
    return driven, frozen


def _by_cones(
    driven: KinematicProgram,
    frozen: FrozenContact,
    prepare: Prepare,
) -> Floats | None:
    """The velocity that dissipates least."""
    solver = prepare(driven)
    try:
        point = checked_answer(driven, False, solver.solve(frozen)).point
    finally:
        solver.close()
    return None if point is None else point.velocity


def _by_lines(driven: KinematicProgram, frozen: FrozenContact) -> Floats | None:
    """The velocity of most power among those no faster than 1 in units of its parts.

    A linear program that always has a solution, however far apart weights are.
    """
    loads = own_loads(driven, 1.0)
    units = PartUnits.of(driven, np.maximum(loads, loads[loads > 0].min()), None)
    program, contact = units.program(driven), units.contact(frozen)
    rows, n = program.contact, program.n
    stick = np.isinf(contact.bound)
    dilated = diags_array(contact.dilatancy) @ rows.tangential
    rubbing = ~stick & (contact.bound > 0)
    costly = csr_matrix(vstack([*(g.rows for g in program.groups), rows.tangential[rubbing]]))
    price = np.concatenate(
        [*(g.weights * g.bound for g in program.groups), (rows.weights * contact.bound)[rubbing]]
    )
    bar = eye_array(price.size)
    none = csr_matrix((rows.count, price.size))
    equal = csr_matrix(vstack([rows.tangential[stick], *(g.volumetric for g in program.groups)]))
    found = least(
        np.concatenate([-program.reference_load, price]),
        at_most=(
            csr_matrix(
                vstack(
                    [
                        hstack([costly, -bar]),
                        hstack([-costly, -bar]),
                        hstack([dilated - rows.normal, none]),
                        hstack([-dilated - rows.normal, none]),
                    ]
                )
            ),
            np.concatenate([np.zeros(2 * price.size), contact.shift, contact.shift]),
        ),
        equal=(
            csr_matrix(hstack([equal, csr_matrix((equal.shape[0], price.size))])),
            np.zeros(equal.shape[0]),
        ),
        lower=np.concatenate([np.full(n, -1.0), np.zeros(price.size)]),
        upper=np.concatenate([np.ones(n), np.full(price.size, np.inf)]),
    )
    if found is None:
        return None
    velocity = units.unknowns * found[:n]
    power = float(driven.reference_load @ velocity)
    return velocity / power if power > 0 else None
