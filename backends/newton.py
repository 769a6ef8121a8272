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
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
import scipy
from scipy.sparse import csr_matrix

from lacore.arrays import Bools, Floats, Sparse
from lacore.backend import Capabilities, InnerSolution
from lacore.errors import require_count, require_positive
from lacore.linear_algebra import Gram, SingularError, SymmetricSolver, symmetric_solver
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
_FURTHER = 10.0  # factor of a step that is too short
_NARROW = 1e-2  # relative width of a bracket that is not worth another look
_MARGIN = 0.1  # share of a bracket that interpolation keeps away from its ends
_SHORTEST = 1e-8  # step at which the line search gives up
_ROUND_OFF = 1e-16  # of the largest curvature: its precision
_FLOOR = 1e-13  # of the largest curvature: the first shift above it
_STILL = 1e-12  # of the velocity: steps below it are round-off
_LONGEST = 10.0  # of the velocity: beyond it a step is an effect of too soft a matrix
_SHORT = 1e-2  # step below which the matrix is taken to be too soft
_STIFFEN = 100.0
_TINY = 1e-150  # keeps quotients of zeros finite
_NO_FORCE = 1e-9  # dimensionless
_REDUCTION = 0.1  # of r between the steps of a continuation
_STICK = 1e20  # a friction bound that nothing reaches

