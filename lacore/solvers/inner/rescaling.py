"""A program in units of each of its parts, so that a stone is solved as well as the wall under it.

A solver ends when what is left is small beside the largest numbers it sees. Forces of a light
block are not among these. In units of its own velocity ``s = 1/force`` they are as large as others:

    U = S q,   F0, Fd, bounds, stresses of a part times s,   contact rows per s of the faster part

The units are found by solving: they are made of the loads and reactions of the answer before, and
made anew only while the residuals by part (`lacore.program.certificate`) ask for it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix, diags_array

from lacore.numerics.arrays import Floats, Sparse
from lacore.program.certificate import certify
from lacore.program.kinematic import ContactRows, DissipationGroup, FrozenContact, KinematicProgram
from lacore.program.part_forces import own_loads, part_forces
from lacore.program.state import ProgramState
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution, Prepare, PreparedSolver, checked_answer
from lacore.solvers.inner.left_over import dilates_besides, judged_left
from lacore.solvers.inner.rigid_cleaning import cleaned

GOOD = 1e-8  # residual with which those who state no bar ask for no more
_SHARE = 0.1  # of the bar: what a solve may leave, the rest is for the loop around it
_SPREAD = 1e2  # ratio of forces that solvers see as they are; its digits are left to them
_WIDE = 1e4  # ratio of loads from which units of parts are taken at once
_BAR = 1e-6  # that of states, where those who ask state none
_CLAIMS = (Status.LOCKED, Status.UNSAFE)
_TRIES = 4  # each gains the digits that the one before has
_GAIN = 0.5  # of the residual: what units that are kept leave


@dataclass(frozen=True)
class PartUnits:
    """Units in which a program is written anew: value in the program = unit * value in these.

    Attributes:
        forces: by which parts are judged, shape (parts,).
        unknowns: of each unknown, shape (n,): inverse to the force of its part, times `velocity`.
        groups, points: inverse to the force of the part that a cone or contact point can move
            fastest, shape (m,) each.
        velocity: of the fastest in these units; per load factor, too.
    """

    forces: Floats
    unknowns: Floats
    groups: tuple[Floats, ...]
    points: Floats
    velocity: float

    @classmethod
    def of(cls, program: KinematicProgram, forces: Floats, velocity: Floats | None) -> "PartUnits":
        """Units for forces of parts, and a velocity if one is known."""
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
        """Whether a solver would see much the same numbers in other units; of forces alone, too."""
        ratio = other.forces / self.forces
        faster = other.velocity / self.velocity if speeds else 1.0
        return bool(ratio.max() <= _SPREAD * ratio.min() and 1 / _SPREAD <= faster <= _SPREAD)

    def program(self, program: KinematicProgram) -> KinematicProgram:
        """The program in these units."""
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
        """What is frozen, in these units."""
        shift = contact.shift / (self.points * self.velocity)
        return FrozenContact(contact.bound * self.points, contact.dilatancy, shift)

    def back(self, point: ProgramState) -> ProgramState:
        """A state in the units of the program."""
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
    """Sizes of the rows of each point or cone together, shape (m, n)."""
    count = rows.shape[0] // dim
    every = np.arange(count * dim)
    pick = csr_matrix((np.ones(every.size), (every // dim, every)), (count, every.size))
    return csr_matrix(pick @ abs(rows))


def _largest(units: Floats, *rows: Sparse) -> Floats:
    """Of the unknowns in each row, 1 in an empty one, shape (m,)."""
    result = np.zeros(rows[0].shape[0])
    for part in rows:
        touched = csr_matrix(part).tocoo()
        np.maximum.at(result, touched.row, units[touched.col])
    return np.where(result > 0, result, 1.0)


def good_for(bar: float) -> float:
    """Residual of an inner solve that is good enough where states are judged by a bar."""
    return _SHARE * bar


def largest_residual(
    program: KinematicProgram, answer: InnerSolution, contact: FrozenContact
) -> float:
    """Of an answer, by the laws that it was asked with; infinite without a point.

    As `proven` judges it: where nothing is turned over, powers are not told per nothing.
    """
    if answer.point is None:
        return np.inf
    left = judged_left(program, answer.point, contact, _BAR)[1]
    return left if np.isfinite(left) else np.inf


def of_both(answer: InnerSolution, one: InnerSolution, other: InnerSolution) -> InnerSolution:
    """An answer with the iterations and the time of two solves."""
    return replace(
        answer,
        iterations=one.iterations + other.iterations,
        solve_time=one.solve_time + other.solve_time,
        reported_time=one.reported_time + other.reported_time,
    )


def proven(
    program: KinematicProgram, answer: InnerSolution, contact: FrozenContact, good: float
) -> InnerSolution:
    """The answer, "almost solved" where it is called solved and what it leaves is above the bar.

    Solvers measure by the largest numbers that they see, and call solved what is out of balance by
    a percent in a light part. Where flow dilates besides, no residual knows it.
    """
    bar = max(good / _SHARE, _BAR)
    if answer.status is not Status.SOLVED or answer.point is None or dilates_besides(program):
        return answer
    name, left = judged_left(program, answer.point, contact, bar)
    if left <= bar:
        return answer
    said = f"the residual {name!r}, recomputed, is {left:.1e}"
    message = "; ".join(filter(None, [answer.message, said]))
    return replace(answer, status=Status.ALMOST_SOLVED, message=message)


class RescalingSolver:
    """A prepared solver that is asked in units of parts, answering in those of the program.

    Args:
        program: as stated.
        prepare: sets a solver to work on one.
        good: residual with which an answer needs no other units.
    """

    def __init__(self, program: KinematicProgram, prepare: Prepare, good: float = GOOD) -> None:
        self._program, self._prepare, self._good = program, prepare, good
        self._units: PartUnits | None = None
        self._refused: list[PartUnits] = []  # that gained nothing
        loads = own_loads(program, 1.0)
        least = float(loads[loads > 0].min(initial=np.inf))
        if loads.max() > _WIDE * least:
            self._units = PartUnits.of(program, np.maximum(loads, least), None)
        self._solver = self._prepared()

    def _prepared(self) -> PreparedSolver:
        units = self._units
        return self._prepare(self._program if units is None else units.program(self._program))

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """As the backend does; again in better units while they gain.

        Units that gain nothing are left again, and no others like them are tried: tall walls of
        thousands of blocks are solved best as they are, though none of them is to a digit more.
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
        """Return the better of an answer and one without units: those of loads may be worse."""
        self._renew(None)
        plain, found = self._measured(contact)
        gained = found <= residual or (plain.status in _CLAIMS and residual > _BAR)
        return of_both(plain if gained else best, best, plain), found if gained else residual

    def _refined(
        self, best: InnerSolution, residual: float, contact: FrozenContact
    ) -> tuple[InnerSolution, float]:
        """Solve in units of the forces of the answer before, again while these gain."""
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
        """Return units of the forces of an answer; None where known or tried ones suit them."""
        if best.point is None:
            return None
        forces = part_forces(self._program, best.point)
        # Speeds of pressed soil are local ones, and have units of their own.
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
        """The velocity of one answer with the forces of the other, whichever way leaves less.

        In units as stated velocities are possible and light blocks out of balance; in units of
        their forces these balance, and have velocities that others penetrate.
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
        """With a velocity that is possible, where it is its penetration that is left."""
        tried = self._units is not None or self._refused
        if not tried or best.point is None:
            return best
        if certify(self._program, best.point, contact).penetration < residual:
            return best  # of what else is left no velocity beside it takes much
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
        """Close the solver at work."""
        self._solver.close()
