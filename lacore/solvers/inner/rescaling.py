"""A program in units of its parts, so that a stone is solved as accurately as the wall under it.

A solver stops when its residuals are small compared with the largest numbers it sees, which do not
include the forces of a light block. In units of its velocity ``s = 1/force`` they are as large as
others:

    U = S q,   F0, Fd, bounds, stresses of a part times s,   contact rows per s of the faster part

The units are found by solving: they follow from the loads and reactions of the last answer, and are
renewed only while the residuals by part (`lacore.program.certificate`) require it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix, diags_array

from lacore.numerics.arrays import Floats, Sparse
from lacore.program.certificate import Certificate
from lacore.program.kinematic import ContactRows, DissipationGroup, FrozenContact, KinematicProgram
from lacore.program.part_forces import own_loads, part_forces
from lacore.program.residuals import dilates_besides, solve_residual
from lacore.program.state import ProgramState
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution, Prepare, PreparedSolver, checked_answer
from lacore.solvers.inner.rigid_cleaning import cleaned

GOOD = 1e-8  # required residual by default
# share of the tolerance for the residual of a solve, which leaves the rest to the loop
_SHARE = 0.1
_SPREAD = 1e2  # ratio of forces that is not scaled, as solvers handle it
_WIDE = 1e4  # ratio of loads above which units of parts are used from the start
_BAR = 1e-6  # default tolerance of states
_CLAIMS = (Status.LOCKED, Status.UNSAFE)
_TRIES = 4  # Each solve gains as many digits as the last one had.
_GAIN = 0.5  # reduction of the residual that units must achieve to be kept


@dataclass(frozen=True)
class PartUnits:
    """Units of a scaled program: value in the program = unit * value in these units.

    Attributes:
        forces: scale of the forces of each part, shape (parts,).
        unknowns: units of the unknowns, shape (n,): `velocity` divided by the force of the part.
        groups, points: inverse force of the fastest part of a cone or contact point, shape (m,)
            each.
        velocity: largest velocity in these units; by the load factor, too.
    """

    forces: Floats
    unknowns: Floats
    groups: tuple[Floats, ...]
    points: Floats
    velocity: float

    @classmethod
    def of(cls, program: KinematicProgram, forces: Floats, velocity: Floats | None) -> "PartUnits":
        """Return the units for forces of parts, and a velocity if one is known."""
        own = (forces.max() / forces)[program.part]
        rows = program.contact
        meeting = _points(rows.tangential, rows.tangent_dim)
        if velocity is None:
            fastest = 1 / float(np.abs(own * program.reference_load).sum())
        else:
            fastest = float(np.abs(velocity / own).max())
        return cls(
            forces=forces,
            unknowns=own * fastest,
            groups=tuple(
                _largest(own, _points(g.rows, g.dim), _points(g.volumetric, g.volumes))
                for g in program.groups
            ),
            points=_largest(own, meeting, rows.normal),
            velocity=fastest,
        )

    def suit(self, other: "PartUnits", speeds: bool = True) -> bool:
        """Return whether a solver would see similar numbers in other units.

        Without `speeds`, only the units of forces are compared.
        """
        ratio = other.forces / self.forces
        faster = other.velocity / self.velocity if speeds else 1.0
        return bool(ratio.max() <= _SPREAD * ratio.min() and 1 / _SPREAD <= faster <= _SPREAD)

    def program(self, program: KinematicProgram) -> KinematicProgram:
        """Return the program in these units."""
        rows, fastest = program.contact, self.velocity
        columns = diags_array(self.unknowns / fastest)

        def cut(matrix: Sparse, units: Floats) -> Sparse:
            return csr_matrix(diags_array(1 / units) @ matrix @ columns)

        def group(own: DissipationGroup, units: Floats) -> DissipationGroup:
            return replace(
                own,
                rows=cut(own.rows, np.repeat(units, own.dim)),
                volumetric=cut(own.volumetric, np.repeat(units, own.volumes)),
                bound=own.bound * units,
                surfaces=None
                if own.surfaces is None
                else own.surfaces.times(units, 1 / (units * fastest)),
                modulus=None if own.modulus is None else own.modulus * units**2 * fastest,
            )

        contact: ContactRows = replace(
            rows,
            normal=cut(rows.normal, self.points),
            tangential=cut(rows.tangential, np.repeat(self.points, rows.tangent_dim)),
            limit=rows.limit * self.points,
            tension=None if rows.tension is None else rows.tension * self.points,
            closing=None if rows.closing is None else rows.closing / (self.points * fastest),
        )
        return replace(
            program,
            groups=tuple(group(g, s) for g, s in zip(program.groups, self.groups, strict=True)),
            contact=contact,
            reference_load=program.reference_load * self.unknowns,
            dead_load=program.dead_load * self.unknowns / fastest,
        )

    def contact(self, contact: FrozenContact) -> FrozenContact:
        """Return a frozen contact in these units."""
        shift = contact.shift / (self.points * self.velocity)
        return FrozenContact(contact.bound * self.points, contact.dilatancy, shift)

    def back(self, point: ProgramState) -> ProgramState:
        """Return a state in the units of the program."""
        return ProgramState(
            velocity=point.velocity * self.unknowns,
            load_factor=point.load_factor * self.velocity,
            stress=tuple(s / u[:, None] for s, u in zip(point.stress, self.groups, strict=True)),
            mean_stress=tuple(
                p / np.repeat(u, p.size // max(u.size, 1))
                for p, u in zip(point.mean_stress, self.groups, strict=True)
            ),
            normal_reaction=point.normal_reaction / self.points,
            tangential_reaction=point.tangential_reaction / self.points[:, None],
        )


def _points(rows: Sparse, dim: int) -> Sparse:
    """Return the sizes of the rows of each point or cone, shape (m, n)."""
    count = rows.shape[0] // dim
    every = np.arange(count * dim)
    pick = csr_matrix((np.ones(every.size), (every // dim, every)), (count, every.size))
    return csr_matrix(pick @ abs(rows))


def _largest(units: Floats, *rows: Sparse) -> Floats:
    """Return the largest unit of the unknowns in each row, 1 in an empty one, shape (m,)."""
    result = np.zeros(rows[0].shape[0])
    for part in rows:
        touched = csr_matrix(part).tocoo()
        np.maximum.at(result, touched.row, units[touched.col])
    return np.where(result > 0, result, 1.0)


def good_for(bar: float) -> float:
    """Return the required residual of an inner solve for a tolerance of states."""
    return _SHARE * bar


def largest_residual(
    program: KinematicProgram, answer: InnerSolution, contact: FrozenContact
) -> float:
    """Return the largest residual of an answer by the laws of its solve; inf without a point.

    It is the residual of `proven`: without dissipation, powers have another scale.
    """
    if answer.point is None:
        return np.inf
    left = solve_residual(program, answer.point, contact, _BAR)[1]
    return left if np.isfinite(left) else np.inf


def of_both(answer: InnerSolution, one: InnerSolution, other: InnerSolution) -> InnerSolution:
    """Return an answer with the iterations and the time of two solves."""
    return replace(
        answer,
        iterations=one.iterations + other.iterations,
        solve_time=one.solve_time + other.solve_time,
        reported_time=one.reported_time + other.reported_time,
    )


def proven(
    program: KinematicProgram, answer: InnerSolution, contact: FrozenContact, good: float
) -> InnerSolution:
    """Return the answer, as "almost solved" if its recomputed residual exceeds the tolerance.

    Solvers measure by the largest numbers that they see, and may report as solved what is out of
    balance by a percent in a light part. With prescribed dilation there is no residual to check.
    """
    bar = max(good / _SHARE, _BAR)
    if answer.status is not Status.SOLVED or answer.point is None or dilates_besides(program):
        return answer
    name, left = solve_residual(program, answer.point, contact, bar)
    if left <= bar:
        return answer
    said = f"the residual {name!r}, recomputed, is {left:.1e}"
    message = "; ".join(filter(None, [answer.message, said]))
    return replace(answer, status=Status.ALMOST_SOLVED, message=message)


class RescalingSolver:
    """Prepared solver that scales parts of a program, with answers in its original units.

    Args:
        program: the program.
        prepare: prepares a solver for a program.
        good: residual with which an answer needs no other units.
    """

    def __init__(self, program: KinematicProgram, prepare: Prepare, good: float = GOOD) -> None:
        self._program, self._prepare, self._good = program, prepare, good
        self._units: PartUnits | None = None
        self._refused: list[PartUnits] = []  # units that gained nothing
        loads = own_loads(program, 1.0)
        least = float(loads[loads > 0].min(initial=np.inf))
        if loads.max() > _WIDE * least:
            self._units = PartUnits.of(program, np.maximum(loads, least), None)
        self._solver = self._prepared()

    def _prepared(self) -> PreparedSolver:
        units = self._units
        return self._prepare(self._program if units is None else units.program(self._program))

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve with the backend, and again in better units while they gain.

        Units that gain nothing are dropped, and similar ones are not tried again: tall walls of
        thousands of blocks are solved best without units, although their residuals remain large.
        """
        best, residual = self._measured(contact)
        claims = best.status in _CLAIMS or (best.status is Status.SOLVED and residual <= _BAR)
        if self._units is not None and not claims and residual > self._good:
            best, residual = self._unscaled(best, residual, contact)
        best, residual = self._refined(best, residual, contact)
        if residual <= self._good:
            return best
        best = self._cleaned(best, contact, residual)
        return proven(self._program, best, contact, self._good)

    def _measured(self, contact: FrozenContact) -> tuple[InnerSolution, float]:
        """Return an answer and its largest residual."""
        answer = self._asked(contact)
        return answer, largest_residual(self._program, answer, contact)

    def _unscaled(
        self, best: InnerSolution, residual: float, contact: FrozenContact
    ) -> tuple[InnerSolution, float]:
        """Return the better of an answer and one without units, as units of loads may be worse."""
        self._renew(None)
        plain, found = self._measured(contact)
        gained = found <= residual or (plain.status in _CLAIMS and residual > _BAR)
        return of_both(plain if gained else best, best, plain), found if gained else residual

    def _refined(
        self, best: InnerSolution, residual: float, contact: FrozenContact
    ) -> tuple[InnerSolution, float]:
        """Solve in units of the forces of the last answer, repeatedly while these gain."""
        tried = list(self._refused)
        for _ in range(_TRIES):
            better = None if residual <= self._good else self._better_units(best, tried)
            if better is None:
                break
            before = self._units
            self._renew(better)
            answer, found = self._measured(contact)
            pair = self._paired(best, answer, contact)
            together = largest_residual(self._program, pair, contact)
            gains, both = found <= _GAIN * residual, together <= _GAIN * min(found, residual)
            closer = pair if both else answer if found < residual else best
            best = of_both(closer, best, answer)
            if not gains:
                tried.append(better)
                self._renew(before)
                if not both:
                    self._refused.append(better)
            least = together if both else found
            if not least < residual:
                break
            residual = least
        return best, residual

    def _better_units(self, best: InnerSolution, tried: Sequence[PartUnits]) -> PartUnits | None:
        """Return units of the forces of an answer; None if known or tried ones are similar."""
        if best.point is None:
            return None
        forces = part_forces(self._program, best.point)
        # Speeds of pressed soil are local, and have separate units.
        speeds = not self._program.pressure_dependent
        if forces.size == 1 and not speeds:
            return None
        better = PartUnits.of(self._program, forces, best.point.velocity)
        known = self._units or PartUnits.of(self._program, np.ones(forces.size), None)
        suited = any(units.suit(better, speeds=speeds) for units in (known, *tried))
        return None if suited else better

    def _paired(
        self, one: InnerSolution, other: InnerSolution, contact: FrozenContact
    ) -> InnerSolution:
        """Return the velocity of one answer with the forces of the other, whichever pair is better.

        Without units velocities are admissible and light blocks out of balance; in units of their
        forces these balance, but penetrate others.
        """
        if one.point is None or other.point is None or dilates_besides(self._program):
            return other
        sure = one if one.status is Status.SOLVED else other
        pairs = [
            replace(sure, point=replace(static, velocity=kinematic.velocity))
            for kinematic, static in ((one.point, other.point), (other.point, one.point))
        ]
        return min(pairs, key=lambda pair: largest_residual(self._program, pair, contact))

    def _cleaned(
        self, best: InnerSolution, contact: FrozenContact, residual: float
    ) -> InnerSolution:
        """Return the answer with an admissible velocity if its largest residual is penetration."""
        tried = self._units is not None or self._refused
        if not tried or best.point is None:
            return best
        if Certificate.of(self._program, best.point, contact).penetration < residual:
            return best  # A different velocity would hardly reduce the other residuals.
        point = cleaned(self._program, best.point, contact)
        if largest_residual(self._program, replace(best, point=point), contact) < residual:
            return replace(best, point=point)
        return best

    def _renew(self, units: PartUnits | None) -> None:
        self._solver.close()
        self._units = units
        self._solver = self._prepared()

    def _asked(self, contact: FrozenContact) -> InnerSolution:
        if self._units is None:
            return checked_answer(self._program, False, self._solver.solve(contact))
        answer = self._solver.solve(self._units.contact(contact))
        answer = checked_answer(self._program, False, answer)
        point = answer.point
        return answer if point is None else replace(answer, point=self._units.back(point))

    def close(self) -> None:
        """Close the solver."""
        self._solver.close()
