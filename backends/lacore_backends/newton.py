"""Primal-dual Newton method for the regularised program (T17-T21, T65), from a cold start, sparse.

Stresses are separate unknowns (`lacore_backends._newton_system`), so no continuation in r is
needed: an exact Hessian has singular directions far from the solution, this one has not.

Where strength depends on pressure, whole corners of yield have no curvature, and many steps lead
from one to the next, the more the smaller r is. There a barrier that goes to zero with the
iteration keeps stresses away from the edges of yield (`lacore_backends._interior_point`).
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import scipy

from lacore.numerics.arrays import Bools, Floats
from lacore.numerics.linear_algebra import Gram, SingularError
from lacore.numerics.symmetric import fast_solver, symmetric_solver
from lacore.program import FrozenContact, KinematicProgram
from lacore.program.regularization import (
    Penalties,
    RegularisedPoint,
    check_penalties,
    escaped,
    evaluate,
    judged_status,
    penalties,
)
from lacore.reporting.errors import require_count, require_positive
from lacore.reporting.status import Status
from lacore.solvers.backend import Capabilities, InnerSolution, PreparedSolver
from lacore_backends._answers import told
from lacore_backends._conic_laws import ConicLaws
from lacore_backends._goal import Goal
from lacore_backends._interior_point import follow
from lacore_backends._newton_system import Shape, System, laws_of, shape_of

_SLOPE = 0.5  # share of the slope that may remain after a step
_NOISE = 1e-14  # slope, by the power of the load, below which it is round-off
_FURTHER = 10.0  # factor for a step that is too short
_NARROW = 1e-2  # relative width of a bracket that is not refined
_MARGIN = 0.1  # share of a bracket that interpolation keeps from its ends
_SHORTEST = 1e-8  # step at which the line search fails
_STILL = 1e-12  # step, by the velocity, that is round-off
_LONGEST = 10.0  # step, by the velocity, that shows that the matrix is too soft
_SHORT = 1e-2  # step below which the matrix is assumed to be too soft
_NO_FORCE = 1e-9  # dimensionless force that counts as zero
_REDUCTION = 0.1  # factor of r between the steps of a continuation

STATUS_MAP = {
    "converged": Status.SOLVED,
    # above the tolerance, but without further change
    "converged to round-off": Status.ALMOST_SOLVED,
    "iteration limit": Status.ITERATION_LIMIT,
    "time limit": Status.TIME_LIMIT,
    "line search failed": Status.STALLED,
    "no progress": Status.STALLED,
    "singular matrix": Status.STALLED,
    "diverged": Status.FAILED,  # or the result of `judged_status`
}

fast_solver()  # Loading the library does not count to the time of the first solve.


@dataclass(frozen=True)
class NewtonOptions:
    """Options of the `newton` backend.

    Attributes:
        r: dimensionless regularisation (T20).
        eta, bulk: instead of r: viscosity and bulk penalty, Pa s.
        normal, tangential: instead of r: contact penalties, Pa/(m/s).
        tolerance: largest nodal force out of balance, per total load.
        max_iterations: limit of Newton steps.
        time_limit: s, limit for one inner solve.
    """

    r: float = 1e-4
    eta: float | None = None
    bulk: float | None = None
    normal: float | None = None
    tangential: float | None = None
    tolerance: float = 1e-8
    max_iterations: int = 200
    time_limit: float = 3600.0

    def __post_init__(self) -> None:
        check_penalties(self.r, self.eta, self.bulk, self.normal, self.tangential)
        require_count("newton.max_iterations", self.max_iterations)
        for name in ("tolerance", "time_limit"):
            require_positive(f"newton.{name}", getattr(self, name))


class Newton:
    """Fastest of the regularised backends, with one sparse factorisation per iteration."""

    name: ClassVar[str] = "newton"
    title: ClassVar[str] = "Primal-dual Newton, regularised program, sparse direct solver"
    source: ClassVar[str] = "Chan, Golub & Mulet, SIAM J. Sci. Comput. 20, 1999"
    capabilities: ClassVar[Capabilities] = Capabilities(
        regularised=True, warm_start=True, hardening=True, surfaces=True, paths=True
    )
    statuses: ClassVar[Mapping[Any, Status]] = STATUS_MAP
    Options: ClassVar[type] = NewtonOptions

    def unavailable(self) -> str:
        """Return an empty reason: SciPy is a dependency of lacore."""
        return ""

    def version(self) -> str:
        """Return the name and version of the solver."""
        return f"{symmetric_solver().name}, SciPy {scipy.__version__}"

    def prepare(self, program: KinematicProgram, options: NewtonOptions) -> PreparedSolver:
        """Prepare penalties and the rows of all laws, shared by all frozen contacts."""
        return (PressedSolver if program.pressure_dependent else NewtonSolver)(program, options)


@dataclass(frozen=True)
class _NewtonResult:
    """Last iterate; the multiplier is that of ``F0.U = 1``."""

    native: str
    iterations: int
    velocity: Floats
    multiplier: float
    message: str = ""

    @property
    def stuck(self) -> bool:
        """Whether another way to the solution may help."""
        return self.native in ("iteration limit", "line search failed", "singular matrix")


def _at_rest(point: RegularisedPoint) -> bool:
    """Return whether nothing resists the motion, so that no force gives a scale for round-off."""
    return point.values.energy <= _NO_FORCE**2 and np.abs(point.gradient).max() <= _NO_FORCE


class NewtonSolver:
    """Newton's method for one program."""

    def __init__(self, program: KinematicProgram, options: NewtonOptions) -> None:
        self._program, self._options = program, options
        self._target = _penalties(program, options)
        self._shape: Shape | None = None
        self._solver = symmetric_solver()
        self._velocity: Floats | None = None

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve; from the last velocity when only friction bounds have changed since."""
        begin = time.perf_counter()
        deadline = begin + self._options.time_limit
        plain = (contact.dilatancy <= 0) | (contact.bound > 0)
        if self._shape is None or not np.array_equal(plain, self._shape.plain):
            self._shape, self._velocity = shape_of(self._program, plain), None
        start = self._velocity
        answer = self._iterate(contact, self._target, start, deadline)
        iterations = answer.iterations
        if answer.stuck:
            # Under dilatancy a uniform flow has no curvature except in points that stick.
            start = None
            for penalty in self._target.continuation(_REDUCTION):
                answer = self._iterate(contact, penalty, start, deadline)
                iterations += answer.iterations
                start = answer.velocity
        self._velocity = None if escaped(answer.velocity) else answer.velocity
        point = evaluate(self._program, contact, self._target, answer.velocity, answer.multiplier)
        status = judged_status(STATUS_MAP[answer.native], self._program, point)
        return InnerSolution(
            status=status,
            native_status=answer.native,
            iterations=iterations,
            solve_time=time.perf_counter() - begin,
            point=point.state if status.has_point else None,
            regularised=point.values,
            message=answer.message,
        )

    def close(self) -> None:
        """Give the factors back."""
        self._solver.close()

    def _iterate(
        self, contact: FrozenContact, penalty: Penalties, start: Floats | None, deadline: float
    ) -> _NewtonResult:
        assert self._shape is not None
        system = System(self._program, contact, penalty, self._shape, self._solver)
        laws = laws_of(self._program, contact, penalty, self._shape)
        load = self._program.reference_load
        weight = float(np.abs(self._program.dead_load).sum())
        try:
            u = system.at_rest() if start is None else start
        except SingularError as error:
            nowhere = np.zeros(self._program.n)
            return _NewtonResult("singular matrix", 0, nowhere, float("nan"), str(error))
        for law in laws:
            law.step(u, 0 * u, 1.0)
        point = system.at(u)
        multiplier = float("nan")
        for iteration in range(1, self._options.max_iterations + 1):
            if time.perf_counter() > deadline:
                return _NewtonResult("time limit", iteration, u, multiplier)
            try:
                multiplier, change = system.direction(laws, u, point.gradient)
            except SingularError as error:
                return _NewtonResult("singular matrix", iteration, u, multiplier, str(error))
            # load factor with which the certificate will compare
            balance = point.values.load_factor
            forces = abs(balance) * float(np.abs(load).sum()) + weight
            out_of_balance = float(np.abs(point.gradient - balance * load).max())
            if out_of_balance <= self._options.tolerance * forces or _at_rest(point):
                return _NewtonResult("converged", iteration, u, multiplier)
            if np.abs(change).max() > _LONGEST * np.abs(u).max() and system.stiffen():
                continue
            share, new = _line_search(system, u, change, point, multiplier)
            if share < _SHORT and system.stiffen():
                continue
            if share < _SHORTEST:
                return _NewtonResult("line search failed", iteration, u, multiplier)
            if share > 0.5:
                system.soften()
            for law in laws:
                law.step(u, change, share)
            u, point = u + share * change, new
            if escaped(u):
                return _NewtonResult("diverged", iteration, u, multiplier)
            if np.abs(change).max() <= _STILL * np.abs(u).max():
                return _NewtonResult("converged to round-off", iteration, u, multiplier)
        return _NewtonResult("iteration limit", self._options.max_iterations, u, multiplier)


class PressedSolver:
    """Newton's method for one program with pressure-dependent strength."""

    def __init__(self, program: KinematicProgram, options: NewtonOptions) -> None:
        self._program, self._options = program, options
        self._penalty = _penalties(program, options)
        self._solver = symmetric_solver()
        self._known: tuple[tuple[Bools, ...], Gram] | None = None

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve; the pattern of the matrix depends on which contact points rub, stick or dilate."""
        begin = time.perf_counter()
        laws = ConicLaws(self._program, contact, self._penalty)
        same = self._known and all(map(np.array_equal, self._known[0], laws.pattern))
        if not (same and self._known):
            gram = Gram([law.rows for law in laws.each], [law.dim for law in laws.each])
            self._known = laws.pattern, gram
        options = self._options
        goal = Goal(options.tolerance, options.max_iterations, begin + options.time_limit)
        found = follow(self._program, laws, self._known[1], self._solver, goal)
        stresses, multipliers = zip(*((p.stress, p.multipliers) for p in found.places), strict=True)
        point = laws.point(found.velocity, found.multiplier, stresses, multipliers)
        status = judged_status(STATUS_MAP[found.native], self._program, point)
        seconds = time.perf_counter() - begin
        return told(point, status, found.native, found.iterations, seconds)

    def close(self) -> None:
        """Give the factors back."""
        self._solver.close()


def _penalties(program: KinematicProgram, options: NewtonOptions) -> Penalties:
    given = options.eta, options.bulk, options.normal, options.tangential
    return penalties(program.scales, options.r, *given)


def _line_search(
    system: System, u: Floats, change: Floats, point: RegularisedPoint, multiplier: float
) -> tuple[float, RegularisedPoint]:
    """Return the step at which the convex energy has lost most of its slope along `change`.

    Slopes are used instead of values, and without the load, which has no power on `change`: near
    the solution everything else is round-off.
    """
    load = multiplier * system.program.reference_load
    first = abs(float((point.gradient - load) @ change))
    enough = _SLOPE * first + _NOISE * abs(multiplier)
    short, long, share = (0.0, -first), (np.inf, np.inf), 1.0  # steps and their slopes
    while True:
        new = system.at(u + share * change)
        slope = float((new.gradient - load) @ change)
        away = slope <= 0 and escaped(new.state.velocity)
        if abs(slope) <= enough or share < _SHORTEST or away:
            return share, new
        short, long = (short, (share, slope)) if slope > 0 else ((share, slope), long)
        width = long[0] - short[0]
        if width <= _NARROW * share:
            return share, new
        # The energy still falls as steeply, so the minimum is far away or does not exist.
        if long[0] == np.inf:
            share *= _FURTHER
        else:
            part = short[1] / (short[1] - long[1])
            share = short[0] + width * min(max(part, _MARGIN), 1 - _MARGIN)
