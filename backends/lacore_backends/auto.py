"""The exact program by whichever solver is faster, and by the other one where that fails.

What proves an answer are its residuals, recomputed. A loop asks hundreds of times: the one that is
asked second has few iterations, and `interior_point` is not asked again where it was in vain.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from lacore.program.kinematic import DissipationGroup, FrozenContact, KinematicProgram
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
# Unknowns from which the first is faster (docs/design-decisions.md).
_LEAST, _COMPILED = 60_000, 5_000
# Of them per point that yields or slips, in quadratic velocities. Where there are more, as in lower
# bounds, less is eliminated, and the first is faster from as many points up.
_PER_POINT = 4 / 3
_MORE = 1.5  # times that: of lower bounds, which have about twice as many
_NOMINAL = 0.01  # of the tolerance: what the other is asked for, which stops at a looser one
_INSTANT = 1e-9  # s: the least time limit there is
_PATIENCE = 30  # iterations of `interior_point` each way, asked second: it solves in 8 to 16
_LEFT = 100.0  # tolerances that recomputed residuals may be: their scales are other ones
_WORDS = (Status.LOCKED, Status.UNSAFE, Status.TIME_LIMIT)


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
    """`interior_point` where it is faster, `clarabel` elsewhere, the other where one fails."""

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
        """Those of both, with their names, alone and one after the other."""
        own, other = (
            {f"{name}: {word}": status for word, status in find_backend(name).statuses.items()}
            for name in (_OWN, _OTHER)
        )
        orders = (own, other), (other, own)
        both = {f"{a}; {b}": s for first, last in orders for a in first for b, s in last.items()}
        return {**own, **other, **both}

    def unavailable(self) -> str:
        """Both come with lacore."""
        return ""

    def version(self) -> str:
        """Those of both."""
        return f"{find_backend(_OWN).version()}, {find_backend(_OTHER).version()}"

    def warm_up(self) -> None:
        """Let both of them compile what they can."""
        for name in (_OWN, _OTHER):
            backend = find_backend(name)
            if isinstance(backend, WarmsUp):
                backend.warm_up()

    def prepare(self, program: KinematicProgram, options: AutoOptions) -> PreparedSolver:
        """The first is made ready where it is faster, the other when it is needed."""
        from lacore_backends._embedding.loops.best import compiles  # not for `capabilities`

        return AutoSolver(program, options, _COMPILED if compiles() else _LEAST)


@dataclass(frozen=True)
class _Attempt:
    """An answer, what it leaves, and whether nobody is asked after it."""

    name: str
    answer: InnerSolution
    left: float
    ends: bool


class AutoSolver:
    """Both solvers at work on one program.

    Args:
        least: unknowns from which `interior_point` is asked first.
    """

    def __init__(self, program: KinematicProgram, options: AutoOptions, least: int) -> None:
        self._program, self._options = program, options
        self._solvers: dict[str, PreparedSolver] = {}
        # Of blocks alone vertices are degenerate, and one in four ends without progress. Of soils
        # that next to nothing but pressure makes strong it loses a twentieth of a lower bound.
        fits = bool(program.groups) and all(_smooth(group) for group in program.groups)
        fits &= not (program.pressure_dependent and _above(program))
        self._quick = _factorises_fast()
        self._leads = _size(program) >= least and fits and self._quick
        self._in_vain = False

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """By the first whose answer is proven; else one that claims one, or that leaves less.

        The words of all that were asked are told, that of the answer last.
        """
        clock, asked = SolveClock(), list[_Attempt]()
        for name in self._order(contact):
            asked.append(self._asked(name, contact, clock.seconds, bool(asked)))
            if asked[-1].ends:
                break
            # It stalls in hundreds of iterations, and a loop asks hundreds of times.
            self._in_vain |= name == _OWN
        if not asked[-1].ends:
            # Of a load of zero nothing is proven: what is left is 0/0.
            asked.sort(key=lambda one: (one.answer.status is Status.SOLVED, -one.left))
        return replace(
            asked[-1].answer,
            native_status="; ".join(f"{one.name}: {one.answer.native_status}" for one in asked),
            iterations=sum(one.answer.iterations for one in asked),
            solve_time=clock.seconds,
        )

    def _order(self, contact: FrozenContact) -> Sequence[str]:
        """Who is asked, one after the other."""
        if self._in_vain or not self._quick:
            return [_OTHER]
        # Slip that is given may be a hundred times that of an elastic start.
        leads = self._leads and not np.any(contact.shift)
        return [_OWN, _OTHER] if leads else [_OTHER, _OWN]

    def _asked(self, name: str, contact: FrozenContact, spent: float, second: bool) -> "_Attempt":
        """What one says in the time that is left, and what its answer leaves."""
        from lacore.solvers.inner.left_over import judged_left
        from lacore_backends._embedding.dilating import as_moved  # not for `capabilities`

        solver = self._made(name, spent, _PATIENCE) if second else self._first(name)
        try:
            answer = checked_answer(self._program, False, solver.solve(contact))
        finally:
            if second:
                solver.close()
        left, allowed = np.inf, _LEFT * self._options.tolerance
        if answer.point is not None:
            left = judged_left(*as_moved(self._program, answer.point), contact, allowed)[1]
        # Where it ended on its way the other one may well be sure.
        good = left <= allowed and (name == _OTHER or answer.status is Status.SOLVED)
        return _Attempt(name, answer, left, ends=good or answer.status in _WORDS)

    def _first(self, name: str) -> PreparedSolver:
        """One that is asked first, kept for the next contact."""
        if name not in self._solvers:
            self._solvers[name] = self._made(name, 0.0, self._options.max_iterations)
        return self._solvers[name]

    def _made(self, name: str, spent: float, most: int) -> PreparedSolver:
        """One with the time that is left; of iterations only our own is given so few."""
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
        """Close those that are at work."""
        for solver in self._solvers.values():
            solver.close()
        self._solvers.clear()


def _factorises_fast() -> bool:
    """Whether a library factorises symmetric matrices faster than SciPy."""
    from lacore.numerics.symmetric import fast_solver  # not for `capabilities`

    return fast_solver() is not None


def _smooth(group: DissipationGroup) -> bool:
    """Whether points have one surface at most: with several steps are twice as many, and dearer."""
    surfaces = group.surfaces
    return surfaces is None or (surfaces.count == 1 and not group.dilates_besides)


def _size(program: KinematicProgram) -> float:
    """Unknowns, or where they are more per point, as many as those points come with elsewhere."""
    return min(_PER_POINT * _points(program), program.n)


def _above(program: KinematicProgram) -> bool:
    """Whether there are more unknowns per point than of velocities: those of lower bounds."""
    return program.n > _MORE * _PER_POINT * _points(program)


def _points(program: KinematicProgram) -> int:
    return program.contact.count + sum(group.weights.size for group in program.groups)
