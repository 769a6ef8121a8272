"""Interior-point method of lacore for the exact program, factorised on velocities alone.

It is a homogeneous self-dual embedding (`lacore_backends._embedding`). The lengths of strain rates
and all multipliers are eliminated point by point. The factorised matrix is then as sparse as the
stiffness of the bodies, positive definite, and always has the same pattern.
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
from lacore.program import FrozenContact, KinematicProgram
from lacore.program.residuals import solve_residual
from lacore.program.state import ProgramState
from lacore.reporting.errors import require_count, require_positive
from lacore.reporting.status import Status
from lacore.solvers.backend import Capabilities, InnerSolution, PreparedSolver
from lacore.solvers.compilation import compiling
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

_LEFT = 100.0  # allowed recomputed residuals, in tolerances: their scales differ
_NOWHERE = (Status.ITERATION_LIMIT, Status.STALLED, Status.FAILED)
_SURE = (Status.SOLVED, Status.LOCKED, Status.UNSAFE, Status.TIME_LIMIT)

STATUS_MAP = {
    "solved": Status.SOLVED,
    # The residuals are within ten tolerances, and certificates hold.
    "solved to round-off": Status.SOLVED,
    "nothing to overcome": Status.SOLVED,  # The load factor is zero.
    "in balance": Status.SOLVED,  # The mechanism moves without resistance and without stress.
    # The residuals of the solver meet the tolerance, the recomputed ones do not.
    "almost solved": Status.ALMOST_SOLVED,
    "locked": Status.LOCKED,
    "unsafe": Status.UNSAFE,
    "iteration limit": Status.ITERATION_LIMIT,
    "time limit": Status.TIME_LIMIT,
    "no progress": Status.STALLED,
    "singular matrix": Status.FAILED,
}

fast_solver()  # Loading the library does not count to the time of the first solve.
best_loops()


@dataclass(frozen=True)
class InteriorPointOptions:
    """Options of the `interior_point` backend.

    Attributes:
        tolerance: relative tolerance of the gap (by the power), of the nodal forces (by the load)
            and of the velocities (by the largest).
        max_iterations: limit of factorisations for each formulation: velocities alone, or with more
            unknowns.
        time_limit: s, limit for one inner solve.
    """

    tolerance: float = 1e-8
    max_iterations: int = 100
    time_limit: float = 3600.0

    def __post_init__(self) -> None:
        require_positive("interior_point.tolerance", self.tolerance)
        require_count("interior_point.max_iterations", self.max_iterations)
        require_positive("interior_point.time_limit", self.time_limit)


class InteriorPoint:
    """Backend for the exact program by an interior-point method for this structure."""

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
        """Return an empty reason: SciPy is a dependency of lacore."""
        return ""

    def version(self) -> str:
        """Return the name and version of the linear solver."""
        return f"{symmetric_solver().name}, {best_loops().name}, SciPy {scipy.__version__}"

    def warm_up(self) -> None:
        """Compile all loops, which is no part of the time of a solve."""
        _compiled()

    def prepare(self, program: KinematicProgram, options: InteriorPointOptions) -> PreparedSolver:
        """Return a solver that keeps the pattern of the matrix between solves."""
        _compiled()
        return InteriorPointSolver(program, options)


@cache
def _compiled() -> None:
    """Compile all loops, so that the time of a solve does not include it."""
    with compiling():
        program, contact = least_program()
        solver = InteriorPointSolver(program, InteriorPointOptions())
        solver.solve(contact)
        solver.close()
        loops, points = best_loops(), np.array([[2.0], [1.0]])
        scaling = loops.scaled(points, points)
        # A solve may not need this function.
        loops.banded(scaling, points, points, 1.0, (0.1, 10.0))
        values, vectors = loops.frames(scaling, np.ones(0), np.ones((1, 1, 1)), 1)
        loops.framed(values, vectors, points)


_Way = tuple[str, int, ProgramState]  # native status, iterations, and final state


class InteriorPointSolver:
    """Interior-point method for one program."""

    def __init__(self, program: KinematicProgram, options: InteriorPointOptions) -> None:
        self._given, self._options = program, options
        self._solver = symmetric_solver(refined=False)
        self._indefinite = symmetric_solver(refined=False, definite=False)
        self._loops = best_loops()
        # The stiffness of bodies that move without strain would hide that of the contact.
        self._motions = motions(program, self._solver)
        self._program = program if self._motions is None else self._motions.stated(program)
        self._known: tuple[Translation, Stiffness] | None = None

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve from a cold start; the pattern is kept if the rows are the same.

        Where forces are lost to round-off, the method continues with more unknowns factorised
        (`Whole`). If it ends without an answer, it starts again with them.
        """
        begin, options = time.perf_counter(), self._options
        goal = Goal(options.tolerance, options.max_iterations, begin + options.time_limit)
        own = Translation(self._program, contact, self._loops)
        if self._known is None or not self._known[0].alike(contact):
            self._known = own, Stiffness(own.conic.kinds, self._loops)
        # Vectors and blocks are small, so several BLAS threads would only wait for each other.
        with one_thread_each(), np.errstate(all="ignore"):  # A step that overflows is rejected.
            answer = self._solved(contact, own, self._known[1], goal)
        return replace(answer, solve_time=time.perf_counter() - begin)

    def _solved(
        self, contact: FrozenContact, own: Translation, stiffness: Stiffness, goal: Goal
    ) -> InnerSolution:
        """Return the first certain answer, or else the last one that ended with a state."""
        iterations, answer = 0, InnerSolution(Status.FAILED, "singular matrix", 0, 0.0, None)
        with suppress(SingularError):  # raised where a formulation begins
            for native, count, point in self._ways(own, stiffness, goal):
                iterations += count
                found = self._answer(native, point, contact)
                if answer.status is Status.FAILED or found.status not in _NOWHERE:
                    answer = found
                if found.status in _SURE:
                    break
        return replace(answer, iterations=iterations)

    def _ways(self, own: Translation, stiffness: Stiffness, goal: Goal) -> Iterator[_Way]:
        """Yield the results of the formulations, one after the other.

        The first formulation factorises velocities alone. The second leaves out motions without
        resistance; if the loads are in balance, its velocity has no stress. The third factorises
        more unknowns. The first two also continue with more unknowns where forces are lost.
        """
        conic, basis = own.conic, None
        # If all loaded unknowns are fixed, no velocity has any power.
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
        loose = loosened(conic, self._solver)  # Round-off may drive motions that have no load.
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
        """Return a result in the unknowns of the program."""
        velocity = found.velocity if basis is None else np.asarray(basis @ found.velocity)
        point = self._moved(own.state(velocity, found.multipliers))
        return found.native, found.iterations, point

    def _answer(self, native: str, point: ProgramState, contact: FrozenContact) -> InnerSolution:
        """Return the answer with the status that its recomputed residuals prove."""
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
        name, left = solve_residual(*as_moved(self._given, point), contact, allowed)
        if left <= allowed:
            return answer
        return replace(
            answer,
            status=Status.ALMOST_SOLVED,
            native_status="almost solved",
            message=f"the residual {name!r}, recomputed, is {left:.1e}",
        )

    def _unstressed(self, velocity: Floats, load_factor: float) -> ProgramState:
        """Return a state with this velocity and without stress."""
        return self._moved(ProgramState.unstressed(self._program, velocity, load_factor))

    def _moved(self, state: ProgramState) -> ProgramState:
        """Return the state in the unknowns of the program."""
        if self._motions is None:
            return state
        return replace(state, velocity=np.asarray(self._motions.basis @ state.velocity))

    def close(self) -> None:
        """Give the factors back."""
        self._solver.close()
        self._indefinite.close()
