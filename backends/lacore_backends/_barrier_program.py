"""IPOPT for pressure-dependent strength, by a barrier that is reduced. Not a backend.

The program is that of `ipopt`: velocities alone with ``F0.U = 1``. At mu = 0 its gradient has kinks
wherever stresses meet corners of the yield surface, and Newton's method jumps between them. Instead
of r, the barrier that keeps stresses away from the edges is therefore reduced step by step
(`lacore_backends._barrier_laws`). Stresses and shares of the last step are those of the answer:
they are in equilibrium and within yield, and their gap to mu = 0 is known.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from lacore.numerics.arrays import Bools, Floats, Sparse
from lacore.numerics.linear_algebra import Gram
from lacore.program import FrozenContact, KinematicProgram
from lacore.program.regularization import Penalties, escaped, judged_status
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution
from lacore_backends._answers import told
from lacore_backends._barrier_laws import BarrierLaw, Smoothed
from lacore_backends._conic_laws import ConicLaws
from lacore_backends._ipopt import STATUS_MAP

_FIRST = 1.0  # mu, dimensionless: strengths and powers are about 1
_POWER = 0.05  # gap at the end, dimensionless power, by the tolerance
_LOOSE = 10.0  # tolerance of all steps except the last, by mu
_LOOSEST = 1e-3
_EASY = 2  # limit of iterations for a step to count as easy; the next step is then longer
_ESCAPED = 1e8  # velocity at which a step ends: no mechanism is as fast


@dataclass(frozen=True)
class Fading:
    """Parameters of the reduction of the barrier.

    Attributes:
        reduction: ratio of mu between two steps.
        tolerance, max_iterations: IPOPT's, for the last step and for each step.
        time_limit: s, limit for all steps.
    """

    reduction: float
    tolerance: float
    max_iterations: int
    time_limit: float


class BarrierSolver:
    """IPOPT for one program with pressure-dependent strength."""

    def __init__(self, program: KinematicProgram, penalty: Penalties, fading: Fading) -> None:
        self._program, self._penalty, self._fading = program, penalty, fading
        self._known: tuple[tuple[Bools, ...], Gram] | None = None

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve, from the same start each time."""
        begin = time.perf_counter()
        laws = ConicLaws(self._program, contact, self._penalty)
        same = self._known and all(map(np.array_equal, self._known[0], laws.pattern))
        if not (same and self._known):
            gram = Gram([law.rows for law in laws.each], [law.dim for law in laws.each])
            self._known = laws.pattern, gram
        energy = _Energy(self._program, laws, self._known[1])
        found = _followed(energy, self._fading, begin + self._fading.time_limit)
        at = energy.at(found.velocity, found.mu)
        point = laws.point(
            found.velocity,
            found.multiplier,
            [law.stress for law in at.laws],
            [law.multipliers for law in at.laws],
        )
        status = judged_status(STATUS_MAP[found.native], self._program, point)
        seconds = time.perf_counter() - begin
        return told(point, status, found.native, found.iterations, seconds)

    def close(self) -> None:
        """Do nothing: no resources are held."""


@dataclass(frozen=True)
class _At:
    """Energy at a velocity and mu, with the blocks of its Hessian."""

    value: float
    gradient: Floats
    laws: tuple[Smoothed, ...]


class _Energy:
    """Smoothed energy minus the power of the dead load."""

    def __init__(self, program: KinematicProgram, laws: ConicLaws, gram: Gram) -> None:
        self.program, self._gram = program, gram
        self._laws = [BarrierLaw(law) for law in laws.each]
        self._held: tuple[bytes, float, _At] | None = None

    @property
    def volume(self) -> float:
        """The gap is mu times it."""
        return sum(law.volume for law in self._laws)

    def at(self, velocity: Floats, mu: float) -> _At:
        """Return the energy; the last result is kept for value, gradient and Hessian."""
        key = velocity.tobytes()
        if self._held is None or self._held[:2] != (key, mu):
            found = tuple(law.at(velocity, mu) for law in self._laws)
            gradient = -self.program.dead_load
            for law, part in zip(self._laws, found, strict=True):
                gradient = gradient + law.law.force(part.stress)
            value = sum(part.energy for part in found)
            value -= float(self.program.dead_load @ velocity)
            # The step is too long, so IPOPT takes a shorter one.
            if not all(part.sound for part in found):
                value = float("nan")
            self._held = key, mu, _At(value, gradient, found)
        return self._held[2]

    def hessian(self, velocity: Floats, mu: float) -> Floats:
        """Return the entries of the Hessian in the order of `pattern`."""
        blocks = [part.stiffness for part in self.at(velocity, mu).laws]
        return np.asarray(self._gram.matrix(blocks).data)

    def pattern(self) -> Sparse:
        """Return the pattern of the Hessian, which is the same at all velocities."""
        dims = [(law.law.weights.size, law.law.dim) for law in self._laws]
        return self._gram.matrix([np.zeros((m, dim, dim)) for m, dim in dims])


@dataclass(frozen=True)
class _BarrierResult:
    """Result of a run; the multiplier is that of ``F0.U = 1``."""

    native: str
    iterations: int
    mu: float
    velocity: Floats
    multiplier: float


