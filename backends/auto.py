"""The exact program by whichever solver is faster, and by the other one where that fails."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from backends._embedding.loops.best import compiles
from lacore.backend import (
    Capabilities,
    InnerSolution,
    PreparedSolver,
    checked_answer,
    find_backend,
)
from lacore.errors import require_count, require_positive
from lacore.numerics.symmetric import fast_solver
from lacore.program import DissipationGroup, FrozenContact, KinematicProgram
from lacore.status import Status

_FIRST, _OTHER = "interior_point", "clarabel"
_LEAST, _COMPILED = 60_000, 8_000  # unknowns from which the first is faster: docs/measured.md
# Of them per point that yields or slips, in quadratic velocities. Where there are more, as in lower
# bounds, less is eliminated, and the first is faster from more unknowns up.
_PER_POINT = 4 / 3
_MORE = 1.5  # times that: of lower bounds, which have about twice as many
_NOMINAL = 0.01  # of the tolerance: what the other is asked for, which stops at a looser one
_INSTANT = 1e-9  # s: the least time limit there is
_SURE = (Status.SOLVED, Status.LOCKED, Status.UNSAFE, Status.TIME_LIMIT)


@dataclass(frozen=True)
class AutoOptions:
    """Options of the `auto` backend.

    Attributes:
        tolerance: of `interior_point`; `clarabel` is asked for a hundredth of it.
        max_iterations: of each of them.
        time_limit: s, one inner solve, both of them together.
    """

    tolerance: float = 1e-8
    max_iterations: int = 200
    time_limit: float = 3600.0

    def __post_init__(self) -> None:
        require_positive("auto.tolerance", self.tolerance)
        require_count("auto.max_iterations", self.max_iterations)
        require_positive("auto.time_limit", self.time_limit)


class Auto:
    """`interior_point` where it is faster, `clarabel` elsewhere and where the first fails."""

    name: ClassVar[str] = "auto"
    title: ClassVar[str] = "interior_point where it is faster, else clarabel"
    source: ClassVar[str] = "those of interior_point and clarabel"
    capabilities: ClassVar[Capabilities] = Capabilities(
        regularised=False,
        hardening=True,
        surfaces=True,
        true_gap=True,
        paths=True,
        on_demand=True,
        packages=("clarabel", "scipy"),
    )
    Options: ClassVar[type] = AutoOptions

    @property
    def statuses(self) -> Mapping[Any, Status]:
        """Those of both, with their names, alone and one after the other."""
        first, other = find_backend(_FIRST).statuses, find_backend(_OTHER).statuses
        alone = {f"{_FIRST}: {word}": status for word, status in first.items()}
        then = {f"{_OTHER}: {word}": status for word, status in other.items()}
        both = {f"{one}; {two}": status for one in alone for two, status in then.items()}
        return {**alone, **then, **both}

    def unavailable(self) -> str:
        """Both come with lacore."""
        return ""

    def version(self) -> str:
        """Those of both."""
        return f"{find_backend(_FIRST).version()}, {find_backend(_OTHER).version()}"

    def prepare(self, program: KinematicProgram, options: AutoOptions) -> PreparedSolver:
        """The first is made ready where it is faster, the other when it is needed."""
        return AutoSolver(program, options, _COMPILED if compiles() else _LEAST)


class AutoSolver:
    """Both solvers at work on one program.

    Args:
        least: unknowns from which `interior_point` is asked first.
    """

    def __init__(self, program: KinematicProgram, options: AutoOptions, least: int) -> None:
        self._program, self._options = program, options
        self._solvers: dict[str, PreparedSolver] = {}
        self._names = [_OTHER]
        # Of blocks alone vertices are degenerate, and one in four ends without progress. Of soils
        # that next to nothing but pressure makes strong it loses a twentieth of a lower bound.
        fits = bool(program.groups) and all(_smooth(group) for group in program.groups)
        fits &= not (program.presses and _above(program))
        if _size(program) >= least and fits and fast_solver() is not None:
            self._names = [_FIRST, _OTHER]

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """By the first that is sure of its answer; the words of all that were asked are told."""
        begin, said, iterations = time.perf_counter(), [], 0
        # Slip that is given may be a hundred times that of an elastic start.
        names = [_OTHER] if np.any(contact.shift) else self._names
        for name in names:
            first, spent = name == names[0], time.perf_counter() - begin
            solver = self._first(name) if first else self._made(name, spent)
            try:
                answer = checked_answer(self._program, False, solver.solve(contact))
            finally:
                if not first:
                    solver.close()
            said.append(f"{name}: {answer.native_status}")
            iterations += answer.iterations
            if answer.status in _SURE:
                break
        return replace(
            answer,
            native_status="; ".join(said),
            iterations=iterations,
            solve_time=time.perf_counter() - begin,
        )

    def _first(self, name: str) -> PreparedSolver:
        """One that is asked first, kept for the next contact."""
        if name not in self._solvers:
            self._solvers[name] = self._made(name, 0.0)
        return self._solvers[name]

    def _made(self, name: str, spent: float) -> PreparedSolver:
        """One with the time that is left."""
        backend, options = find_backend(name), self._options
        return backend.prepare(
            self._program,
            backend.Options(
                tolerance=options.tolerance * (1.0 if name == _FIRST else _NOMINAL),
                max_iterations=options.max_iterations,
                time_limit=max(options.time_limit - spent, _INSTANT),
            ),
        )

    def close(self) -> None:
        """Close those that are at work."""
        for solver in self._solvers.values():
            solver.close()
        self._solvers.clear()


def _smooth(group: DissipationGroup) -> bool:
    """Whether points have one surface at most: with several steps are twice as many, and dearer."""
    surfaces = group.surfaces
    return surfaces is None or (surfaces.count == 1 and surfaces.dilation is None)


def _size(program: KinematicProgram) -> float:
    """Unknowns, or where they are more per point, a mean of them and of those points."""
    return float(np.sqrt(program.n * min(_PER_POINT * _points(program), program.n)))


def _above(program: KinematicProgram) -> bool:
    """Whether there are more unknowns per point than of velocities: those of lower bounds."""
    return program.n > _MORE * _PER_POINT * _points(program)


def _points(program: KinematicProgram) -> int:
    return program.contact.count + sum(group.weights.size for group in program.groups)
