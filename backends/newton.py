"""Primal-dual Newton on the regularised program (T17-T21), from a cold start, sparse.

The Huber law ``s = bound v / max(||v||, bound/stiffness)`` is linearised in the form
``max(||v||, bound/stiffness) s = bound v`` with the stress s as an unknown of its own (Chan, Golub
& Mulet 1999; Andersen et al. 2000). Eliminating it point by point leaves
``B^T W (bound I - sym(s v^T/||v||)) B / max(...)``: as sparse as the exact Hessian, and positive
semidefinite as long as ``||s|| <= bound``, without the exact one's singular direction far from the
solution. No continuation in r is needed.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import scipy
from scipy.sparse import bsr_array, csc_array, csr_array, csr_matrix, diags_array
from scipy.sparse.linalg import splu

from lacore.arrays import Floats, Sparse
from lacore.backend import Capabilities, InnerSolution
from lacore.errors import require_count, require_positive
from lacore.program import FrozenContact, KinematicProgram, interleaved
from lacore.regularization import (
    Penalties,
    RegularisedPoint,
    escaped,
    evaluate,
    judged_status,
    penalties,
)
from lacore.status import Status

_SLOPE = 0.5  # share of the slope that a step may leave
_NOISE = 1e-14  # of the power of the load: slopes below it are round-off
_SHORTEST = 1e-8  # step at which the line search gives up
_FLOOR = 1e-13  # of the largest curvature
_SHORT = 1e-2  # step below which the matrix is taken to be too soft
_STIFFEN = 100.0
_TINY = 1e-150  # keeps quotients of zeros finite
_NO_FORCE = 1e-9  # dimensionless
_REDUCTION = 0.1  # of r between the steps of a continuation
_STICK = 1e20  # a friction bound that nothing reaches

STATUS_MAP = {
    "converged": Status.SOLVED,
    "iteration limit": Status.ITERATION_LIMIT,
    "time limit": Status.TIME_LIMIT,
    "line search failed": Status.STALLED,
    "diverged": Status.FAILED,  # or what `judged_status` makes of it
}


@dataclass(frozen=True)
class NewtonOptions:
    """Options of the `newton` backend.

    Attributes:
        r: dimensionless regularisation (T20).
        eta, bulk: instead of r: viscosity and bulk penalty, Pa s.
        normal, tangential: instead of r: contact penalties, Pa/(m/s).
        tolerance: largest nodal force out of balance, per total load.
        max_iterations: Newton steps.
        time_limit: s, one inner solve.
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
        require_count("newton.max_iterations", self.max_iterations)
        for name in ("tolerance", "time_limit"):
            require_positive(f"newton.{name}", getattr(self, name))


class Newton:
    """The fastest of the regularised backends: one sparse factorisation an iteration."""

    name: ClassVar[str] = "newton"
    title: ClassVar[str] = "Primal-dual Newton, regularised program, sparse direct solver"
    source: ClassVar[str] = "Chan, Golub & Mulet, SIAM J. Sci. Comput. 20, 1999"
    capabilities: ClassVar[Capabilities] = Capabilities(regularised=True, warm_start=True)
    statuses: ClassVar[Mapping[Any, Status]] = STATUS_MAP
    Options: ClassVar[type] = NewtonOptions

    def unavailable(self) -> str:
        """Always there: scipy is a dependency."""
        return ""

    def version(self) -> str:
        """The solver and its version."""
        return f"SuperLU, SciPy {scipy.__version__}"

    def prepare(self, program: KinematicProgram, options: NewtonOptions) -> "NewtonSolver":
        """Penalties and the rows of all laws, shared by all frozen contacts."""
        return NewtonSolver(program, options)


@dataclass
class _Huber:
    """One kind of Huber terms ``sum_g weight_g huber(||v_g||)``, ``v = rows U`` by point.

    `stress` is the dual variable, ``||stress|| <= bound``, shape (m, dim).
    """

    rows: Sparse
    dim: int
    weights: Floats
    bound: Floats
    stiffness: float
    stress: Floats

    def curvature(self, velocity: Floats) -> Sparse:
        """``B^T W H B`` with the primal-dual blocks H."""
        v, length, top = self._lengths(velocity)
        flowing = length * self.stiffness > self.bound
        direction = np.where(flowing[:, None], v / np.maximum(length, _TINY)[:, None], 0.0)
        relative = self.stress / np.maximum(self.bound, _TINY)[:, None]
        outer = relative[:, :, None] * direction[:, None, :]
        blocks = np.eye(self.dim) - (outer + outer.transpose(0, 2, 1)) / 2
        return _gram(self.rows, blocks * (self.weights * self.bound / top)[:, None, None])

    def step(self, velocity: Floats, change: Floats, share: float) -> None:
        """Move the stress by a share of its own Newton step, back into its bound."""
        v, length, top = self._lengths(velocity)
        dv = np.asarray(self.rows @ change).reshape(-1, self.dim)
        flowing = length * self.stiffness > self.bound
        along = np.sum(v * dv, axis=1) / np.maximum(length, _TINY) * flowing
        target = (self.bound[:, None] * (v + dv) - along[:, None] * self.stress) / top[:, None]
        moved = self.stress + share * (target - self.stress)
        size = np.linalg.norm(moved, axis=1)
        self.stress = moved * np.minimum(1.0, self.bound / np.maximum(size, _TINY))[:, None]

    def _lengths(self, velocity: Floats) -> tuple[Floats, Floats, Floats]:
        v = np.asarray(self.rows @ velocity).reshape(-1, self.dim)
        length = np.linalg.norm(v, axis=1)
        return v, length, np.maximum(np.maximum(length, self.bound / self.stiffness), _TINY)


