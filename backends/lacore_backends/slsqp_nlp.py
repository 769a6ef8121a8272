"""SLSQP of SciPy for the regularised program (T17-T21): dense, for small meshes.

An independent check of the nonlinear program: a quasi-Newton method that uses values and analytic
gradients only. The unknowns are ``y = R U`` with ``R^T R`` the viscous matrix (no point yields), in
which the problem is close to isotropic. The first solve reduces r from 1 in steps; later solves
start from the previous solution.

Energies distinguish minima only to the square root of round-off. The end of the minimisation is
therefore improved by solving the equations of equilibrium, and the status that SciPy reports is
checked against the forces that are out of balance.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import scipy
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import minimize, root
from scipy.sparse import diags_array

from lacore.numerics.arrays import Floats, Sparse
from lacore.numerics.threads import one_thread_each
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
from lacore.reporting.errors import CapabilityError, require_count, require_positive
from lacore.reporting.status import Status
from lacore.solvers.backend import Capabilities, InnerSolution
from lacore_backends._answers import told

_BALANCED = 1e-7  # unbalanced force, by all forces, that the certificate should check
# unbalanced force, by all forces, that is not a minimum whatever SciPy reports
_OUT_OF_BALANCE = 1e-3
_AT_REST = 1e-10  # sum of forces below which there is nothing to balance
_JACOBIANS = 6  # number of Jacobians by differences that one method may compute
_STOPPED = 99  # status of SciPy for a callback that raised StopIteration
LATE = "time limit"  # native status of a run that our callback stops
AWAY = "ran away"  # native status of a run whose velocity is unbounded

STATUS_MAP = {
    -1: Status.FAILED,  # gradient evaluation required: internal
    0: Status.SOLVED,
    1: Status.FAILED,  # function evaluation required: internal
    2: Status.FAILED,  # more equality constraints than unknowns
    3: Status.STALLED,  # too many iterations in the least-squares subproblem
    4: Status.LOCKED,  # inequality constraints incompatible
    5: Status.STALLED,  # singular matrix E in the subproblem
    6: Status.STALLED,  # singular matrix C in the subproblem
    7: Status.STALLED,  # rank-deficient equality constraint
    8: Status.STALLED,  # positive directional derivative in the line search
    9: Status.ITERATION_LIMIT,
    LATE: Status.TIME_LIMIT,
    AWAY: Status.FAILED,  # or the result of `judged_status`
}


@dataclass(frozen=True)
class SlsqpOptions:
    """Options of SLSQP.

    Attributes:
        r: dimensionless regularisation (T20).
        eta, bulk: instead of r: viscosity and bulk penalty, Pa s.
        normal, tangential: instead of r: contact penalties, Pa/(m/s).
        reduction: factor between the steps of the continuation in r, 0 < reduction < 1.
        tolerance: tolerance of SciPy on the energy, near its round-off.
        max_iterations: limit of one continuation step.
        time_limit: s, limit for one inner solve.
    """

    r: float = 0.03
    eta: float | None = None
    bulk: float | None = None
    normal: float | None = None
    tangential: float | None = None
    reduction: float = 0.1
    tolerance: float = 1e-14
    max_iterations: int = 5000
    time_limit: float = 600.0

    def __post_init__(self) -> None:
        check_penalties(self.r, self.eta, self.bulk, self.normal, self.tangential)
        require_count("max_iterations", self.max_iterations)
        for name in ("tolerance", "time_limit"):
            require_positive(name, getattr(self, name))


@dataclass(frozen=True)
class Minimum:
    """Result of a minimiser.

    Attributes:
        y: unknowns, shape (n,).
        native: native status, a key of the map.
        message: message of the minimiser.
        iterations: number of iterations of the minimiser.
        multiplier: multiplier of ``load.y = 1`` (the load factor).
    """

    y: Floats
    native: Any
    message: str
    iterations: int
    multiplier: float


Objective = Callable[[Floats], tuple[float, Floats]]


class _Ran(Exception):  # noqa: N818  # no error: an answer
    """Raised when the velocity diverges; a minimiser would continue with infinities."""


class SlsqpSolver:
    """SLSQP for one program."""

    def __init__(self, program: KinematicProgram, options: SlsqpOptions) -> None:
        if program.n < 2:
            raise CapabilityError(
                f"with {program.n} velocity unknown(s), F0.U = 1 leaves nothing to minimise over:"
                " take an exact backend such as 'clarabel'"
            )
        self._program, self._options = program, options
        self._target = penalties(
            program.scales, options.r, options.eta, options.bulk, options.normal, options.tangential
        )
        self._steps = self._target.continuation(options.reduction)
        self._factor = cholesky(_viscous_matrix(program, self._target))
        self._load = solve_triangular(self._factor, program.reference_load, trans="T")
        self._start: Floats | None = None

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve from the last answer if there is one, else by continuation in r."""
        begin = time.perf_counter()
        deadline = begin + self._options.time_limit

        def watch(*_: object) -> None:
            if time.perf_counter() > deadline:
                raise StopIteration

        load = self._load
        start, steps = self._start, [self._target]
        if start is None:
            start, steps = load / float(load @ load), self._steps  # the viscous solution
        iterations = 0
        for penalty in steps:
            end = self._step(contact, penalty, start, watch)
            start = end.y
            iterations += end.iterations
            if end.native in (LATE, AWAY):
                break
        claimed = STATUS_MAP[end.native]
        if claimed in (Status.SOLVED, Status.STALLED):
            end = self._balanced(contact, end, watch)
        point = self._point(contact, end)
        claimed = self._recheck(claimed, point)
        status = judged_status(claimed, self._program, point)
        finished = status in (Status.SOLVED, Status.ALMOST_SOLVED)
        self._start = end.y if finished else None
        return told(point, status, end.message, iterations, time.perf_counter() - begin)

    def close(self) -> None:
        """Do nothing: no resources are held."""

    def _velocity(self, y: Floats) -> Floats:
        return np.asarray(solve_triangular(self._factor, y))

    def _step(
        self,
        contact: FrozenContact,
        penalty: Penalties,
        start: Floats,
        watch: Callable[..., None],
    ) -> Minimum:
        last = start

        def objective(y: Floats) -> tuple[float, Floats]:
            nonlocal last
            last = y
            velocity = self._velocity(y)
            if escaped(velocity):
                raise _Ran
            point = evaluate(self._program, contact, penalty, velocity)
            return point.objective, solve_triangular(self._factor, point.gradient, trans="T")

        try:
            # More BLAS threads than idle cores make these small dense steps ten times slower.
            with one_thread_each():
                return _minimise(objective, start, self._load, self._options, watch)
        except _Ran:
            return Minimum(np.nan_to_num(last), AWAY, AWAY, 0, float("nan"))

    def _balanced(
        self, contact: FrozenContact, end: Minimum, watch: Callable[..., None]
    ) -> Minimum:
        """Return an end closer to the minimum, by solving the equations of equilibrium.

        Only gradients are used (MINPACK), since the minimum of a convex energy is its equilibrium.
        Powell's method is fast; the Levenberg-Marquardt method also converges where many points are
        about to yield, so that the stiffness jumps.
        """
        rest = self._rest(self._point(contact, end))
        if not rest <= _OUT_OF_BALANCE:
            return end

        def unbalanced(unknowns: Floats) -> Floats:
            watch()
            y, multiplier = unknowns[:-1], unknowns[-1]
            gradient = evaluate(self._program, contact, self._target, self._velocity(y)).gradient
            forces = solve_triangular(self._factor, gradient, trans="T") - multiplier * self._load
            return np.append(forces, self._load @ y - 1.0)

        most = _JACOBIANS * (end.y.size + 2)
        for method, limits in {"hybr": {"maxfev": most}, "lm": {"maxiter": most}}.items():
            if rest <= _AT_REST:
                break
            start = np.append(end.y, end.multiplier)
            try:
                with one_thread_each():
                    found: Any = root(  # type: ignore[call-overload]  # a method by name
                        unbalanced, start, method=method, tol=1e-15, options=limits
                    )
            except StopIteration:  # The time is up, so the present point is the answer.
                break
            closer = replace(end, y=found.x[:-1], multiplier=float(found.x[-1]))
            left = self._rest(self._point(contact, closer))
            if left < rest:
                end, rest = closer, left
        return end

    def _point(self, contact: FrozenContact, end: Minimum) -> RegularisedPoint:
        velocity = self._velocity(end.y)
        return evaluate(self._program, contact, self._target, velocity, end.multiplier)

    def _rest(self, point: RegularisedPoint) -> float:
        """Return the largest unbalanced force, by the sum of all."""
        load_factor = point.values.load_factor
        forces = abs(load_factor) * float(np.abs(self._program.reference_load).sum())
        forces += float(np.abs(self._program.dead_load).sum())
        rest = np.abs(point.gradient - load_factor * self._program.reference_load).max()
        return float(rest / forces)

    def _recheck(self, claimed: Status, point: RegularisedPoint) -> Status:
        """Return the status after a check of the forces."""
        rest = self._rest(point)
        if claimed is Status.STALLED and rest <= _BALANCED:
            return Status.ALMOST_SOLVED  # Its line search ended at round-off.
        if claimed is Status.SOLVED and not rest <= _OUT_OF_BALANCE:
            return Status.STALLED
        return claimed


