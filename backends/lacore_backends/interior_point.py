"""lacore's own interior-point method on the exact program, factorised on velocities alone.

A homogeneous self-dual embedding (`lacore_backends._embedding`): the lengths of strain rates and
all multipliers are eliminated point by point, so that what is factorised is as sparse as the
stiffness of the bodies, positive definite, and of one pattern.
"""

import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, ClassVar

import numpy as np
import scipy

from lacore.numerics.arrays import Floats, Sparse
from lacore.numerics.linear_algebra import SingularError
from lacore.numerics.symmetric import fast_solver, symmetric_solver
from lacore.numerics.threads import one_thread_each
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.state import ProgramState
from lacore.reporting.errors import require_count, require_positive
from lacore.reporting.status import Status
from lacore.solvers.backend import Capabilities, InnerSolution, PreparedSolver
from lacore.solvers.compilation import compiling
from lacore.solvers.inner.left_over import judged_left
from lacore_backends._embedding.arrays import Translation
from lacore_backends._embedding.dilating import as_moved
from lacore_backends._embedding.follow import EmbeddingResult, follow
from lacore_backends._embedding.least import least_program
from lacore_backends._embedding.loops.best import best_loops
from lacore_backends._embedding.loose import loosened
from lacore_backends._embedding.rigid import motions
from lacore_backends._embedding.start import start, unresisted
from lacore_backends._embedding.stiffness import Stiffness
from lacore_backends._embedding.system import System
from lacore_backends._embedding.whole import Whole
from lacore_backends._goal import Goal

_LEFT = 100.0  # tolerances that the recomputed residuals may be: their scales are other ones
_NOWHERE = (Status.ITERATION_LIMIT, Status.STALLED, Status.FAILED)
_SURE = (Status.SOLVED, Status.LOCKED, Status.UNSAFE, Status.TIME_LIMIT)

STATUS_MAP = {
    "solved": Status.SOLVED,
    "solved to round-off": Status.SOLVED,  # ten tolerances are left, and certificates hold
    "nothing to overcome": Status.SOLVED,  # at a load factor of zero
    "in balance": Status.SOLVED,  # a motion that nothing resists, without any stress
    "almost solved": Status.ALMOST_SOLVED,  # by its own residuals, but not by those recomputed
    "locked": Status.LOCKED,
    "unsafe": Status.UNSAFE,
    "iteration limit": Status.ITERATION_LIMIT,
    "time limit": Status.TIME_LIMIT,
    "no progress": Status.STALLED,
    "singular matrix": Status.FAILED,
}

fast_solver()  # loads its library, which is no part of the time of the first solve
best_loops()


@dataclass(frozen=True)
class InteriorPointOptions:
    """Options of the `interior_point` backend.

    Attributes:
        tolerance: on the gap, per power, nodal forces, per load, and velocities, per the fastest.
        max_iterations: factorisations, each way that is tried: of velocities alone, or with more.
        time_limit: s, one inner solve.
    """

    tolerance: float = 1e-8
    max_iterations: int = 100
    time_limit: float = 3600.0

    def __post_init__(self) -> None:
        require_positive("interior_point.tolerance", self.tolerance)
        require_count("interior_point.max_iterations", self.max_iterations)
        require_positive("interior_point.time_limit", self.time_limit)


class InteriorPoint:
    """The exact program by a method that knows what it solves."""

    name: ClassVar[str] = "interior_point"
    title: ClassVar[str] = "Interior-point method, exact program, factorised on velocities"
    source: ClassVar[str] = "Andersen, Roos & Terlaky, Math. Program. 95, 2003"
    capabilities: ClassVar[Capabilities] = Capabilities(
        regularised=False,
        hardening=True,
        surfaces=True,
        paths=True,
        on_demand=True,
        packages=("scipy",),
    )
    statuses: ClassVar[Mapping[Any, Status]] = STATUS_MAP
    Options: ClassVar[type] = InteriorPointOptions

    def unavailable(self) -> str:
        """Always there: scipy is a dependency."""
        return ""

    def version(self) -> str:
        """The solver and its version."""
        return f"{symmetric_solver().name}, {best_loops().name}, SciPy {scipy.__version__}"

    def warm_up(self) -> None:
        """Compile all loops, which is no part of the time of a solve."""
        _compiled()

    def prepare(self, program: KinematicProgram, options: InteriorPointOptions) -> PreparedSolver:
        """What the pattern of the matrix depends on is kept between solves."""
        _compiled()
        return InteriorPointSolver(program, options)


@cache
def _compiled() -> None:
    """All loops compiled, which is no part of the time of a solve."""
    with compiling():
        program, contact = least_program()
        solver = InteriorPointSolver(program, InteriorPointOptions())
        solver.solve(contact)
        solver.close()
        loops, points = best_loops(), np.array([[2.0], [1.0]])
        scaling = loops.scaled(points, points)
        loops.banded(scaling, points, points, 1.0, (0.1, 10.0))  # which it may do without
        values, vectors = loops.frames(scaling, np.ones(0), np.ones((1, 1, 1)), 1)
        loops.framed(values, vectors, points)