@dataclass(frozen=True)
class _Answer:
    """Where the iteration ended; the multiplier is that of ``F0.U = 1``."""

    native: str
    iterations: int
    velocity: Floats
    multiplier: float

    @property
    def stuck(self) -> bool:
        """Whether another way to the solution is worth a try."""
        return self.native in ("iteration limit", "line search failed")


def _at_rest(point: RegularisedPoint) -> bool:
    """Whether nothing resists the motion: then no force is there to measure round-off by."""
    return point.values.energy <= _NO_FORCE**2 and np.abs(point.gradient).max() <= _NO_FORCE


class NewtonSolver:
    """Newton at work on one program."""

    def __init__(self, program: KinematicProgram, options: NewtonOptions) -> None:
        self._program, self._options = program, options
        self._target = penalties(
            program.scales, options.r, options.eta, options.bulk, options.normal, options.tangential
        )
        self._volume = csr_matrix((program.n, program.n))
        for group in program.groups:
            self._volume = self._volume + _gram(group.volumetric, group.weights[:, None, None])
        self._velocity: Floats | None = None
        self._dilatancy: Floats | None = None

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve; from the last velocity when only friction bounds have changed since."""
        begin = time.perf_counter()
        deadline = begin + self._options.time_limit
        before = self._dilatancy
        warm = before is not None and np.array_equal(before, contact.dilatancy)
        start = self._velocity if warm else None
        answer = self._iterate(contact, self._target, start, deadline)
        iterations = answer.iterations
        if answer.stuck:
            # Uniform flow under dilatancy: no curvature anywhere but in what still sticks.
            start = None
            for penalty in self._target.continuation(_REDUCTION):
                answer = self._iterate(contact, penalty, start, deadline)
                iterations += answer.iterations
                start = answer.velocity
        self._velocity, self._dilatancy = answer.velocity, contact.dilatancy
        point = evaluate(self._program, contact, self._target, answer.velocity, answer.multiplier)
        status = judged_status(STATUS_MAP[answer.native], self._program, point)
        return InnerSolution(
            status=status,
            native_status=answer.native,
            iterations=iterations,
            solve_time=time.perf_counter() - begin,
            point=point.state if status.has_point else None,
            regularised=point.values,
        )

    def close(self) -> None:
        """Nothing is held."""

    def _iterate(
        self, contact: FrozenContact, penalty: Penalties, start: Floats | None, deadline: float
    ) -> _Answer:
        energy = _Energy(self._program, contact, penalty, self._volume * penalty.bulk)
        laws = _laws(self._program, contact, penalty)
        load = self._program.reference_load
        weight = float(np.abs(self._program.dead_load).sum())
        u = np.zeros(self._program.n) if start is None else start
        if start is None:  # the viscous solution: nothing yields, every contact closed
            _, u = _direction(energy, laws, u, -self._program.dead_load, _FLOOR)
        for law in laws:
            law.step(u, 0 * u, 1.0)
        point, shift = energy.at(u), _FLOOR
        for iteration in range(1, self._options.max_iterations + 1):
            multiplier, change = _direction(energy, laws, u, point.gradient, shift)
            balance = point.values.load_factor  # what the certificate will measure with
            forces = abs(balance) * float(np.abs(load).sum()) + weight
            out_of_balance = float(np.abs(point.gradient - balance * load).max())
            if out_of_balance <= self._options.tolerance * forces or _at_rest(point):
                return _Answer("converged", iteration, u, multiplier)
            share, new = _line_search(energy, u, change, point, multiplier)
            if share < _SHORT and shift < 1:
                shift *= _STIFFEN
                continue
            if share < _SHORTEST:
                return _Answer("line search failed", iteration, u, multiplier)
            if share > 0.5:
                shift = max(shift / 10, _FLOOR)
            for law in laws:
                law.step(u, change, share)
            u, point = u + share * change, new
            if escaped(u):
                return _Answer("diverged", iteration, u, multiplier)
            if time.perf_counter() > deadline:
                return _Answer("time limit", iteration, u, multiplier)
        return _Answer("iteration limit", self._options.max_iterations, u, multiplier)


@dataclass(frozen=True)
class _Energy:
    """The regularised energy of one frozen contact; `volume` is its curvature in theta."""

    program: KinematicProgram
    contact: FrozenContact
    penalty: Penalties
    volume: Sparse

    def at(self, velocity: Floats) -> RegularisedPoint:
        """Value and gradient."""
        return evaluate(self.program, self.contact, self.penalty, velocity)


def _direction(
    energy: _Energy, laws: list[_Huber], u: Floats, gradient: Floats, shift: float
) -> tuple[float, Floats]:
    """Multiplier of ``F0.U = 1`` and Newton step to the linearised minimum.

    `shift` times the largest curvature is added to all: where whole regions flow uniformly, or a
    body lifts, motions without curvature make the plain step meaningless.
    """
    matrix = energy.volume + _contact_curvature(energy.program, energy.contact, energy.penalty, u)
    for law in laws:
        matrix = matrix + law.curvature(u)
    floor = shift * matrix.diagonal().max()
    factor = splu(
        csc_array(matrix + diags_array(np.full(u.size, floor))),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    load = energy.program.reference_load
    # From P + 2 C on: what is solved for is small, and so is its round-off.
    guess = float(gradient @ u)
    by_load, by_rest = factor.solve(load), factor.solve(guess * load - gradient)
    more = float((1 - load @ u - load @ by_rest) / (load @ by_load))
    return guess + more, by_rest + more * by_load


def _line_search(
    energy: _Energy, u: Floats, change: Floats, point: RegularisedPoint, multiplier: float
) -> tuple[float, RegularisedPoint]:
    """Step at which the convex energy has lost most of its slope along `change`.

    Slopes instead of values, and without the load, which does no power on `change`: near the
    solution all else is round-off.
    """
    load = multiplier * energy.program.reference_load
    first, share, longest = abs(float((point.gradient - load) @ change)), 1.0, np.inf
    while True:
        new = energy.at(u + share * change)
        slope = float((new.gradient - load) @ change)
        enough = _SLOPE * first + _NOISE * abs(multiplier)
        if abs(slope) <= enough or share < _SHORTEST or escaped(new.state.velocity):
            return share, new
        if slope > 0:
            longest = share
            share *= min(max(first / (first + slope), 0.1), 0.5)
        elif longest < np.inf:
            return share, new
        else:  # the energy still falls as steeply: a long way, or no end at all
            share *= 10


def _laws(program: KinematicProgram, contact: FrozenContact, penalty: Penalties) -> list[_Huber]:
    """Huber terms of all groups and of the contact points that are not dilatant, unstressed."""
    laws = []
    for group in program.groups:
        rows = interleaved(group.rows, group.dim, group.volumetric * group.volumetric_factor, 1)
        stress = np.zeros((group.weights.size, group.dim + 1))
        laws.append(_Huber(rows, group.dim + 1, group.weights, group.bound, penalty.eta, stress))
    points, plain = program.contact, contact.dilatancy <= 0
    if plain.any():
        dim = points.tangent_dim
        laws.append(
            _Huber(
                csr_matrix(points.tangential[np.repeat(plain, dim)]),
                dim,
                points.weights[plain],
                np.minimum(contact.bound[plain], _STICK),
                penalty.tangential,
                np.zeros((int(plain.sum()), dim)),
            )
        )
    return laws


def _contact_curvature(
    program: KinematicProgram, contact: FrozenContact, penalty: Penalties, u: Floats
) -> Sparse:
    """Second derivative of the normal penalty, and of the dilatant law (T18)."""
    rows = program.contact
    dim = rows.tangent_dim
    slip, opening = rows.slip(u), rows.opening(u)
    rate = np.linalg.norm(slip, axis=1)
    closed, d = opening <= 0, contact.dilatancy
    dilatant = d > 0
    blocks = np.zeros((rows.count, 1 + dim, 1 + dim))
    blocks[:, 0, 0] = penalty.normal * closed
    pressed = penalty.normal * np.maximum(-opening, 0.0)
    sliding = dilatant & (penalty.tangential * rate > d * pressed)
    sticking = dilatant & ~sliding & closed
    blocks[sticking, 1:, 1:] = penalty.tangential * np.eye(dim)
    pushed = np.maximum(d * rate - opening, 0.0)
    direction = np.concatenate(
        [-np.ones((rows.count, 1)), d[:, None] * slip / np.maximum(rate, _TINY)[:, None]], axis=1
    )
    compliance = 1 / penalty.normal + d**2 / penalty.tangential
    outer = direction[:, :, None] * direction[:, None, :]
    across = np.eye(dim) - outer[:, 1:, 1:] / np.maximum(d**2, _TINY)[:, None, None]
    rotation = (pushed * d / np.maximum(rate, _TINY))[:, None, None] * across
    outer[:, 1:, 1:] += rotation
    active = sliding & (pushed > 0)
    blocks[sliding] = 0.0
    blocks[active] = (outer / compliance[:, None, None])[active]
    local = interleaved(rows.normal, 1, rows.tangential, dim)
    return _gram(local, blocks * rows.weights[:, None, None])


def _gram(rows: Sparse, blocks: Floats) -> Sparse:
    """``rows^T blockdiag(blocks) rows`` for blocks of shape (m, dim, dim)."""
    count = blocks.shape[0]
    if count == 0:
        return csr_matrix((rows.shape[1], rows.shape[1]))
    diagonal = bsr_array((blocks, np.arange(count), np.arange(count + 1)))
    return csr_matrix(rows.T @ csr_array(diagonal @ rows))
