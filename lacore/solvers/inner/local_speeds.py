"""A program in units of its local speeds, so that what outruns the load is solved as well as it.

Sand carries nothing at a free surface, and there the mechanism of a footing runs hundreds of times
as fast as the footing, the faster the finer the mesh. A solver ends when what it leaves is small
beside its largest numbers; but a force out of balance, times such a speed, is no small power. In

    U = s q,   rows of a point per r,   its strengths times r

with s the speed of what moves around each unknown, all q are of order one; and with r the root of
the size of its weighted rows, what is left of points adds up to less, as those of small elements
are many. The load factor stays. The units are found by solving, as those of parts are
(`lacore.solvers.inner.rescaling`).
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix, diags_array

from lacore.numerics.arrays import Floats, Sparse
from lacore.program.dissipation import DissipationGroup
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.state import ProgramState
from lacore.solvers.backend import InnerSolution, Prepare, checked_answer
from lacore.solvers.inner.left_over import dilates_besides
from lacore.solvers.inner.rescaling import largest_residual, of_both

_LEFT = 10.0  # times what is good enough: what is worth another solve
_ALIKE = 10.0  # ratio of units to those of the solve before that are as good
_TRIES = 2  # each gains the digits that the one before has


@dataclass(frozen=True)
class LocalUnits:
    """Units in which a program is written anew: value in the program = unit * value in these.

    Attributes:
        unknowns: of each unknown, shape (n,).
        points: inverse to strain rates of the points of each group, shape (m,) each.
    """

    unknowns: Floats
    points: tuple[Floats, ...]

    @classmethod
    def of(cls, program: KinematicProgram, velocity: Floats) -> "LocalUnits":
        """Those of a velocity, almost the one that is sought."""
        unknowns = local_speeds(program, velocity)
        return cls(unknowns, tuple(_sizes(group, unknowns) for group in program.groups))

    def suit(self, other: "LocalUnits") -> bool:
        """Whether a solver would see much the same numbers in other units."""
        ratio = other.unknowns / self.unknowns
        return bool(ratio.max() <= _ALIKE and ratio.min() >= 1 / _ALIKE)

    def program(self, program: KinematicProgram) -> KinematicProgram:
        """The program in these units."""
        columns = diags_array(self.unknowns)

        def group(own: DissipationGroup, units: Floats) -> DissipationGroup:
            return replace(
                own,
                rows=_cut(own.rows, np.repeat(units, own.dim), self.unknowns),
                volumetric=_cut(own.volumetric, np.repeat(units, own.volumes), self.unknowns),
                bound=own.bound * units,
                surfaces=None if own.surfaces is None else own.surfaces.times(units, 1 / units),
                modulus=None if own.modulus is None else own.modulus * units**2,
            )

        rows = program.contact
        return replace(
            program,
            groups=tuple(group(g, u) for g, u in zip(program.groups, self.points, strict=True)),
            contact=replace(
                rows,
                normal=csr_matrix(rows.normal @ columns),
                tangential=csr_matrix(rows.tangential @ columns),
            ),
            reference_load=program.reference_load * self.unknowns,
            dead_load=program.dead_load * self.unknowns,
        )

    def back(self, point: ProgramState) -> ProgramState:
        """A state in the units of the program."""
        return replace(
            point,
            velocity=point.velocity * self.unknowns,
            stress=tuple(s / u[:, None] for s, u in zip(point.stress, self.points, strict=True)),
            mean_stress=tuple(
                p / np.repeat(u, p.size // max(u.size, 1))
                for p, u in zip(point.mean_stress, self.points, strict=True)
            ),
        )


def _cut(rows: Sparse, units: Floats, unknowns: Floats) -> Sparse:
    return csr_matrix(diags_array(1 / units) @ rows @ diags_array(unknowns))


def _sizes(group: DissipationGroup, unknowns: Floats) -> Floats:
    """Roots of the sizes of the weighted rows of points, 1 without rows, shape (m,)."""
    largest = np.zeros(group.weights.size)
    for rows, dim in ((group.rows, group.dim), (group.volumetric, group.volumes)):
        scaled = _cut(rows, np.ones(rows.shape[0]), unknowns)
        size = np.sqrt(np.asarray(scaled.multiply(scaled).sum(axis=1))).reshape(-1, dim)
        largest = np.maximum(largest, size.max(axis=1, initial=0.0))
    size = group.weights * largest
    return np.asarray(np.sqrt(np.where(size > 0, size, 1.0)))


def local_speeds(program: KinematicProgram, velocity: Floats) -> Floats:
    """Speed of what moves around each unknown, per that of the load, and at least 1, shape (n,).

    Of the strain points that an unknown moves the slowest counts: a footing is not as fast as the
    soil at its edge.
    """
    load = 1 / float(np.abs(program.reference_load).sum())
    least = np.full(program.n, np.inf)
    for group in program.groups:
        for rows in (group.rows, group.volumetric):
            entries = rows.tocoo()
            fastest = np.zeros(rows.shape[0])
            np.maximum.at(fastest, entries.row, np.abs(velocity[entries.col]))
            np.minimum.at(least, entries.col, fastest[entries.row])
    return np.asarray(np.maximum(np.where(np.isfinite(least), least, 0.0) / load, 1.0))


def _told(program: KinematicProgram) -> bool:
    """Whether soil presses, and residuals know its flow: not where it is frozen (T52), or inside.

    Rates that flow has besides (T45) turn over a power that certificates do not count.
    """
    return program.pressure_dependent and not dilates_besides(program)


class LocalSpeedSolver:
    """A prepared solver that is asked again in units of local speeds, if what it leaves is much.

    Args:
        program: as stated; without pressure, or with rates besides, it is asked as it is.
        prepare: sets a solver to work on one.
        good: residual that is good enough.
    """

    def __init__(self, program: KinematicProgram, prepare: Prepare, good: float) -> None:
        self._program, self._prepare, self._good = program, prepare, good
        self._units: LocalUnits | None = None
        self._solver = prepare(program)

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """As the backend does; again in better units while they gain."""
        best = self._asked(contact)
        if not _told(self._program):
            return best
        left = largest_residual(self._program, best, contact)
        for _ in range(_TRIES):
            if best.point is None or left <= _LEFT * self._good:
                break
            units = LocalUnits.of(self._program, best.point.velocity)
            if self._units is not None and self._units.suit(units):
                break
            self._renew(units)
            answer = self._asked(contact)
            found = largest_residual(self._program, answer, contact)
            best = of_both(answer if found < left else best, best, answer)
            if not found < left:
                break
            left = found
        return best

    def _renew(self, units: LocalUnits) -> None:
        self._solver.close()
        self._units = units
        self._solver = self._prepare(units.program(self._program))

    def _asked(self, contact: FrozenContact) -> InnerSolution:
        answer = checked_answer(self._program, False, self._solver.solve(contact))
        if self._units is None or answer.point is None:
            return answer
        return replace(answer, point=self._units.back(answer.point))

    def close(self) -> None:
        """Close the solver at work."""
        self._solver.close()
