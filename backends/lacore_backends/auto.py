"""Solve the exact program with the faster of two solvers, and with the other one if that fails.

An answer is accepted by its recomputed residuals. A loop solves hundreds of programs, so the second
solver is given few iterations, and `interior_point` is not tried again after a failure.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from lacore.program import DissipationGroup, FrozenContact, KinematicProgram
from lacore.reporting.errors import require_count, require_positive
from lacore.reporting.status import Status
from lacore.solvers.backend import (
    Capabilities,
    InnerSolution,
    PreparedSolver,
    WarmsUp,
    checked_answer,
    find_backend,
)
from lacore.solvers.compilation import SolveClock

_OWN, _OTHER = "interior_point", "clarabel"
# From this number of unknowns `interior_point` is faster (docs/design-decisions.md).
_LEAST, _COMPILED = 60_000, 5_000
# Unknowns per point that yields or slips, with quadratic velocities. Programs with more unknowns
# per point, such as lower bounds, eliminate less, so `interior_point` is faster from the same
# number of points on.
_PER_POINT = 4 / 3
_MORE = 1.5  # Lower bounds have about twice as many unknowns per point.
_NOMINAL = 0.01  # `clarabel` stops at a looser tolerance than the given one.
_INSTANT = 1e-9  # s, the smallest time limit
_PATIENCE = 30  # iterations of `interior_point` per way as second solver: it needs 8 to 16
_LEFT = 100.0  # allowed recomputed residuals, in tolerances: their scales differ
_WORDS = (Status.LOCKED, Status.UNSAFE, Status.TIME_LIMIT)


@dataclass(frozen=True)
class AutoOptions:
    """Options of the `auto` backend.

    Attributes:
        tolerance: tolerance of `interior_point`; `clarabel` is given a hundredth of it.
        max_iterations: limit for each of the two solvers.
        time_limit: s, limit for one inner solve by both solvers together.
    """

    tolerance: float = 1e-8
    max_iterations: int = 200
    time_limit: float = 3600.0

    def __post_init__(self) -> None:
        require_positive("auto.tolerance", self.tolerance)
        require_count("auto.max_iterations", self.max_iterations)
        require_positive("auto.time_limit", self.time_limit)


class Auto:
    """Backend that uses `interior_point` where it is faster and `clarabel` elsewhere.

    If one of them fails, the other one is tried.
    """

    name: ClassVar[str] = "auto"
    title: ClassVar[str] = "interior_point or clarabel, whichever is expected to be faster"
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
        """Native statuses of both solvers, of one alone and of one after the other."""
        own, other = (
            {f"{name}: {word}": status for word, status in find_backend(name).statuses.items()}
            for name in (_OWN, _OTHER)
        )
        orders = (own, other), (other, own)
        both = {f"{a}; {b}": s for first, last in orders for a in first for b, s in last.items()}
        return {**own, **other, **both}

    def unavailable(self) -> str:
        """Return an empty reason: both solvers come with lacore."""
        return ""

    def version(self) -> str:
        """Return the versions of both solvers."""
        return f"{find_backend(_OWN).version()}, {find_backend(_OTHER).version()}"

    def warm_up(self) -> None:
        """Compile the loops of both solvers."""
        for name in (_OWN, _OTHER):
            backend = find_backend(name)
            if isinstance(backend, WarmsUp):
                backend.warm_up()

    def prepare(self, program: KinematicProgram, options: AutoOptions) -> PreparedSolver:
        """Return a prepared solver; `clarabel` is prepared only when it is needed."""
        # imported here so that `capabilities` does not load it
        from lacore_backends._embedding.loops.best import compiles

        return AutoSolver(program, options, _COMPILED if compiles() else _LEAST)


@dataclass(frozen=True)
class _Attempt:
    """Answer of one solver, its residual, and whether no other solver is tried after it."""

    name: str
    answer: InnerSolution
    left: float
    ends: bool


class AutoSolver:
    """Two prepared solvers for one program.

    Args:
        least: number of unknowns from which `interior_point` is tried first.
    """

    def __init__(self, program: KinematicProgram, options: AutoOptions, least: int) -> None:
        self._program, self._options = program, options
        self._solvers: dict[str, PreparedSolver] = {}
        # In programs of blocks alone vertices are degenerate, and one solve in four stalls. In
        # soils whose strength comes almost entirely from pressure, 5 % of a lower bound would be
        # lost.
        fits = bool(program.groups) and all(_smooth(group) for group in program.groups)
        fits &= not (program.pressure_dependent and _above(program))
        self._quick = _factorises_fast()
        self._leads = _size(program) >= least and fits and self._quick
        self._in_vain = False

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Return the first proven answer, or else the best of both.

        An answer that claims to be solved is preferred, then the one with the smaller residual. The
        native status lists those of all solvers that were tried, the one of the answer last.
        """
        clock, asked = SolveClock(), list[_Attempt]()
        for name in self._order(contact):
            asked.append(self._asked(name, contact, clock if asked else None))
            if asked[-1].ends:
                break
            # It stalls for hundreds of iterations, and a loop solves hundreds of programs.
            self._in_vain |= name == _OWN
        if not asked[-1].ends:
            # Without a load nothing can be proven, because the relative residual is 0/0.
            asked.sort(key=lambda one: (one.answer.status is Status.SOLVED, -one.left))
        return replace(
            asked[-1].answer,
            native_status="; ".join(f"{one.name}: {one.answer.native_status}" for one in asked),
            iterations=sum(one.answer.iterations for one in asked),
            solve_time=clock.seconds,
        )

    def _order(self, contact: FrozenContact) -> Sequence[str]:
        """Return the names of the solvers in the order in which they are tried."""
        if self._in_vain or not self._quick:
            return [_OTHER]
        # Prescribed slip may be a hundred times that of an elastic start.
        leads = self._leads and not np.any(contact.shift)
        return [_OWN, _OTHER] if leads else [_OTHER, _OWN]

    def _asked(self, name: str, contact: FrozenContact, clock: SolveClock | None) -> "_Attempt":
        """Return the answer of one solver within the remaining time, with its residual.

        Args:
            name: Of the solver.
            contact: To solve for.
            clock: Of a second attempt, whose solver is used once; None for the first attempt.
        """
        from lacore.program.residuals import solve_residual

        # imported here so that `capabilities` does not load it
        from lacore_backends._embedding.dilating import as_moved

        solver = self._made(name, clock.seconds, _PATIENCE) if clock else self._first(name)
        try:
            answer = checked_answer(self._program, False, solver.solve(contact))
        finally:
            if clock:
                solver.close()
        left, allowed = np.inf, _LEFT * self._options.tolerance
        if answer.point is not None:
            left = solve_residual(*as_moved(self._program, answer.point), contact, allowed)[1]
        # If `interior_point` ended early, `clarabel` may still prove its answer.
        good = left <= allowed and (name == _OTHER or answer.status is Status.SOLVED)
        return _Attempt(name, answer, left, ends=good or answer.status in _WORDS)

    def _first(self, name: str) -> PreparedSolver:
        """Return the solver that is tried first; it is kept for the next contact."""
        if name not in self._solvers:
            self._solvers[name] = self._made(name, 0.0, self._options.max_iterations)
        return self._solvers[name]

    def _made(self, name: str, spent: float, most: int) -> PreparedSolver:
        """Prepare a solver with the remaining time; only `interior_point` gets fewer iterations."""
        backend, options, own = find_backend(name), self._options, name == _OWN
        return backend.prepare(
            self._program,
            backend.Options(
                tolerance=options.tolerance * (1.0 if own else _NOMINAL),
                max_iterations=min(options.max_iterations, most) if own else options.max_iterations,
                time_limit=max(options.time_limit - spent, _INSTANT),
            ),
        )

    def close(self) -> None:
        """Close both solvers."""
        for solver in self._solvers.values():
            solver.close()
        self._solvers.clear()


def _factorises_fast() -> bool:
    """Return whether a library faster than SciPy factorises symmetric matrices."""
    # imported here so that `capabilities` does not load it
    from lacore.numerics.symmetric import fast_solver

    return fast_solver() is not None


def _smooth(group: DissipationGroup) -> bool:
    """Return whether each point has at most one surface.

    Points with several surfaces need twice as many steps, which cost more.
    """
    surfaces = group.surfaces
    return surfaces is None or (surfaces.count == 1 and not group.dilates_besides)


def _size(program: KinematicProgram) -> float:
    """Return the number of unknowns, limited to the usual number for as many points."""
    return min(_PER_POINT * _points(program), program.n)


def _above(program: KinematicProgram) -> bool:
    """Return whether there are more unknowns per point than velocities need, as in lower bounds."""
    return program.n > _MORE * _PER_POINT * _points(program)


def _points(program: KinematicProgram) -> int:
    return program.contact.count + sum(group.weights.size for group in program.groups)
