"""A program in units of its local speeds, so that fast parts are solved as accurately as the load.

Sand has no strength at a free surface, where the mechanism of a footing is hundreds of times as
fast as the footing, and faster on finer meshes. A solver stops when its residuals are small
compared with its largest numbers; but an unbalanced force times such a speed is not a small power.
In

    U = s q,   rows of a point per r,   its strengths times r

s is the speed around each unknown, so all q are of order one, and r is the root of the size of the
weighted rows of a point, so the many residuals of small elements add up to less. The load factor
does not change. The units are found by solving, like those of parts
(`lacore.solvers.inner.rescaling`).
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix, diags_array

from lacore.numerics.arrays import Floats, Sparse
from lacore.program.dissipation import DissipationGroup
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.residuals import dilates_besides
from lacore.program.state import ProgramState
from lacore.solvers.backend import InnerSolution, Prepare, checked_answer
from lacore.solvers.inner.rescaling import largest_residual, of_both

_LEFT = 10.0  # residual, by the required one, at which another solve pays
_ALIKE = 10.0  # ratio of units to those of the last solve below which they are equivalent
_TRIES = 2  # Each solve gains as many digits as the last one had.


@dataclass(frozen=True)
class LocalUnits:
    """Units of a scaled program: value in the program = unit * value in these units.

    Attributes:
        unknowns: units of the unknowns, shape (n,).
        points: inverse units of the strain rates of the points of each group, shape (m,) each.
    """

    unknowns: Floats
    points: tuple[Floats, ...]

    @classmethod
    def of(cls, program: KinematicProgram, velocity: Floats) -> "LocalUnits":
        """Return the units for a velocity close to the solution."""
        unknowns = local_speeds(program, velocity)
        return cls(unknowns, tuple(_sizes(group, unknowns) for group in program.groups))

    def suit(self, other: "LocalUnits") -> bool:
        """Return whether a solver would see similar numbers in other units."""
        ratio = other.unknowns / self.unknowns
        return bool(ratio.max() <= _ALIKE and ratio.min() >= 1 / _ALIKE)

    def program(self, program: KinematicProgram) -> KinematicProgram:
        """Return the program in these units."""
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
        """Return a state in the units of the program."""
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
    """Return the roots of the sizes of the weighted rows of points, 1 without rows, shape (m,)."""
    largest = np.zeros(group.weights.size)
    for rows, dim in ((group.rows, group.dim), (group.volumetric, group.volumes)):
        scaled = _cut(rows, np.ones(rows.shape[0]), unknowns)
        size = np.sqrt(np.asarray(scaled.multiply(scaled).sum(axis=1))).reshape(-1, dim)
        largest = np.maximum(largest, size.max(axis=1, initial=0.0))
    size = group.weights * largest
    return np.asarray(np.sqrt(np.where(size > 0, size, 1.0)))


def local_speeds(program: KinematicProgram, velocity: Floats) -> Floats:
    """Return the speed around each unknown, by that of the load, at least 1, shape (n,).

    The slowest strain point that an unknown moves counts: a footing is slower than the soil at its
    edge.
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
    """Return whether local units apply: for soil, unless it has prescribed rates.

    The power of prescribed rates (T45, T52) is not included in certificates.
    """
    return program.pressure_dependent and not dilates_besides(program)


class LocalSpeedSolver:
    """Prepared solver that solves again in units of local speeds if the residual is large.

    Args:
        program: the program; without pressure, or with prescribed rates, it is solved as it is.
        prepare: prepares a solver for a program.
        good: residual that is sufficient.
    """

    def __init__(self, program: KinematicProgram, prepare: Prepare, good: float) -> None:
        self._program, self._prepare, self._good = program, prepare, good
        self._units: LocalUnits | None = None
        self._solver = prepare(program)

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve with the backend, and again in better units while they gain."""
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
        """Close the solver."""
        self._solver.close()
