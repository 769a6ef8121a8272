"""The Coulomb problem of rigid blocks, as one mixed complementarity problem on cones (T2, T8, T79).

Unknown are forces p = w t_n and q = w t_t of the contact points, speeds s of opening, bounds r of
slip and slip rates v, velocities u and the load factor. With x = (mu p + c, q) and y = (r, v) in
second-order cones, half-lines and wedges in the plane, they obey

    N'p + T'q + Fd + alpha F0 = 0,   F0.u = 1,   N u = s,   T u = v,
    s p = 0,   x o y = (x.y, x_0 v + r q) = 0.

So r = ||v|| where something slips, and q points against it. The problem is not monotone: unlike
those of the frozen problems its matrix is not symmetric, and interior points of it may have to turn
round (`lacore.coupling.blocks.central_path`).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_matrix

from lacore.coupling.blocks.matrix import Factor, Pattern
from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.numerics.curve import Change
from lacore.numerics.linear_algebra import SingularError
from lacore.program.kinematic import KinematicProgram
from lacore.program.state import ProgramState
from lacore.reporting.showing import Compact

_HALVINGS = 40  # leave a friction within 1e-12 of its bound

Cone = tuple[Floats, Floats]
"""Vectors of second-order cones: first components (k,), and the others, (k, d)."""


@dataclass(frozen=True, repr=False)
class Complementarity(Compact):
    """The problem as functions of one vector z = (p, q, s, r, v, u, alpha).

    Attributes:
        program: one that `poses` says yes to.
    """

    program: KinematicProgram

    @cached_property
    def rough(self) -> Ints:
        """Points with friction, k of all m: q, r and v are theirs alone."""
        return _rough(self.program)

    @cached_property
    def tangential(self) -> Sparse:
        """Rows of slip of rough points, shape (k d, n)."""
        d = self.program.contact.tangent_dim
        every = (self.rough[:, None] * d + np.arange(d)).ravel()
        return csr_matrix(csr_matrix(self.program.contact.tangential)[every])

    @cached_property
    def normal(self) -> Sparse:
        """Rows of opening, shape (m, n)."""
        return csr_matrix(self.program.contact.normal)

    @cached_property
    def transposed(self) -> tuple[Sparse, Sparse]:
        """Of both rows."""
        return csr_matrix(self.normal.T), csr_matrix(self.tangential.T)

    @cached_property
    def coefficient(self) -> Floats:
        """Of friction, of rough points."""
        return self.program.contact.coefficient[self.rough]

    @cached_property
    def cohesion(self) -> Floats:
        """Of rough points, as a force: c."""
        rows = self.program.contact
        return (rows.weights * rows.limit)[self.rough]

    @cached_property
    def pattern(self) -> Pattern:
        """Of the matrix on velocities."""
        rows = self.program.contact
        return Pattern.of(self.normal, self.tangential, self.rough, rows.tangent_dim)

    def parts(self, z: Floats) -> list[Floats]:
        """p, q (k, d), s, r, v (k, d), u and alpha, the last of shape (1,)."""
        m, k, d = self.program.contact.count, self.rough.size, self.program.contact.tangent_dim
        found = np.split(z, np.cumsum([m, k * d, m, k, k * d, self.program.n]))
        found[1], found[4] = found[1].reshape(k, d), found[4].reshape(k, d)
        return found

    def cones(self, z: Floats) -> tuple[Cone, Cone]:
        """Both vectors of rough points, x and y."""
        p, q, _, r, v, _, _ = self.parts(z)
        return (self.coefficient * p[self.rough] + self.cohesion, q), (r, v)

    def rates(self, dz: Floats) -> tuple[Cone, Cone]:
        """How x and y change."""
        p, q, _, r, v, _, _ = self.parts(dz)
        return (self.coefficient * p[self.rough], q), (r, v)

    def equations(self, z: Floats) -> Floats:
        """The linear equations but for their constants."""
        p, q, s, _, v, u, alpha = self.parts(z)
        load, (normal, tangential) = self.program.reference_load, self.transposed
        return np.concatenate(
            [
                normal @ p + tangential @ q.ravel() + alpha * load,
                [load @ u],
                self.normal @ u - s,
                self.tangential @ u - v.ravel(),
            ]
        )

    def products(self, z: Floats) -> tuple[Floats, Cone]:
        """Powers s p, and x o y: their sum is the gap where all linear equations hold."""
        p, _, s, *_ = self.parts(z)
        (x, q), (r, v) = self.cones(z)
        return s * p, (x * r + _dots(q, v), x[:, None] * v + r[:, None] * q)

    def power(self, z: Floats) -> float:
        """Sum of all products, of the power of the load."""
        pressed, (slipping, _) = self.products(z)
        return float(pressed.sum() + slipping.sum()) / abs(float(z[-1]))

    def residual(self, z: Floats) -> Floats:
        """All equations, those of `products` last."""
        linear, (pressed, (along, across)) = self.equations(z), self.products(z)
        linear[: self.program.n] += self.program.dead_load
        linear[self.program.n] -= 1.0
        return np.concatenate([linear, pressed, along, across.ravel()])

    def off(self, z: Floats, aim: Floats) -> float:
        """Largest share by which a product is off what `residual` should be; inf outside."""
        if not (np.isfinite(z).all() and self._inside(z)):
            return float("inf")
        m, k, d = self.program.contact.count, self.rough.size, self.program.contact.tangent_dim
        pressed, (along, across) = self.products(z)
        powers, slips, _ = np.split(aim[-(m + k + k * d) :], [m, m + k])
        off = np.abs(along - slips) + np.linalg.norm(across, axis=1)
        return float(max(np.abs(pressed / powers - 1).max(), (off / slips).max(initial=0.0)))

    def changes(self, z: Floats, dz: Floats) -> Change:
        """Relative changes of what has to stay positive, and of x and y in their cones.

        In the frame of a vector of a cone: of both of its spectral values, and across them, as its
        quadratic representation scales them (Alizadeh & Goldfarb 2003).
        """
        (p, _, s, *_), (dp, _, ds, *_) = self.parts(z), self.parts(dz)
        own = [dp / p, ds / s]
        least, most = list(own), list(own)
        for (x, q), (dx, dq) in zip(self.cones(z), self.rates(dz), strict=True):
            length, ahead = _directed(q)
            along, high, low = _dots(ahead, dq), x + length, x - length
            rises, falls = (dx + along) / high, (dx - along) / low
            across = (dq - along[:, None] * ahead) / np.sqrt(high * low)[:, None]
            mean = (rises + falls) / 2
            away = np.hypot((rises - falls) / 2, np.linalg.norm(across, axis=1))
            own += [rises, falls, np.sqrt(2.0) * across.ravel()]
            least.append(mean - away)
            most.append(mean + away)
        return Change(
            np.concatenate(own),
            min(float(one.min(initial=np.inf)) for one in least),
            max(float(one.max(initial=-np.inf)) for one in most),
        )

    def linear(self, z: Floats) -> "Newton":
        """The derivative at a vector inside; raises `SingularError` at the edge and beyond."""
        if not self._inside(z):  # where cones are 1e16 times as long as they are wide
            raise SingularError("no derivative where a cone is as flat as round-off")
        return Newton(self, z)

    def state(self, z: Floats) -> ProgramState:
        """The state of a vector."""
        p, q, _, _, _, u, alpha = self.parts(z)
        rows = self.program.contact
        tangential = np.zeros((rows.count, rows.tangent_dim))
        tangential[self.rough] = q / rows.weights[self.rough, None]
        return ProgramState(u, float(alpha[0]), (), (), p / rows.weights, tangential)

    def start(self, state: ProgramState, product: Floats) -> Floats:
        """The vector closest to a state, in its own units, with given products, (m,) > 0."""
        rows, own = self.program.contact, product[self.rough]
        p0, q0 = (
            rows.weights * state.normal_reaction,
            rows.weights[:, None] * state.tangential_reaction,
        )
        # Adhesion may carry a load without any normal forces.
        sizes = (float(np.abs(own).max()) for own in (p0, q0, self.program.reference_load))
        ratio = next(size for size in sizes if size > 0) / float(np.abs(state.velocity).max())
        d = p0 - ratio * rows.opening(state.velocity)
        root = np.hypot(d, 2 * np.sqrt(ratio * product))
        p = np.where(d > 0, d + root, 4 * ratio * product / (root - np.minimum(d, 0.0))) / 2
        most = self.coefficient * p[self.rough] + self.cohesion
        aim, ahead = _directed((q0 - ratio * rows.slip(state.velocity))[self.rough])
        below, above = np.zeros(most.size), most.copy()
        for _ in range(_HALVINGS):  # f - ratio v.ahead rises with f
            f = (below + above) / 2
            high = f + ratio * own * f / ((most - f) * (most + f)) > aim
            below, above = np.where(high, below, f), np.where(high, f, above)
        f = (below + above) / 2
        speed = own / ((most - f) * (most + f))
        slip = -(speed * f)[:, None] * ahead
        friction = f[:, None] * ahead
        parts = p, friction, product / p, speed * most, slip, state.velocity, [state.load_factor]
        return np.concatenate([np.ravel(part) for part in parts])

    def _inside(self, z: Floats) -> bool:
        p, _, s, *_ = self.parts(z)
        return all(np.all(own > 0) for own in (p, s, *self._depths(z)))

    def _depths(self, z: Floats) -> Iterator[Floats]:
        for x, q in self.cones(z):
            yield x - np.linalg.norm(q, axis=1)


class Newton:
    """Factorised derivative of all equations at a vector.

    Forces, openings and slip are eliminated point by point, so that velocities remain.
    """

    def __init__(self, problem: Complementarity, z: Floats) -> None:
        """Raises `SingularError`."""
        self._problem, load = problem, problem.program.reference_load
        self._p, _, self._s, *_ = problem.parts(z)
        self._cones = (x, q), (r, v) = problem.cones(z)
        one = np.eye(q.shape[1])
        compliance = r[:, None, None] * one - q[:, :, None] * (v / x[:, None])[:, None, :]
        bound = x[:, None, None] * one - q[:, :, None] * (q / x[:, None])[:, None, :]
        # Its determinant is positive inside the cones.
        self._inverse: Floats = np.asarray(np.linalg.inv(compliance), dtype=float)
        self._friction = self._inverse @ bound  # of slip
        self._skew = _times(self._inverse, v - (r / x)[:, None] * q) * problem.coefficient[:, None]
        self._stiff = self._p / self._s
        pressed = -self._skew * self._stiff[problem.rough, None]
        blocks = np.concatenate([pressed[:, :, None], self._friction], axis=2)
        self._factor = Factor(
            problem.pattern, np.concatenate([self._stiff, np.moveaxis(blocks, 0, 2).ravel()])
        )
        self._by_load = self._factor.solve(load)
        self._own = float(load @ self._by_load)

    @property
    def sign(self) -> float:
        """See `lacore.numerics.curve.Linear`."""
        return self._factor.sign * float(np.sign(self._own))

    def solve(self, right: Floats) -> Floats:
        """Change of the vector for a change of all equations, refined once."""
        first = self._solve(right)
        return first + self._solve(right - self._applied(first))

    def _solve(self, right: Floats) -> Floats:
        problem = self._problem
        m, n, rough = self._p.size, problem.program.n, problem.rough
        (x, q), (r, v) = self._cones
        k, d = q.shape
        balance, own, opening, slip, powers, along, across = np.split(
            right, np.cumsum([n, 1, m, k * d, m, k])
        )
        slip, across = slip.reshape(k, d), across.reshape(k, d)
        load, (normal, tangential) = problem.program.reference_load, problem.transposed
        alone = _times(self._inverse, across - (along / x)[:, None] * q)

        def forces(opens: Floats, slips: Floats) -> tuple[Floats, Floats]:
            p = (powers - self._p * opens) / self._s
            skew = self._skew * p[rough, None]
            return p, alone - skew - _times(self._friction, slips)

        p, friction = forces(-opening, -slip)
        first = self._factor.solve(normal @ p + tangential @ friction.ravel() - balance)
        alpha = (own[0] - load @ first) / self._own
        u = first + alpha * self._by_load
        opens, slips = problem.normal @ u - opening, (problem.tangential @ u).reshape(k, d) - slip
        p, friction = forces(opens, slips)
        pressed = problem.coefficient * p[rough]
        most = (along - r * pressed - _dots(v, friction) - _dots(q, slips)) / x
        return np.concatenate([p, friction.ravel(), opens, most, slips.ravel(), u, [alpha]])

    def _applied(self, dz: Floats) -> Floats:
        dp, _, ds, *_ = self._problem.parts(dz)
        (x, q), (r, v) = self._cones
        (dx, dq), (dr, dv) = self._problem.rates(dz)
        along = x * dr + r * dx + _dots(q, dv) + _dots(v, dq)
        across = (dx[:, None] * v + x[:, None] * dv) + (dr[:, None] * q + r[:, None] * dq)
        powers = self._p * ds + self._s * dp
        return np.concatenate([self._problem.equations(dz), powers, along, across.ravel()])


def poses(program: KinematicProgram) -> bool:
    """Whether a program is one of rigid blocks alone, with Coulomb friction without dilation.

    Then the problem is linear but for its products.
    """
    rows = program.contact
    return (
        bool(rows.coulomb.any())
        and program.homogeneous
        and not any(group.weights.size for group in program.groups)
        and bool(np.all(np.isfinite(rows.limit) & (rows.dilatancy == 0)))
    )


def _rough(program: KinematicProgram) -> Ints:
    rows = program.contact
    return np.flatnonzero(rows.coulomb | (rows.limit > 0))


def _dots(one: Floats, other: Floats) -> Floats:
    return np.asarray(np.einsum("kd,kd->k", one, other))


def _times(matrices: Floats, vectors: Floats) -> Floats:
    return np.asarray(np.einsum("kij,kj->ki", matrices, vectors))


def _directed(vectors: Floats) -> tuple[Floats, Floats]:
    """Lengths and directions, any of a vector that is zero."""
    length = np.linalg.norm(vectors, axis=1)
    ahead = np.where(length[:, None] > 0, vectors, np.eye(vectors.shape[1])[0])
    return length, ahead / np.linalg.norm(ahead, axis=1)[:, None]
