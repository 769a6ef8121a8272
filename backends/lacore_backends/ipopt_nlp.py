"""IPOPT through CasADi for the regularised nonlinear program of the paper, as corrected (T17-T21).

Unknowns are velocities alone; the one constraint is ``F0.U = 1``. Energy, gradient and Hessian of a
strain point or a contact point are small symbolic functions mapped over all points, so the Hessian
``B^T H B`` is exact and sparse without differentiating the whole problem. The regularisation is
continued from r = 1 downwards, each step warm-started; where strength depends on pressure, a
barrier is reduced instead (`lacore_backends._barrier_program`).
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from lacore.numerics.arrays import Floats, Sparse
from lacore.program import FrozenContact, KinematicProgram, interleaved
from lacore.program.regularization import (
    Penalties,
    check_penalties,
    escaped,
    evaluate,
    judged_status,
    penalties,
)
from lacore.reporting.errors import InputError, is_number, require_count, require_positive
from lacore.reporting.status import Status
from lacore.solvers.backend import Capabilities, InnerSolution, PreparedSolver
from lacore_backends._barrier_program import BarrierSolver, Fading
from lacore_backends._huber_laws import Law, contact_law, plastic_law
from lacore_backends._ipopt import STATUS_MAP, solver_version, to_casadi, unavailable

_ON_THE_WAY = 1e-3  # tolerance of the steps of the continuation except the last
# a friction bound that is never reached, since infinity cannot be used in the algebra
_STICK = 1e20


@dataclass(frozen=True)
class IpoptOptions:
    """Options of the `ipopt` backend.

    Attributes:
        r: dimensionless regularisation (T20); the error of lambda is about proportional to r^2.
        eta, bulk: instead of r: viscosity and bulk penalty, Pa s.
        normal, tangential: instead of r: contact penalties, Pa/(m/s).
        reduction: factor between the steps of the continuation, 0 < reduction < 1.
        rescue: share of the rank-one term kept in the Hessian when a step with the exact one
            fails, 0 <= rescue < 1; unused where strength depends on pressure.
        tolerance: tolerance of IPOPT.
        max_iterations: limit of one continuation step.
        time_limit: s, limit for one inner solve.
    """

    r: float = 1e-3
    eta: float | None = None
    bulk: float | None = None
    normal: float | None = None
    tangential: float | None = None
    reduction: float = 0.1
    rescue: float = 0.95
    tolerance: float = 1e-9
    max_iterations: int = 300
    time_limit: float = 3600.0

    def __post_init__(self) -> None:
        check_penalties(self.r, self.eta, self.bulk, self.normal, self.tangential)
        require_count("ipopt.max_iterations", self.max_iterations)
        for name in ("tolerance", "time_limit"):
            require_positive(f"ipopt.{name}", getattr(self, name))
        if not (is_number(self.rescue) and 0 <= self.rescue < 1):
            raise InputError("ipopt.rescue", self.rescue, "outside [0, 1)", "give e.g. 0.95")


class Ipopt:
    """Backend for the nonlinear program of the paper."""

    name: ClassVar[str] = "ipopt"
    title: ClassVar[str] = "IPOPT through CasADi, regularised nonlinear program"
    source: ClassVar[str] = "Waechter & Biegler, Math. Program. 106, 2006; Andersson et al. 2019"
    capabilities: ClassVar[Capabilities] = Capabilities(
        regularised=True,
        warm_start=True,
        hardening=True,
        surfaces=True,
        slow_surfaces=True,
        packages=("casadi",),
    )
    statuses: ClassVar[Mapping[Any, Status]] = STATUS_MAP
    Options: ClassVar[type] = IpoptOptions

    def unavailable(self) -> str:
        """Return why IPOPT cannot run; empty if it can."""
        return unavailable()

    def version(self) -> str:
        """Return the name and version of the solver."""
        return solver_version()

    def prepare(self, program: KinematicProgram, options: IpoptOptions) -> PreparedSolver:
        """Prepare the penalties, and point functions or the rows of all laws."""
        target = _penalties(program, options)
        if not program.pressure_dependent:
            return IpoptSolver(program, options, target)
        limits = options.tolerance, options.max_iterations, options.time_limit
        return BarrierSolver(program, target, Fading(options.reduction, *limits))


class IpoptSolver:
    """IPOPT for one program."""

    def __init__(self, program: KinematicProgram, options: IpoptOptions, target: Penalties) -> None:
        self._program, self._options, self._target = program, options, target
        self._dilatancy: Floats | None = None
        self._form: tuple[dict[str, Any], dict[str, Any]] = {}, {}
        self._warm: _Step | None = None

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve from the last answer if there is one, else by continuation in r."""
        begin = time.perf_counter()
        deadline = begin + self._options.time_limit
        if self._dilatancy is None or not np.array_equal(self._dilatancy, contact.dilatancy):
            self._form = _build(self._program, contact)
            self._dilatancy = contact.dilatancy
        iterations = 0
        answer = self._warm
        if answer is not None:
            answer = self._step(contact, self._target, 1.0, answer, deadline)
            iterations = answer.iterations
        if answer is None or not (answer.hopeless or STATUS_MAP[answer.native] is Status.SOLVED):
            load = self._program.reference_load
            answer = _Step("", 0, load / float(load @ load), 0.0)
            for penalty in self._target.continuation(self._options.reduction):
                before = answer
                answer = self._step(contact, penalty, 1.0, before, deadline)
                iterations += answer.iterations
                if answer.hopeless:
                    break
                if STATUS_MAP[answer.native] is not Status.SOLVED:
                    answer = self._step(contact, penalty, self._options.rescue, before, deadline)
                    iterations += answer.iterations
        # A step that failed, or diverged because of a small bound, is not used as a start.
        solved = STATUS_MAP[answer.native] is Status.SOLVED and not answer.hopeless
        self._warm = answer if solved else None
        native = answer.native
        point = evaluate(self._program, contact, self._target, answer.velocity, answer.multiplier)
        status = judged_status(STATUS_MAP[native], self._program, point)
        return InnerSolution(
            status=status,
            native_status=native,
            iterations=iterations,
            solve_time=time.perf_counter() - begin,
            point=point.state if status.has_point else None,
            regularised=point.values,
        )

    def close(self) -> None:
        """Do nothing: no resources are held."""

    def _step(
        self,
        contact: FrozenContact,
        penalty: Penalties,
        damping: float,
        start: "_Step",
        deadline: float,
    ) -> "_Step":
        # Steps of the continuation are only starts of the next one.
        tolerance = self._options.tolerance if penalty == self._target else _ON_THE_WAY
        left = max(deadline - time.perf_counter(), 1e-9)
        nlp = _solver(*self._form, self._options, tolerance, left)
        parameters = [penalty.eta, penalty.bulk, penalty.normal, penalty.tangential, damping]
        answer = nlp(
            x0=start.velocity,
            lam_g0=-start.multiplier,
            lbg=1.0,
            ubg=1.0,
            p=np.concatenate([parameters, np.minimum(contact.bound, _STICK), contact.shift]),
        )
        stats = nlp.stats()
        return _Step(
            native=str(stats["return_status"]),
            iterations=int(stats["iter_count"]),
            velocity=np.array(answer["x"]).ravel(),
            multiplier=-float(answer["lam_g"]),
        )