_Way = tuple[str, int, ProgramState]  # native status, iterations, and where it ended


class InteriorPointSolver:
    """The method at work on one program."""

    def __init__(self, program: KinematicProgram, options: InteriorPointOptions) -> None:
        self._given, self._options = program, options
        self._solver = symmetric_solver(refined=False)
        self._indefinite = symmetric_solver(refined=False, definite=False)
        self._loops = best_loops()
        # Of bodies that move as they are contact would be lost beside their stiffness.
        self._motions = motions(program, self._solver)
        self._program = program if self._motions is None else self._motions.stated(program)
        self._known: tuple[Translation, Stiffness] | None = None

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve from a cold start; the pattern is that of the last where rows are the same.

        Where forces are lost to round-off it goes on with more unknowns factorised (`Whole`), and
        what ends without an answer begins anew with them.
        """
        begin, options = time.perf_counter(), self._options
        goal = Goal(options.tolerance, options.max_iterations, begin + options.time_limit)
        own = Translation(self._program, contact, self._loops)
        if self._known is None or not self._known[0].alike(contact):
            self._known = own, Stiffness(own.conic.kinds, self._loops)
        # Vectors and small blocks: more BLAS threads only wait for each other.
        with one_thread_each(), np.errstate(all="ignore"):  # a step that overflows is refused
            answer = self._solved(contact, own, self._known[1], goal)
        return replace(answer, solve_time=time.perf_counter() - begin)

    def _solved(
        self, contact: FrozenContact, own: Translation, stiffness: Stiffness, goal: Goal
    ) -> InnerSolution:
        """By the first way that is sure of its answer, or else by the last that ends anywhere."""
        iterations, answer = 0, InnerSolution(Status.FAILED, "singular matrix", 0, 0.0, None)
        with suppress(SingularError):  # where a way begins
            for native, count, point in self._ways(own, stiffness, goal):
                iterations += count
                found = self._answer(native, point, contact)
                if answer.status is Status.FAILED or found.status not in _NOWHERE:
                    answer = found
                if found.status in _SURE:
                    break
        return replace(answer, iterations=iterations)

    def _ways(self, own: Translation, stiffness: Stiffness, goal: Goal) -> Iterator[_Way]:
        """What comes of one way after the other.

        Of velocities alone; without what nothing resists, unstressed where the loads are in balance
        then; with more unknowns. The first two go on with more from where forces are lost.
        """
        conic, basis = own.conic, None
        # No velocity has a power of it: of what is held all over there is none.
        if not conic.load.any():
            yield "locked", 0, self._unstressed(np.zeros(conic.load.size), 0.0)
            return

        def whole() -> Whole:
            return Whole(conic, stiffness, self._solver, self._indefinite)

        system = System(conic, stiffness, self._solver)
        begin = start(conic, system)
        free = unresisted(begin[0])
        if not free:
            yield self._followed(own, basis, follow(system, goal, *begin, whole))
        loose = loosened(conic, self._solver)  # what no load drives round-off may
        if loose is not None:
            if loose.driven:
                yield "in balance", 0, self._unstressed(*loose.alone())
            conic, basis = loose.conic, loose.basis
            stiffness = Stiffness(conic.kinds, self._loops)
            system = System(conic, stiffness, self._solver)
            begin = start(conic, system)
        if free or loose is not None:
            yield self._followed(own, basis, follow(system, goal, *begin, whole))
        yield self._followed(own, basis, follow(whole(), goal, *begin))

    def _followed(self, own: Translation, basis: Sparse | None, found: EmbeddingResult) -> _Way:
        """In the unknowns of the program."""
        velocity = found.velocity if basis is None else np.asarray(basis @ found.velocity)
        point = self._moved(own.state(velocity, found.multipliers))
        return found.native, found.iterations, point

    def _answer(self, native: str, point: ProgramState, contact: FrozenContact) -> InnerSolution:
        """What was found, and what it is worth."""
        status = STATUS_MAP[native]
        answer = InnerSolution(
            status=status,
            native_status=native,
            iterations=0,
            solve_time=0.0,
            point=point if status.has_point else None,
        )
        if status is not Status.SOLVED:
            return answer
        allowed = _LEFT * self._options.tolerance
        name, left = judged_left(*as_moved(self._given, point), contact, allowed)
        if left <= allowed:
            return answer
        return replace(
            answer,
            status=Status.ALMOST_SOLVED,
            native_status="almost solved",
            message=f"the residual {name!r}, recomputed, is {left:.1e}",
        )

    def _unstressed(self, velocity: Floats, load_factor: float) -> ProgramState:
        """A velocity without any stress."""
        return self._moved(ProgramState.unstressed(self._program, velocity, load_factor))

    def _moved(self, state: ProgramState) -> ProgramState:
        """In the unknowns of the program."""
        if self._motions is None:
            return state
        return replace(state, velocity=np.asarray(self._motions.basis @ state.velocity))

    def close(self) -> None:
        """Give the factors back."""
        self._solver.close()
        self._indefinite.close()