def _viscous_matrix(program: KinematicProgram, penalty: Penalties) -> Floats:
    """Return the Hessian of the energy without yield or slip and with closed contacts; dense.

    A multiple of the identity, small compared with its diagonal, resists rigid motions.
    """
    total = np.zeros((program.n, program.n))
    for group in program.groups:
        theta = penalty.eta * group.volumetric_factor**2 + penalty.bulk
        total += _gram(group.rows, np.repeat(penalty.eta * group.weights, group.dim))
        total += _gram(group.volumetric, theta * group.weights)
    contact = program.contact
    total += _gram(contact.normal, penalty.normal * contact.weights)
    total += _gram(
        contact.tangential, np.repeat(penalty.tangential * contact.weights, contact.tangent_dim)
    )
    total[np.diag_indices_from(total)] += 1e-9 * np.trace(total) / program.n
    return total


def _gram(rows: Sparse, weights: Floats) -> Floats:
    """Return ``rows^T diag(weights) rows``, dense."""
    return np.asarray((rows.T @ diags_array(weights) @ rows).toarray())


def _minimise(
    objective: Objective,
    start: Floats,
    load: Floats,
    options: SlsqpOptions,
    watch: Callable[..., None],
) -> Minimum:
    answer: Any = minimize(  # type: ignore[call-overload]  # its stubs want a TypedDict
        objective,
        start,
        jac=True,
        method="SLSQP",
        constraints={
            "type": "eq",
            "fun": lambda y: np.array([load @ y - 1.0]),
            "jac": lambda _: load[None, :],
        },
        callback=watch,
        options={"ftol": options.tolerance, "maxiter": options.max_iterations},
    )
    native = LATE if answer.status == _STOPPED else int(answer.status)
    return Minimum(
        y=np.asarray(answer.x),
        native=native,
        message=LATE if native == LATE else str(answer.message),
        iterations=int(answer.nit),
        multiplier=float(answer.multipliers[0]),
    )


class Slsqp:
    """Backend for sequential least squares programming."""

    name: ClassVar[str] = "slsqp"
    title: ClassVar[str] = "SLSQP (scipy), regularised program, small meshes"
    source: ClassVar[str] = "Kraft, DFVLR-FB 88-28, 1988"
    capabilities: ClassVar[Capabilities] = Capabilities(
        regularised=True,
        max_unknowns=1200,
        warm_start=True,
        hardening=True,
        isolated=True,
        dense=True,
    )
    statuses: ClassVar[Mapping[Any, Status]] = STATUS_MAP
    Options: ClassVar[type] = SlsqpOptions

    def unavailable(self) -> str:
        """Return an empty reason: SciPy is a dependency of lacore."""
        return ""

    def version(self) -> str:
        """Return the name and version of the solver."""
        return f"SciPy {scipy.__version__}"

    def prepare(self, program: KinematicProgram, options: SlsqpOptions) -> SlsqpSolver:
        """Prepare penalties and the preconditioner, shared by all frozen contacts."""
        return SlsqpSolver(program, options)
