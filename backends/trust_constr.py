"""scipy's trust-region method on the regularised program (T17-T21): dense, for small meshes.

Byrd, Hribar & Nocedal's projected conjugate gradients with BFGS curvature. It sees what `slsqp`
sees; at 1 000 unknowns it needs about a tenth of its time, because its steps cost n^2 instead of
n^3.
"""

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import scipy
from scipy.optimize import BFGS, LinearConstraint, minimize

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

STATUS_MAP = {
    0: Status.ITERATION_LIMIT,
    1: Status.SOLVED,  # gradient small
    2: Status.STALLED,  # trust region shrunk to nothing: rechecked by the forces
    3: Status.TIME_LIMIT,  # stopped by our callback
    4: Status.LOCKED,  # constraints violated
    LATE: Status.TIME_LIMIT,
    AWAY: Status.FAILED,  # or what `judged_status` makes of it
}
_STOPPED = 3


@dataclass(frozen=True)
class TrustConstrOptions(DenseOptions):
    """As `DenseOptions`; `tolerance` is on the gradient of the Lagrangian."""

    tolerance: float = 1e-10


class TrustConstr:
    """Trust-region interior point, here with one linear equality only."""

    name: ClassVar[str] = "trust-constr"
    title: ClassVar[str] = "trust-constr (scipy), regularised program, small meshes"
    source: ClassVar[str] = "Byrd, Hribar & Nocedal, SIAM J. Optim. 9, 1999"
    capabilities: ClassVar[Capabilities] = Capabilities(
        regularised=True,
        max_unknowns=1200,
        warm_start=True,
        hardening=True,
        on_demand=True,  # it says what slsqp says
        dense=True,
        infeasibility=False,  # its trust region keeps it from running away in time
    )
    statuses: ClassVar[Mapping[Any, Status]] = STATUS_MAP
    Options: ClassVar[type] = TrustConstrOptions

    def unavailable(self) -> str:
        """Always there: scipy is a dependency."""
        return ""

    def version(self) -> str:
        """The solver and its version."""
        return f"SciPy {scipy.__version__}"

    def prepare(
        self, program: KinematicProgram, options: TrustConstrOptions
    ) -> PreconditionedSolver:
        """Penalties and the preconditioner, shared by all frozen contacts."""
        return PreconditionedSolver(program, options, _minimise, STATUS_MAP)


def _minimise(
    objective: Objective,
    start: Floats,
    load: Floats,
    options: DenseOptions,
    watch: Callable[..., None],
) -> Minimum:
    def stop(*_: object) -> bool:
        try:
            watch()
        except StopIteration:
            return True
        return False

    with warnings.catch_warnings():
        # Where the energy is linear BFGS has nothing to learn from a step, and says so each time.
        warnings.filterwarnings("ignore", "delta_grad == 0.0")
        answer: Any = minimize(  # type: ignore[call-overload]  # its stubs want a TypedDict
            objective,
            start,
            jac=True,
            hess=BFGS(),
            method="trust-constr",
            constraints=LinearConstraint(load[None, :], 1.0, 1.0),
            callback=stop,
            options={
                "gtol": options.tolerance,
                "xtol": 1e-15,
                "maxiter": options.max_iterations,
            },
        )
    return Minimum(
        y=np.asarray(answer.x),
        native=LATE if answer.status == _STOPPED else int(answer.status),
        message=LATE if answer.status == _STOPPED else str(answer.message),
        iterations=int(answer.nit),
        multiplier=-float(np.asarray(answer.v[0]).item()),
    )
