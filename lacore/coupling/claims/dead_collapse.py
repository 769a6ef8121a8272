"""Prove that a structure collapses under its dead load, whatever the load factor is (T13).

No load factor keeps equilibrium if and only if the dead load drives a velocity at which the
reference load has no power: ``F0.u = 0, Fd.u > D(u)``. The status that a solver reports does not
prove it. The velocity does, and its residuals are recomputed here.
"""

from dataclasses import dataclass, replace
from warnings import warn

import numpy as np
from scipy.sparse import csr_matrix, diags_array, eye_array, hstack, vstack

from lacore.numerics.arrays import Floats
from lacore.numerics.linear_program import least
from lacore.program.certificate import Certificate
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.part_forces import own_loads
from lacore.program.state import ProgramState
from lacore.reporting.showing import Compact
from lacore.solvers.backend import Prepare, checked_answer
from lacore.solvers.inner.rescaling import PartUnits
from lacore.solvers.inner.rigid_cleaning import cleaned


@dataclass(frozen=True, repr=False)
class DeadCollapse(Compact):
    """Proof that a structure is unsafe: a mechanism that the dead load drives alone (T13).

    Attributes:
        power: Power of the dead loads ``Fd.u``, including the tension that holds contact shut:
            1 up to round-off.
        dissipated_share: Dissipation ``D(u)``, the share of the dead load that this mechanism could
            carry, below 1.
        felt: Power of the reference load ``|F0.u|`` divided by the sum of the sizes of F0 and by
            the largest velocity: 0 up to round-off.
        impossible: Larger of penetration and divergence, as in `Certificate`.
        point: State with the velocity of all unknowns, m/s, and without stresses or reactions.
            ``dataclasses.replace(state, point=state.ray.point).velocity`` shows it by body.
    """

    power: float
    dissipated_share: float
    felt: float
    impossible: float
    point: ProgramState

    def proves(self, tolerance: float) -> bool:
        """Whether nothing can carry the dead loads, given a tolerance for the residuals.

        The result is false if a residual is NaN.
        """
        residuals = (abs(self.power - 1), self.felt, self.impossible)
        return (
            all(value <= tolerance for value in residuals) and self.dissipated_share < 1 - tolerance
        )

    @property
    def carried(self) -> float:
        """Former name of `dissipated_share`."""
        warn("carried is now dissipated_share", DeprecationWarning, stacklevel=2)
        return self.dissipated_share

    def __str__(self) -> str:
        return (
            f"dissipated {self.dissipated_share:.3g} of the power of the dead loads, power of the"
            f" reference load {self.felt:.1e}, not possible {self.impossible:.1e}: a mechanism"
            " falls"
        )


def dead_collapse(
    program: KinematicProgram,
    contact: FrozenContact,
    prepare: Prepare,
    tolerance: float,
) -> DeadCollapse | None:
    """Return a mechanism that the dead load drives; None if none is found that proves a collapse.

    Args:
        program: Dimensionless program.
        contact: Frozen contact of one solve; dilatant contact for a statement on Coulomb friction.
        prepare: Function that prepares an exact backend for a program.
        tolerance: Tolerance for the residuals of the velocity.
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
    """Return the collapse by a velocity, with recomputed residuals.

    A velocity that penetrates contact is first replaced by one that does not.
    """
    moving = ProgramState.unstressed(driven, velocity, 1.0)
    if not Certificate.of(driven, moving, frozen).penetration <= tolerance:
        moving = cleaned(driven, moving, frozen)
    u, seen = moving.velocity, Certificate.of(driven, moving, frozen)
    load, fastest = np.abs(program.reference_load).sum(), np.abs(u).max() or 1.0
    return DeadCollapse(
        power=float(program.dead_load @ u),
        dissipated_share=driven.plastic_dissipation(u)
        + driven.friction_dissipation(u, frozen.bound),
        felt=float(abs(program.reference_load @ u) / (load * fastest)),
        impossible=float(np.max([seen.penetration, seen.divergence])),
        point=ProgramState.unstressed(program, u, 0.0),
    )


def _driven(
    program: KinematicProgram, contact: FrozenContact
) -> tuple[KinematicProgram, FrozenContact]:
    """Return the program driven by its dead load, with ``F0.u = 0`` as one more contact point.

    The additional point sticks.
    """
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
    # The normal row of the additional point is zero and its gap is open, so its pressure is zero.
    frozen = FrozenContact(
        more(contact.bound, np.inf), more(contact.dilatancy, 0.0), more(contact.shift, 1.0)
    )
    return driven, frozen


def _by_cones(
    driven: KinematicProgram,
    frozen: FrozenContact,
    prepare: Prepare,
) -> Floats | None:
    """Return the velocity with the least dissipation."""
    solver = prepare(driven)
    try:
        point = checked_answer(driven, False, solver.solve(frozen)).point
    finally:
        solver.close()
    return None if point is None else point.velocity


def _by_lines(driven: KinematicProgram, frozen: FrozenContact) -> Floats | None:
    """Return the velocity of the largest power among those of at most 1 in units of the parts.

    This linear program always has a solution, however different the weights of the parts are.
    """
    loads = own_loads(driven, 1.0)
    units = PartUnits.of(driven, np.maximum(loads, loads[loads > 0].min()), None)
    program, contact = units.program(driven), units.contact(frozen)
    rows, n = program.contact, program.n
    stick = np.isinf(contact.bound)
    dilated = diags_array(contact.dilatancy) @ rows.tangential
    rubbing = ~stick & (contact.bound > 0)
    costly = csr_matrix(vstack([*(g.rows for g in program.groups), rows.tangential[rubbing]]))
    dissipated = np.concatenate(
        [*(g.weights * g.bound for g in program.groups), (rows.weights * contact.bound)[rubbing]]
    )
    price = units.velocity * dissipated  # per unit power of the load, as a load factor is
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
