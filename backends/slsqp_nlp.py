"""scipy's SLSQP on the regularised program (T17-T21): dense, for small meshes.

An independent check of the nonlinear program: a quasi-Newton method that sees values and
gradients only.
"""

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import numpy as np
import scipy
from scipy.optimize import minimize

from backends._preconditioned import (
    AWAY,
    LATE,
    DenseOptions,
    Minimum,
    Objective,
    PreconditionedSolver,
)
from lacore.arrays import Floats
from lacore.backend import Capabilities
from lacore.program import KinematicProgram
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
    LATE: Status.TIME_LIMIT,
    AWAY: Status.FAILED,  # or what `judged_status` makes of it
}


class Slsqp:
    """Sequential least squares programming."""

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
    Options: ClassVar[type] = DenseOptions

    def unavailable(self) -> str:
        """Always there: scipy is a dependency."""
        return ""

    def version(self) -> str:
        """The solver and its version."""
        return f"SciPy {scipy.__version__}"

    def prepare(self, program: KinematicProgram, options: DenseOptions) -> PreconditionedSolver:
        """Penalties and the preconditioner, shared by all frozen contacts."""
        return PreconditionedSolver(program, options, _minimise, STATUS_MAP)


def _minimise(
    objective: Objective,
    start: Floats,
    load: Floats,
    options: DenseOptions,
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
