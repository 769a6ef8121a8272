"""Known solvers of cvxpy and their names for the options of the `cvxpy` backend."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any

from lacore.reporting.errors import require_count, require_positive


@dataclass(frozen=True)
class OwnDefaults:
    """Options of a solver with unknown keywords, which uses its own defaults.

    Attributes:
        time_limit: s, limit for one inner solve.
    """

    time_limit: float = 3600.0

    def __post_init__(self) -> None:
        require_positive("cvxpy.time_limit", self.time_limit)


@dataclass(frozen=True)
class InteriorPointOptions(OwnDefaults):
    """Options of interior-point and simplex solvers, whose error is about their tolerance.

    Attributes:
        tolerance: relative tolerance on gap and feasibility.
        max_iterations: limit of the solver.
        time_limit: s, limit for one inner solve.
    """

    tolerance: float = 1e-10
    max_iterations: int = 200

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive("cvxpy.tolerance", self.tolerance)
        require_count("cvxpy.max_iterations", self.max_iterations)


@dataclass(frozen=True)
class SimplexOptions(InteriorPointOptions):
    """As `InteriorPointOptions`, for solvers of many short iterations."""

    max_iterations: int = 1_000_000


@dataclass(frozen=True)
class FirstOrderOptions(InteriorPointOptions):
    """Options of first-order solvers.

    They promise residuals of `tolerance` relative to the largest number in the program. The
    accuracy of load factors and certificates is about ten times that for a well-scaled program, and
    worse for graded meshes. The certificate decides.
    """

    tolerance: float = 1e-8
    max_iterations: int = 100_000


@dataclass(frozen=True)
class Solver:
    """Keywords of a solver for the options. Without a keyword for time it has no time limit."""

    package: str
    options: type
    tolerance: tuple[str, ...] = ()
    iterations: str = ""
    time: str = ""
    within: str = ""  # name of a keyword whose value is a dictionary of all options
    always: Mapping[str, Any] = field(default_factory=dict)
    warm_start: bool = False
    infeasibility: bool = True  # whether it searches for proofs of infeasibility
    # whether costs may be quadratic; as cones, ECOS leaves 2e-6 of yield instead of 1e-11
    quadratic: bool = False

    def settings(self, options: Any) -> dict[str, Any]:
        """Return the keywords of `cvxpy.Problem.solve`."""
        given: dict[str, Any] = {}
        if self.iterations:
            given |= dict.fromkeys(self.tolerance, options.tolerance)
            given[self.iterations] = options.max_iterations
        if self.time:
            given[self.time] = options.time_limit
        return {self.within: given} if self.within else given | dict(self.always)


_MOSEK = "MSK_DPAR_INTPNT_CO_TOL_"
SOLVERS = {
    "CLARABEL": Solver(
        "clarabel",
        InteriorPointOptions,
        ("tol_gap_abs", "tol_gap_rel", "tol_feas"),
        "max_iter",
        "time_limit",
        always={"accept_unknown": True},  # "insufficient progress" still returns a point.
        quadratic=True,
    ),
    "ECOS": Solver("ecos", InteriorPointOptions, ("abstol", "reltol", "feastol"), "max_iters"),
    "HIGHS": Solver(
        "highspy",
        SimplexOptions,
        ("primal_feasibility_tolerance", "dual_feasibility_tolerance"),
        "simplex_iteration_limit",
        "time_limit",
        always={"small_matrix_value": 1e-12},  # Smaller entries would be dropped.
    ),
    "MOSEK": Solver(
        "mosek",
        InteriorPointOptions,
        (f"{_MOSEK}PFEAS", f"{_MOSEK}DFEAS", f"{_MOSEK}REL_GAP"),
        "MSK_IPAR_INTPNT_MAX_ITERATIONS",
        "MSK_DPAR_OPTIMIZER_MAX_TIME",
        within="mosek_params",
    ),
    "OSQP": Solver(
        "osqp",
        FirstOrderOptions,
        ("eps_abs", "eps_rel"),
        "max_iter",
        "time_limit",
        warm_start=True,
        quadratic=True,
    ),
    # On infeasible and unbounded programs it fails, or returns a diverged point as "optimal", which
    # fails the certificate.
    "QOCO": Solver(
        "qoco",
        InteriorPointOptions,
        ("abstol", "reltol"),
        "max_iters",
        infeasibility=False,
        quadratic=True,
    ),
    "SCS": Solver(
        "scs",
        FirstOrderOptions,
        ("eps_abs", "eps_rel"),
        "max_iters",
        "time_limit_secs",
        warm_start=True,
        quadratic=True,
    ),
}


def known_solver(name: str) -> Solver:
    """Return the properties of a solver of cvxpy; an unknown solver has its own defaults."""
    return SOLVERS.get(name, Solver(name.lower(), OwnDefaults))


def no_mosek_licence() -> str:
    """Return the message of MOSEK if it has no licence; empty if it has one."""
    mosek = import_module("mosek")
    try:
        with mosek.Env() as environment:
            environment.checkoutlicense(mosek.feature.pton)
    except mosek.Error as error:
        said = str(error).rstrip(": ")
        return f"MOSEK has no licence here ({said}): put one at ~/mosek/mosek.lic, see mosek.com"
    return ""
