"""Linearised system of `newton`: curvature of the regularised energy, and Newton steps.

The Huber law ``s = bound v / max(||v||, bound/stiffness)`` is linearised in the form ``max(||v||,
bound/stiffness) s = bound v`` with the stress s as a separate unknown (Chan, Golub & Mulet 1999;
Andersen et al. 2000). Eliminating it point by point gives ``B^T W (bound I - sym(s v^T/||v||)) B /
max(...)``, which is as sparse as the exact Hessian, and positive semidefinite as long as ``||s|| <=
bound``. A law with hardening is a Huber law plus a linear spring (T17), whose stress is not an
unknown.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_matrix

from lacore.numerics.arrays import Bools, Floats, Sparse
from lacore.numerics.linear_algebra import Gram, SingularError, SymmetricSolver
from lacore.program import FrozenContact, KinematicProgram, interleaved
from lacore.program.regularization import Beside, Penalties, RegularisedPoint, beside, evaluate

_ROUND_OFF = 1e-16  # round-off of the curvature, by the largest
_FLOOR = 1e-13  # first shift above it, by the largest curvature
_STIFFEN = 100.0
_TINY = 1e-150  # It keeps quotients of zeros finite.
_STICK = 1e20  # a friction bound that is never reached


@dataclass
class Huber:
    """One kind of Huber terms ``sum_g weight_g huber(||v_g||)``, ``v = rows U`` by point.

    Each term includes a spring, ``weight_g spring_g ||v_g||^2/2``. `stress` is the dual variable of
    the Huber term alone, ``||stress|| <= bound``, shape (m, dim).
    """

    rows: Sparse
    dim: int
    weights: Floats
    law: Beside
    stress: Floats

    def curvature(self, velocity: Floats) -> Floats:
        """Return the primal-dual blocks ``W H`` of ``B^T W H B``, shape (m, dim, dim)."""
        v, length, top = self._lengths(velocity)
        bound, spring = self.law.bound, self.law.spring
        direction = np.where(
            self._flowing(length)[:, None], v / np.maximum(length, _TINY)[:, None], 0.0
        )
        relative = self.stress / np.maximum(bound, _TINY)[:, None]
        outer = relative[:, :, None] * direction[:, None, :]
        blocks = np.eye(self.dim) - (outer + outer.transpose(0, 2, 1)) / 2
        blocks *= (self.weights * bound / top)[:, None, None]
        return np.asarray(blocks + (self.weights * spring)[:, None, None] * np.eye(self.dim))

    def step(self, velocity: Floats, change: Floats, share: float) -> None:
        """Move the stress by a share of its Newton step, and back into its bound."""
        v, length, top = self._lengths(velocity)
        bound = self.law.bound
        dv = np.asarray(self.rows @ change).reshape(-1, self.dim)
        along = np.sum(v * dv, axis=1) / np.maximum(length, _TINY) * self._flowing(length)
        target = (bound[:, None] * (v + dv) - along[:, None] * self.stress) / top[:, None]
        moved = self.stress + share * (target - self.stress)
        size = np.linalg.norm(moved, axis=1)
        self.stress = moved * np.minimum(1.0, bound / np.maximum(size, _TINY))[:, None]

    def _flowing(self, length: Floats) -> Bools:
        return np.asarray(length * self.law.stiffness > self.law.bound)

    def _lengths(self, velocity: Floats) -> tuple[Floats, Floats, Floats]:
        v = np.asarray(self.rows @ velocity).reshape(-1, self.dim)
        length = np.linalg.norm(v, axis=1)
        threshold = self.law.bound / self.law.stiffness
        return v, length, np.maximum(np.maximum(length, threshold), _TINY)


@dataclass(frozen=True)
class Shape:
    """Parts of the system that depend neither on bounds nor on penalties.

    Attributes:
        plain: whether contact points have no dilatancy, or also a bound on friction, shape (m,).
        rows, dims: rows of the Huber terms: one entry per group, then these contact points.
        gram: curvature of the Huber terms, of theta in each group, and of the contact points.
    """

    plain: Bools
    rows: tuple[Sparse, ...]
    dims: tuple[int, ...]
    gram: Gram


def shape_of(program: KinematicProgram, plain: Bools) -> Shape:
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
    return Shape(plain, tuple(rows), tuple(dims), gram)


@dataclass
class System:
    """Regularised energy of one frozen contact, and Newton steps towards its minimum.

    `shift` times the largest curvature is added to all of it where steps with the plain matrix are
    too short: where whole regions flow uniformly, or a body lifts, there are motions without
    curvature. Elsewhere the shift would slow down the end of the iteration.
    """

    program: KinematicProgram
    contact: FrozenContact
    penalty: Penalties
    shape: Shape
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
        """Return the viscous velocity: nothing yields, and every contact is closed."""
        return self._minimum(self._closed, np.zeros(self.program.n), -self.program.dead_load)[1]

    def at(self, velocity: Floats) -> RegularisedPoint:
        """Return value and gradient."""
        return evaluate(self.program, self.contact, self.penalty, velocity)

    def stiffen(self) -> bool:
        """Raise the shift; return whether it is still below its limit."""
        self.shift = max(self.shift * _STIFFEN, _FLOOR)
        return self.shift < 1

    def soften(self) -> None:
        """Lower the shift."""
        self.shift = self.shift / 10 if self.shift > _FLOOR else _ROUND_OFF

    def direction(self, laws: list[Huber], u: Floats, gradient: Floats) -> tuple[float, Floats]:
        """Return the multiplier of ``F0.U = 1`` and the Newton step to the linearised minimum."""
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
        # Iterate from P + 2 C on, so that the unknown and its round-off are small.
        guess = float(gradient @ u)
        by_load = self.solver.solve(load)
        by_rest = self.solver.solve(guess * load - gradient)
        more = float((1 - load @ u - load @ by_rest) / (load @ by_load))
        change = by_rest + more * by_load
        # Along the mechanism there is almost no curvature, and the round-off of both terms must not
        # violate F0.U = 1.
        change += (1 - load @ (u + change)) / float(load @ load) * load
        return guess + more, change


def laws_of(
    program: KinematicProgram, contact: FrozenContact, penalty: Penalties, shape: Shape
) -> list[Huber]:
    """Return the Huber terms of all groups and of the plain contact points, unstressed."""
    eta, tangential = penalty.eta, penalty.tangential
    terms = [(g.weights, beside(eta, g.bound, g.rise)) for g in program.groups]
    held = np.minimum(contact.bound[shape.plain], _STICK)
    weights = program.contact.weights[shape.plain]
    terms.append((weights, beside(tangential, held, np.zeros(held.size))))
    return [
        Huber(rows, dim, weights, law, np.zeros((weights.size, dim)))
        for rows, dim, (weights, law) in zip(shape.rows, shape.dims, terms, strict=True)
    ]


def _contact_curvature(
    program: KinematicProgram, contact: FrozenContact, penalty: Penalties, u: Floats
) -> Floats:
    """Return the second derivatives of the normal penalty and the dilatant law (T18)."""
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
