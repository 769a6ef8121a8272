"""scipy's SLSQP on the regularised program (T17-T21): dense, for small meshes.

An independent check of the nonlinear program: a quasi-Newton method that sees values and
gradients only. Unknowns are preconditioned with the Cholesky factor of the linear viscous matrix
(every point unyielded), in which the problem is close to isotropic.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import scipy
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import minimize
from scipy.sparse import diags_array
from threadpoolctl import threadpool_limits

from lacore.arrays import Floats, Sparse
from lacore.backend import Capabilities, InnerSolution
from lacore.errors import require_count, require_positive
from lacore.program import FrozenContact, KinematicProgram
from lacore.regularization import Penalties, evaluate, judged_status, penalties
from lacore.status import Status

_STOPPED = 99  # scipy's mark for a callback that raised StopIteration

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
    _STOPPED: Status.TIME_LIMIT,  # stopped by our callback
}


@dataclass(frozen=True)
class SlsqpOptions:
    """Options of the `slsqp` backend.

    Attributes:
        r: dimensionless regularisation (T20).
        eta, bulk: instead of r: viscosity and bulk penalty, Pa s.
        normal, tangential: instead of r: contact penalties, Pa/(m/s).
        reduction: factor between the steps of the continuation in r, 0 < reduction < 1.
        tolerance: SLSQP's, on the change of the objective; near its round-off, because nodal forces
            balance only to the root of it.
        max_iterations: of one continuation step.
        time_limit: s, one inner solve.
    """

    r: float = 0.03
    eta: float | None = None
    bulk: float | None = None
    normal: float | None = None
    tangential: float | None = None
    reduction: float = 0.1
    tolerance: float = 1e-18
    max_iterations: int = 2000
    time_limit: float = 600.0

    def __post_init__(self) -> None:
        require_count("slsqp.max_iterations", self.max_iterations)
        for name in ("tolerance", "time_limit"):
            require_positive(f"slsqp.{name}", getattr(self, name))


class Slsqp:
    """Sequential least squares programming."""

    name: ClassVar[str] = "slsqp"
    title: ClassVar[str] = "SLSQP (scipy), regularised program, small meshes"
    source: ClassVar[str] = "Kraft, DFVLR-FB 88-28, 1988"
    capabilities: ClassVar[Capabilities] = Capabilities(
        regularised=True, max_unknowns=1200, warm_start=True, isolated=True
    )
    statuses: ClassVar[Mapping[Any, Status]] = STATUS_MAP
    Options: ClassVar[type] = SlsqpOptions

    def unavailable(self) -> str:
        """Always there: scipy is a dependency."""
        return ""

    def version(self) -> str:
        """The solver and its version."""
        return f"SciPy {scipy.__version__}"

    def prepare(self, program: KinematicProgram, options: SlsqpOptions) -> "SlsqpSolver":
        """Penalties and the preconditioner, shared by all frozen contacts."""
        return SlsqpSolver(program, options)


class SlsqpSolver:
    """SLSQP at work on one program; unknowns ``y = R U`` with ``R^T R`` the viscous matrix."""

    def __init__(self, program: KinematicProgram, options: SlsqpOptions) -> None:
        self._program, self._options = program, options
        self._target = penalties(
            program.scales, options.r, options.eta, options.bulk, options.normal, options.tangential
        )
        self._factor = cholesky(_viscous_matrix(program, self._target))
        self._start: Floats | None = None

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve; from the last answer when there is one, else by continuation in r."""
        begin = time.perf_counter()
        deadline = begin + self._options.time_limit
        load = solve_triangular(self._factor, self._program.reference_load, trans="T")
        steps = [self._target]
        if self._start is None:
            self._start = load / float(load @ load)  # the viscous solution
            steps = self._target.continuation(self._options.reduction)
        iterations = 0
        for penalty in steps:
            # More BLAS threads than idle cores make these small dense steps ten times slower.
            with threadpool_limits(1, user_api="blas"):
                answer = self._step(contact, penalty, load, deadline)
            self._start = np.asarray(answer.x)
            iterations += int(answer.nit)
            if answer.status == _STOPPED:
                break
        point = evaluate(
            self._program,
            contact,
            self._target,
            solve_triangular(self._factor, self._start),
            float(answer.multipliers[0]),
        )
        status = judged_status(STATUS_MAP[int(answer.status)], self._program, point)
        return InnerSolution(
            status=status,
            native_status=str(answer.message),
            iterations=iterations,
            solve_time=time.perf_counter() - begin,
            point=point.state if status.has_point else None,
            regularised=point.values,
        )

    def close(self) -> None:
        """Nothing is held."""

    def _step(
        self, contact: FrozenContact, penalty: Penalties, load: Floats, deadline: float
    ) -> Any:
        def objective(y: Floats) -> tuple[float, Floats]:
            point = evaluate(self._program, contact, penalty, solve_triangular(self._factor, y))
            return point.values.alpha_reg, solve_triangular(self._factor, point.gradient, trans="T")

        def watch(_: Floats) -> None:
            if time.perf_counter() > deadline:
                raise StopIteration

        return minimize(  # type: ignore[call-overload]  # its stubs want a TypedDict of options
            objective,
            self._start,
            jac=True,
            method="SLSQP",
            constraints={
                "type": "eq",
                "fun": lambda y: np.array([load @ y - 1.0]),
                "jac": lambda _: load[None, :],
            },
            callback=watch,
            options={"ftol": self._options.tolerance, "maxiter": self._options.max_iterations},
        )


def _viscous_matrix(program: KinematicProgram, penalty: Penalties) -> Floats:
    """Hessian of the energy where nothing yields or slips, every contact point closed; dense.

    A multiple of the identity, small against its diagonal, keeps rigid motions from being free.
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
    """``rows^T diag(weights) rows``, dense."""
    return np.asarray((rows.T @ diags_array(weights) @ rows).toarray())
