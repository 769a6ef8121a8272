"""Loads of several components: named, combined, and checked."""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.sparse import csr_matrix, vstack
from scipy.sparse.linalg import lsqr

from lacore.analyses.parameters import size_of, times
from lacore.analyses.yield_surface.mirrors import senses
from lacore.assembly.discretisation import Discretisation
from lacore.assembly.discretise import discretise
from lacore.model.conditions.footings import footings
from lacore.model.conditions.loads import Load
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.program.kinematic import KinematicProgram
from lacore.reporting import terms
from lacore.reporting.errors import InputError
from lacore.reporting.text import text

_FEWEST, _MOST = 2, 3
_DEPENDENT = 1e-9  # by the largest singular value of all, each of length 1
_NOTHING = 1e-9  # share of a load without power
_FAINTEST = 1e-12  # by the largest component: a smaller one is left out


class Components:
    """Loads by the name of their component.

    Attributes:
        names: names of the components.
        loads: loads of each component.
        associated: whether all flow and friction is associated, so that the set of carried loads is
            convex.
        senses: signs of components that do not change whether loads are carried, (s, k), the first
            all 1: all opposite, if opposite loads have opposite mechanisms, because nothing opens,
            no strength depends on pressure and there is no dead load; and those of mirrors, see
            `lacore.analyses.yield_surface.mirrors.senses`.

    Raises:
        InputError: not two or three; invalid loads, or loads without a single size; components
            without power in any motion, or combinations of each other.
    """

    def __init__(self, problem: Problem, loads: Mapping[str, Sequence[Load]]) -> None:
        if not isinstance(loads, Mapping) or not _FEWEST <= len(loads) <= _MOST:
            raise InputError(
                "loads",
                loads,
                "not two or three components",
                "give loads by name, {'V': [lacore.PointForce(...)], 'H': [...]}",
            )
        self.names = tuple(map(str, loads))
        self.loads = tuple(tuple(own) for own in loads.values())
        for name, own in zip(self.names, self.loads, strict=True):
            _check(name, own)
        # Add nodes at all forces on frames, so that all problems have the same unknowns.
        every = [load for own in self.loads for load in own]
        self.problem = problem.with_loads(every, problem.dead_loads)
        self.associated, even = True, True
        stated = [self._stated(number) for number in range(len(self.names))]
        for one in stated:
            program = one.program
            opens = program.contact.count > 0 or program.pressure_dependent
            even = even and not (opens or bool(np.any(program.dead_load)))
            coulomb = bool(program.contact.coulomb.any())
            self.associated = self.associated and not (coulomb or program.frictional)
        columns = [self._vector(*pair) for pair in zip(self.names, stated, strict=True)]
        sizes = np.linalg.svd(np.stack(columns, axis=1), compute_uv=False)
        if sizes[-1] <= _DEPENDENT * sizes[0]:
            raise InputError(
                "loads",
                list(self.names),
                "do the same work in all motions, up to factors: one is a combination of the"
                " others, and there is no surface between them",
                "give forces in different directions, or at different places",
            )
        self.senses = senses(even, stated)

    def problem_at(self, centre: Floats, direction: Floats) -> Problem:
        """Return the problem along a direction, (k,), from a centre, (k,), of dead loads."""
        return self.problem.with_loads(
            reference_loads=self._combined(direction),
            dead_loads=[*self.problem.dead_loads, *self._combined(centre)],
        )

    def powers(self, stated: Problem, velocity: Floats) -> Floats:
        """Return the power of each component on a velocity of a problem, W/m, (k,)."""
        forces = [
            discretise(stated.with_loads(own, self.problem.dead_loads)).full.reference_load
            for own in self.loads
        ]
        return np.array([float(force @ velocity) for force in forces])

    def _combined(self, factors: Floats) -> list[Load]:
        largest = float(np.abs(factors).max())
        return [
            times(load, float(factor))
            for factor, own in zip(factors, self.loads, strict=True)
            for load in own
            if abs(factor) > _FAINTEST * largest
        ]

    def _stated(self, number: int) -> Discretisation:
        """Return the problem with a component alone."""
        try:
            return discretise(self.problem.with_loads(self.loads[number]))
        except InputError as wrong:
            field = f"loads[{self.names[number]!r}]: {wrong.field.removeprefix('Problem.')}"
            raise InputError(field, wrong.value, wrong.reason, wrong.fix) from None

    @staticmethod
    def _vector(name: str, stated: Discretisation) -> Floats:
        """Return the forces of a component on free unknowns, with length 1."""
        force = stated.program.reference_load
        if not _left(stated.program, force) > _NOTHING:
            raise InputError(
                f"loads[{name!r}]",
                None,
                "does no power in any motion that keeps volumes: pressure of the body takes it all",
                "load a part of its boundary, or leave the component out",
            )
        return np.asarray(force / np.linalg.norm(force))


def _left(program: KinematicProgram, force: Floats) -> float:
    """Return the share of a load that no mean stress of incompressible bodies balances."""
    rows = [group.volumetric for group in program.groups if group.surfaces is None]
    rows = [own for own in rows if own.nnz]
    if not rows:
        return 1.0
    held = csr_matrix(vstack(rows)).T
    rest = lsqr(held, force, atol=1e-13, btol=1e-13)[3]
    return float(rest / np.linalg.norm(force))


def _check(name: str, loads: Sequence[Load]) -> None:
    field = f"loads[{name!r}]"
    if not loads:
        raise InputError(field, None, "there is none", "give at least one load")
    for index, load in enumerate(loads):
        if not isinstance(load, Load):
            raise InputError(f"{field}[{index}]", load, "not a load", "give lacore.PointForce, ...")
        if footings([load]):
            raise InputError(
                f"{field}[{index}]",
                load.told,
                "moves along one line, and neither turns nor gives way to another load",
                text(
                    "make the footing a {} that is bonded to the body ({}), with forces on it",
                    terms.RIGID_BLOCK,
                    terms.BOND,
                ),
            )
        if size_of(load) is None:
            raise InputError(
                f"{field}[{index}]",
                load.told,
                "has no one size that could be multiplied",
                "leave water among the dead loads",
            )
