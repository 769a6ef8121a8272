"""Velocities for IPOPT where strength depends on pressure: a barrier that fades. Not a backend.

The program is that of `ipopt`, velocities alone with ``F0.U = 1``. At mu = 0 its gradient has kinks
wherever stresses meet corners of yield, and Newton's method goes from one to the next; what is
continued from large to small is therefore not r, but what keeps stresses off the edges
(`lacore_backends._barrier_laws`). Stresses and shares of the last step are those of the answer: in
balance, within yield, and apart from those of mu = 0 by a gap that is known.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from lacore.numerics.arrays import Bools, Floats, Sparse
from lacore.numerics.linear_algebra import Gram
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.regularization import Penalties, escaped, judged_status
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution
from lacore_backends._answers import told
from lacore_backends._barrier_laws import BarrierLaw, Smoothed
from lacore_backends._conic_laws import ConicLaws
from lacore_backends._ipopt import STATUS_MAP

_FIRST = 1.0  # mu, dimensionless: strengths and powers are about 1
_POWER = 0.05  # of the tolerance: the gap at the end, dimensionless power
_LOOSE = 10.0  # of mu: tolerance of the steps but the last, which are starts of the next
_LOOSEST = 1e-3
_EASY = 2  # iterations of a step after which the next one is a long one
_ESCAPED = 1e8  # velocity at which a step ends: no mechanism is as fast


@dataclass(frozen=True)
class Fading:
    """How far, in what steps, and how long.

    Attributes:
        reduction: ratio of mu between two steps.
        tolerance, max_iterations: IPOPT's, of the last step and of each.
        time_limit: s, all steps.
    """

    reduction: float
    tolerance: float
    max_iterations: int
    time_limit: float


class BarrierSolver:
    """IPOPT at work on one program whose strength depends on pressure."""

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
        """Nothing is held."""


@dataclass(frozen=True)
class _At:
    """The energy at a velocity and mu; the Hessian, not always asked for, by blocks."""

    value: float
    gradient: Floats
    laws: tuple[Smoothed, ...]


class _Energy:
    """The smoothed energy less the power of the dead load."""

    def __init__(self, program: KinematicProgram, laws: ConicLaws, gram: Gram) -> None:
        self.program, self._gram = program, gram
        self._laws = [BarrierLaw(law) for law in laws.each]
        self._held: tuple[bytes, float, _At] | None = None

    @property
    def volume(self) -> float:
        """The gap is mu times it."""
        return sum(law.volume for law in self._laws)

    def at(self, velocity: Floats, mu: float) -> _At:
        """IPOPT asks for value, gradient and Hessian one after the other: one is held."""
        key = velocity.tobytes()
        if self._held is None or self._held[:2] != (key, mu):
            found = tuple(law.at(velocity, mu) for law in self._laws)
            gradient = -self.program.dead_load
            for law, part in zip(self._laws, found, strict=True):
                gradient = gradient + law.law.force(part.stress)
            value = sum(part.energy for part in found)
            value -= float(self.program.dead_load @ velocity)
            if not all(part.sound for part in found):  # too far: IPOPT takes a shorter step
                value = float("nan")
            self._held = key, mu, _At(value, gradient, found)
        return self._held[2]

    def hessian(self, velocity: Floats, mu: float) -> Floats:
        """Its entries, in the order of `pattern`."""
        blocks = [part.stiffness for part in self.at(velocity, mu).laws]
        return np.asarray(self._gram.matrix(blocks).data)

    def pattern(self) -> Sparse:
        """Of the Hessian, the same at all velocities."""
        dims = [(law.law.weights.size, law.law.dim) for law in self._laws]
        return self._gram.matrix([np.zeros((m, dim, dim)) for m, dim in dims])


@dataclass(frozen=True)
class _BarrierResult:
    """Where the barrier has faded to; the multiplier is that of ``F0.U = 1``."""

    native: str
    iterations: int
    mu: float
    velocity: Floats
    multiplier: float


def _followed(energy: _Energy, fading: Fading, deadline: float) -> _BarrierResult:
    """One run of IPOPT for each mu, each from the velocity of the last."""
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
    """The nonlinear program of one contact, with mu as its parameter."""

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
        """The minimum at mu, from the velocity of another, within `left` seconds."""
        settings: dict[str, Any] = {
            "grad_f": self._slope,
            "jac_g": self._constraint,
            "hess_lag": self._curvature,
            "no_nlp_grad": True,
            "print_time": False,
            "error_on_fail": False,
            "show_eval_warnings": False,  # of a step too far
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
                "fast_step_computation": "yes",  # convex: no residual needs a second look
                "watchdog_shortened_iter_trigger": 0,
                "max_soc": 0,
                # Round-off of F0.U = 1 is no infeasibility: the filter would accept steps that
                # lessen it, whatever they do to the energy.
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
    """A function of CasADi that numpy evaluates."""

    def __init__(
        self, name: str, given: list[Any], found: list[Any], function: Callable[..., list[Any]]
    ) -> None:
        ca.Callback.__init__(self)
        self._given, self._found, self._function = given, found, function
        self.construct(name, {})

    def get_n_in(self) -> int:
        """How many arguments."""
        return len(self._given)

    def get_n_out(self) -> int:
        """How many results."""
        return len(self._found)

    def get_sparsity_in(self, place: int) -> Any:
        """Of an argument."""
        return self._given[place]

    def get_sparsity_out(self, place: int) -> Any:
        """Of a result."""
        return self._found[place]

    def eval(self, given: Any) -> list[Any]:
        """Results at arguments."""
        return self._function(*given)