@dataclass(frozen=True)
class _Step:
    """Result of one run of IPOPT; the multiplier is that of ``F0.U = 1``, the load factor."""

    native: str
    iterations: int
    velocity: Floats
    multiplier: float

    @property
    def hopeless(self) -> bool:
        """Whether another attempt cannot help: time is up, or the program is unbounded."""
        out_of_time = STATUS_MAP[self.native] is Status.TIME_LIMIT
        return out_of_time or escaped(self.velocity)


def _penalties(program: KinematicProgram, options: IpoptOptions) -> Penalties:
    given = options.eta, options.bulk, options.normal, options.tangential
    return penalties(program.scales, options.r, *given)


def _build(
    program: KinematicProgram, contact: FrozenContact
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the nonlinear program and its derivatives for `casadi.nlpsol`.

    Parameters: four penalties, the damping of the Hessian, friction bounds, shifts.
    """
    u = ca.MX.sym("u", program.n)
    points = program.contact.count
    p = ca.MX.sym("p", 5 + 2 * points)
    value = -ca.dot(program.dead_load, u)
    gradient = -ca.MX(program.dead_load)
    hessian = ca.MX(program.n, program.n)
    for group in program.groups:
        count = group.weights.size
        if not count:
            continue
        rows = interleaved(group.rows, group.dim, group.volumetric, 1)
        law = plastic_law(group.dim, group.volumetric_factor)
        constants = ca.DM(np.stack([group.weights, group.bound, group.rise]))
        part = _terms(
            rows, group.dim + 1, law, u, constants, ca.repmat(ca.vertcat(p[:2], p[4]), 1, count)
        )
        value, gradient, hessian = (
            a + b for a, b in zip((value, gradient, hessian), part, strict=True)
        )
    if points:
        rows = interleaved(
            program.contact.normal, 1, program.contact.tangential, program.contact.tangent_dim
        )
        law = contact_law(program.contact.tangent_dim)
        constants = ca.DM(np.stack([program.contact.weights, contact.dilatancy]))
        parameters = ca.vertcat(
            ca.repmat(p[2:4], 1, points), p[5 : 5 + points].T, p[5 + points :].T
        )
        part = _terms(rows, 1 + program.contact.tangent_dim, law, u, constants, parameters)
        value, gradient, hessian = (
            a + b for a, b in zip((value, gradient, hessian), part, strict=True)
        )
    load = ca.DM(program.reference_load)
    power = ca.dot(load, u)
    factor, multiplier = ca.MX.sym("lam_f"), ca.MX.sym("lam_g")
    return {"x": u, "p": p, "f": value, "g": power}, {
        "grad_f": ca.Function("grad_f", [u, p], [value, gradient]),
        "jac_g": ca.Function("jac_g", [u, p], [power, load.T]),
        "hess_lag": ca.Function(
            "hess_lag", [u, p, factor, multiplier], [ca.triu(factor * hessian)]
        ),
    }


def _solver(
    problem: dict[str, Any],
    derivatives: dict[str, Any],
    options: IpoptOptions,
    tolerance: float,
    left: float,
) -> Any:
    """Return IPOPT for the program, with `left` seconds remaining."""
    settings: dict[str, Any] = {
        "print_time": False,
        "error_on_fail": False,
        "calc_lam_p": False,
        "calc_lam_x": False,
        "ipopt": {
            "print_level": 0,
            "sb": "yes",
            "tol": tolerance,
            "max_iter": options.max_iterations,
            "max_wall_time": left,
            "acceptable_iter": 0,
            "jac_c_constant": "yes",
            # Newton steps on Huber functions overshoot by 10 to 1000: measured on punches, platens
            # and blocks, 0.2 needs half the iterations of the default 0.5.
            "alpha_red_factor": 0.2,
            "nlp_scaling_method": "none",
            # A block without contact has no stiffness: without a lower limit of the perturbation
            # the next Newton step would be very long, and the watchdog would accept it unchecked.
            "watchdog_shortened_iter_trigger": 0,
            "min_hessian_perturbation": 1e-4,
            # The program is convex, so no residual of a step needs a check.
            "fast_step_computation": "yes",
        },
    }
    return ca.nlpsol("regularised", "ipopt", problem, {**derivatives, **settings})


def _terms(rows: Sparse, dim: int, law: Law, u: Any, constants: Any, parameters: Any) -> list[Any]:
    """Return the sum of a point law over all points: value, gradient, Hessian."""
    count = rows.shape[0] // dim
    matrix = to_casadi(rows)
    local = ca.reshape(ca.mtimes(matrix, u), dim, count)
    energy = law.energy(*(ca.vertsplit(part) for part in (local, constants, parameters)))
    force, stiffness = (
        derivative.map(count)(local, constants, parameters) for derivative in law.derivatives
    )
    pattern = ca.diagcat(*[ca.Sparsity.dense(dim, dim)] * count)
    blocks = ca.MX(pattern, ca.vec(stiffness))
    return [
        ca.sum2(energy),
        ca.mtimes(matrix.T, ca.vec(force)),
        ca.mtimes(matrix.T, ca.mtimes(blocks, matrix)),
    ]