def _followed(energy: _Energy, fading: Fading, deadline: float) -> _BarrierResult:
    """Run IPOPT for each mu, starting from the velocity of the last run."""
    load = energy.program.reference_load
    program = _Program(energy)
    mu, last = _FIRST, _POWER * fading.tolerance / energy.volume
    found = _BarrierResult("", 0, mu, load / float(load @ load), 0.0)
    while True:
        mu = max(mu, last)
        tolerance = fading.tolerance
        if mu > last:
            tolerance = max(tolerance, min(_LOOSE * mu, _LOOSEST))
        left = max(deadline - time.perf_counter(), 1e-9)
        before, found = found, program.run(mu, found, tolerance, fading.max_iterations, left)
        if mu <= last or STATUS_MAP[found.native] is not Status.SOLVED or escaped(found.velocity):
            return found
        easy = found.iterations - before.iterations <= _EASY
        mu *= fading.reduction ** (2 if easy else 1)


class _Program:
    """The matrix is symmetric, so the columns of CasADi are these rows."""

    def __init__(self, energy: _Energy) -> None:
        self._energy, n = energy, energy.program.n
        load = ca.DM(energy.program.reference_load)
        full = energy.pattern()
        pattern = ca.Sparsity(n, n, full.indptr.tolist(), full.indices.tolist())
        upper = ca.triu(pattern)
        # Symmetric: what CasADi holds column by column are these rows.
        columns = np.repeat(np.arange(n), np.diff(full.indptr))
        self._upper, self._kept = upper, full.indices <= columns
        many, one = ca.Sparsity.dense(n, 1), ca.Sparsity.dense(1, 1)
        self._slope = _Callback("grad_f", [many, one], [one, many], self._value_and_gradient)
        self._curvature = _Callback("hess_lag", [many, one, one, one], [upper], self._hessian)
        u, mu = ca.MX.sym("u", n), ca.MX.sym("mu")
        power = ca.dot(load, u)
        self._problem = {"x": u, "p": mu, "f": self._slope(u, mu)[0], "g": power}
        self._constraint = ca.Function("jac_g", [u, mu], [power, load.T])

    def _value_and_gradient(self, u: Any, mu: Any) -> list[Any]:
        at = self._energy.at(np.array(u).ravel(), float(mu))
        return [at.value, at.gradient]

    def _hessian(self, u: Any, mu: Any, factor: Any, _: Any) -> list[Any]:
        entries = self._energy.hessian(np.array(u).ravel(), float(mu))
        return [ca.DM(self._upper, float(factor) * entries[self._kept])]

    def run(
        self, mu: float, start: _BarrierResult, tolerance: float, max_iterations: int, left: float
    ) -> _BarrierResult:
        """Return the minimum at mu from the velocity of another one, within `left` seconds."""
        settings: dict[str, Any] = {
            "grad_f": self._slope,
            "jac_g": self._constraint,
            "hess_lag": self._curvature,
            "no_nlp_grad": True,
            "print_time": False,
            "error_on_fail": False,
            "show_eval_warnings": False,  # warnings of a step that is too long
            "calc_lam_p": False,
            "calc_lam_x": False,
            "ipopt": {
                "print_level": 0,
                "sb": "yes",
                "tol": tolerance,
                "max_iter": max_iterations,
                "max_wall_time": left,
                "acceptable_iter": 0,
                "diverging_iterates_tol": _ESCAPED,
                "jac_c_constant": "yes",
                "nlp_scaling_method": "none",
                # The program is convex, so no residual needs a check.
                "fast_step_computation": "yes",
                "watchdog_shortened_iter_trigger": 0,
                "max_soc": 0,
                # Round-off of F0.U = 1 must not count as infeasibility: the filter would accept
                # steps that reduce it for any energy.
                "delta": 1e-40,
                "s_phi": 1.0001,
                "s_theta": 50.0,
            },
        }
        nlp = ca.nlpsol("smoothed", "ipopt", self._problem, settings)
        answer = nlp(x0=start.velocity, lam_g0=-start.multiplier, lbg=1.0, ubg=1.0, p=mu)
        stats = nlp.stats()
        return _BarrierResult(
            native=str(stats["return_status"]),
            iterations=start.iterations + int(stats["iter_count"]),
            mu=mu,
            velocity=np.array(answer["x"]).ravel(),
            multiplier=-float(answer["lam_g"]),
        )


class _Callback(ca.Callback):
    """CasADi function that NumPy evaluates."""

    def __init__(
        self, name: str, given: list[Any], found: list[Any], function: Callable[..., list[Any]]
    ) -> None:
        ca.Callback.__init__(self)
        self._given, self._found, self._function = given, found, function
        self.construct(name, {})

    def get_n_in(self) -> int:
        """Return the number of arguments."""
        return len(self._given)

    def get_n_out(self) -> int:
        """Return the number of results."""
        return len(self._found)

    def get_sparsity_in(self, place: int) -> Any:
        """Return the sparsity of an argument."""
        return self._given[place]

    def get_sparsity_out(self, place: int) -> Any:
        """Return the sparsity of a result."""
        return self._found[place]

    def eval(self, given: Any) -> list[Any]:
        """Return the results for arguments."""
        return self._function(*given)