STATUS_MAP = {
    "converged": Status.SOLVED,
    "converged to round-off": Status.ALMOST_SOLVED,  # above the tolerance, but it does not move
    "iteration limit": Status.ITERATION_LIMIT,
    "time limit": Status.TIME_LIMIT,
    "line search failed": Status.STALLED,
    "singular matrix": Status.STALLED,
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
        return f"{symmetric_solver().name}, SciPy {scipy.__version__}"

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

    def curvature(self, velocity: Floats) -> Floats:
        """The primal-dual blocks ``W H`` of ``B^T W H B``, shape (m, dim, dim)."""
        v, length, top = self._lengths(velocity)
        flowing = length * self.stiffness > self.bound
        direction = np.where(flowing[:, None], v / np.maximum(length, _TINY)[:, None], 0.0)
        relative = self.stress / np.maximum(self.bound, _TINY)[:, None]
        outer = relative[:, :, None] * direction[:, None, :]
        blocks = np.eye(self.dim) - (outer + outer.transpose(0, 2, 1)) / 2
        return np.asarray(blocks * (self.weights * self.bound / top)[:, None, None])

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
    message: str = ""

    @property
    def stuck(self) -> bool:
        """Whether another way to the solution is worth a try."""
        return self.native in ("iteration limit", "line search failed", "singular matrix")


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
        self._shape: _Shape | None = None
        self._solver = symmetric_solver()
        self._velocity: Floats | None = None

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve; from the last velocity when only friction bounds have changed since."""
        begin = time.perf_counter()
        deadline = begin + self._options.time_limit
        plain = contact.dilatancy <= 0
        if self._shape is None or not np.array_equal(plain, self._shape.plain):
            self._shape, self._velocity = _shape(self._program, plain), None
        start = self._velocity
        answer = self._iterate(contact, self._target, start, deadline)
        iterations = answer.iterations
        if answer.stuck:
            # Uniform flow under dilatancy: no curvature anywhere but in what still sticks.
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
    ) -> _Answer:
        assert self._shape is not None
        system = _System(self._program, contact, penalty, self._shape, self._solver)
        laws = _laws(self._program, contact, penalty, self._shape)
        load = self._program.reference_load
        weight = float(np.abs(self._program.dead_load).sum())
        try:
            u = system.at_rest() if start is None else start
        except SingularError as error:
            nowhere = np.zeros(self._program.n)
            return _Answer("singular matrix", 0, nowhere, float("nan"), str(error))
        for law in laws:
            law.step(u, 0 * u, 1.0)
        point = system.at(u)
        multiplier = float("nan")
        for iteration in range(1, self._options.max_iterations + 1):
            try:
                multiplier, change = system.direction(laws, u, point.gradient)
            except SingularError as error:
                return _Answer("singular matrix", iteration, u, multiplier, str(error))
            balance = point.values.load_factor  # what the certificate will measure with
            forces = abs(balance) * float(np.abs(load).sum()) + weight
            out_of_balance = float(np.abs(point.gradient - balance * load).max())
            if out_of_balance <= self._options.tolerance * forces or _at_rest(point):
                return _Answer("converged", iteration, u, multiplier)
            if np.abs(change).max() > _LONGEST * np.abs(u).max() and system.stiffen():
                continue
            share, new = _line_search(system, u, change, point, multiplier)
            if share < _SHORT and system.stiffen():
                continue
            if share < _SHORTEST:
                return _Answer("line search failed", iteration, u, multiplier)
            if share > 0.5:
                system.soften()
            for law in laws:
                law.step(u, change, share)
            u, point = u + share * change, new
            if escaped(u):
                return _Answer("diverged", iteration, u, multiplier)
            if np.abs(change).max() <= _STILL * np.abs(u).max():
                return _Answer("converged to round-off", iteration, u, multiplier)
            if time.perf_counter() > deadline:
                return _Answer("time limit", iteration, u, multiplier)
        return _Answer("iteration limit", self._options.max_iterations, u, multiplier)


@dataclass(frozen=True)
class _Shape:
    """Everything that neither bounds nor penalties change.

    Attributes:
        plain: contact points without dilatancy, shape (m,).
        rows, dims: of the Huber terms: a group each, then the plain contact points.
        gram: curvature of the Huber terms, of theta in each group, and of the contact points.
    """

    plain: Bools
    rows: tuple[Sparse, ...]
    dims: tuple[int, ...]
    gram: Gram


def _shape(program: KinematicProgram, plain: Bools) -> _Shape:
    points, groups = program.contact, program.groups
    rows = [
        interleaved(group.rows, group.dim, group.volumetric * group.volumetric_factor, 1)
        for group in groups
    ]
    rows.append(csr_matrix(points.tangential[np.repeat(plain, points.tangent_dim)]))
    dims = [group.dim + 1 for group in groups] + [points.tangent_dim]
    local = interleaved(points.normal, 1, points.tangential, points.tangent_dim)
    volumes = [group.volumetric for group in groups]
    gram = Gram([*rows, *volumes, local], [*dims, *[1] * len(groups), 1 + points.tangent_dim])
    return _Shape(plain, tuple(rows), tuple(dims), gram)


@dataclass
class _System:
    """The regularised energy of one frozen contact, and Newton steps towards its minimum.

    `shift` times the largest curvature is added to all of it where steps with the plain matrix
    turn out short: where whole regions flow uniformly, or a body lifts, there are motions without
    curvature. Elsewhere it would slow the end of the iteration to a crawl.
    """

    program: KinematicProgram
    contact: FrozenContact
    penalty: Penalties
    shape: _Shape
    solver: SymmetricSolver
    shift: float = _ROUND_OFF
    stiffest: float = field(init=False)
    _closed: Sparse = field(init=False)

    def __post_init__(self) -> None:
        """Measure the curvature of the body at rest, every contact closed."""
        contact = self.program.contact
        dims = [*self.shape.dims, *[1] * len(self.program.groups), 1 + contact.tangent_dim]
        weights = [group.weights for group in self.program.groups]
        scaled = [
            *[self.penalty.eta * w for w in weights],
            self.penalty.tangential * contact.weights[self.shape.plain],
            *[self.penalty.bulk * w for w in weights],
            max(self.penalty.normal, self.penalty.tangential) * contact.weights,
        ]
        blocks = [w[:, None, None] * np.eye(dim) for w, dim in zip(scaled, dims, strict=True)]
        self._closed = self.shape.gram.matrix(blocks)
        self.stiffest = float(self._closed.diagonal().max())

    def at_rest(self) -> Floats:
        """The viscous velocity: nothing yields, every contact is closed."""
        return self._minimum(self._closed, np.zeros(self.program.n), -self.program.dead_load)[1]

    def at(self, velocity: Floats) -> RegularisedPoint:
        """Value and gradient."""
        return evaluate(self.program, self.contact, self.penalty, velocity)

    def stiffen(self) -> bool:
        """Raise the shift; whether there was room."""
        self.shift = max(self.shift * _STIFFEN, _FLOOR)
        return self.shift < 1

    def soften(self) -> None:
        """Lower the shift."""
        self.shift = self.shift / 10 if self.shift > _FLOOR else _ROUND_OFF

    def direction(self, laws: list[_Huber], u: Floats, gradient: Floats) -> tuple[float, Floats]:
        """Multiplier of ``F0.U = 1`` and Newton step to the linearised minimum."""
        matrix = self.shape.gram.matrix(
            [
                *[law.curvature(u) for law in laws],
                *[self.penalty.bulk * group.weights for group in self.program.groups],
                _contact_curvature(self.program, self.contact, self.penalty, u),
            ]
        )
        return self._minimum(matrix, u, gradient)

    def _minimum(self, matrix: Sparse, u: Floats, gradient: Floats) -> tuple[float, Floats]:
        plain = matrix.diagonal()
        while True:
            try:
                matrix.setdiag(plain + self.shift * self.stiffest)
                self.solver.factorise(matrix)
                break
            except SingularError:
                if not self.stiffen():
                    raise
        load = self.program.reference_load
        # From P + 2 C on: what is solved for is small, and so is its round-off.
        guess = float(gradient @ u)
        by_load = self.solver.solve(load)
        by_rest = self.solver.solve(guess * load - gradient)
        more = float((1 - load @ u - load @ by_rest) / (load @ by_load))
        change = by_rest + more * by_load
        # Along the mechanism itself there is next to no curvature: round-off of both terms, which
        # must not undo F0.U = 1.
        change += (1 - load @ (u + change)) / float(load @ load) * load
        return guess + more, change


def _line_search(
    system: _System, u: Floats, change: Floats, point: RegularisedPoint, multiplier: float
) -> tuple[float, RegularisedPoint]:
    """Step at which the convex energy has lost most of its slope along `change`.

    Slopes instead of values, and without the load, which does no power on `change`: near the
    solution all else is round-off.
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
        if long[0] == np.inf:  # the energy still falls as steeply: a long way, or no end at all
            share *= _FURTHER
        else:
            part = short[1] / (short[1] - long[1])
            share = short[0] + width * min(max(part, _MARGIN), 1 - _MARGIN)


def _laws(
    program: KinematicProgram, contact: FrozenContact, penalty: Penalties, shape: _Shape
) -> list[_Huber]:
    """Huber terms of all groups and of the plain contact points, unstressed."""
    terms = [(group.weights, group.bound, penalty.eta) for group in program.groups]
    held = np.minimum(contact.bound[shape.plain], _STICK)
    terms.append((program.contact.weights[shape.plain], held, penalty.tangential))
    return [
        _Huber(rows, dim, weights, bound, stiffness, np.zeros((weights.size, dim)))
        for rows, dim, (weights, bound, stiffness) in zip(
            shape.rows, shape.dims, terms, strict=True
        )
    ]


def _contact_curvature(
    program: KinematicProgram, contact: FrozenContact, penalty: Penalties, u: Floats
) -> Floats:
    """Blocks of the normal penalty's second derivative, and of the dilatant law's (T18)."""
    rows = program.contact
    dim = rows.tangent_dim
    slip, opening = rows.slip(u), rows.opening(u) + contact.shift
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
    return np.asarray(blocks * rows.weights[:, None, None])
