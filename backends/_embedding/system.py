"""The linear equations of a step: factorised on velocities, refined in all unknowns.

    D^T z + E^T p + G^T r = f        with C and W^2 the scalings of the cones,
    D u + C z = a,  E u = b,  G u + W^2 r = g

z, p and r are eliminated point by point, with small compliances added where there is next to none:
``K = D^T (C + delta)^-1 D + G^T (W^2 + delta)^-1 G + E^T delta^-1 E``. Refinement, of the equations
without them, takes back what they change.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from backends._embedding.arrays import Conic
from backends._embedding.cones import Scaling, inner
from backends._embedding.loops import Loops
from backends._embedding.stiffness import Stiffness
from backends._embedding.vectors import Layout, Vector
from lacore.arrays import Floats
from lacore.numerics.linear_algebra import SymmetricSolver

_CAP = 1e9  # of compliances of cones: how much stiffer than flowing ones they may get
_VOLUME = 1e8  # and of rows that hold exactly
_FLOWING = 1e4  # w.w: compliance along the flow, per that across it
_SHIFT = 1e-14  # of each diagonal, so that motions without any stiffness do not end it


@dataclass(frozen=True)
class Soft:
    """The compliance C of costly cones: ``square (1 + rank w w^T)``, w of shape (d, m)."""

    square: Floats
    rank: Floats
    w: Floats
    size: Floats  # w.w
    loops: Loops

    @classmethod
    def of(cls, scaling: Scaling, rise: Floats, loops: Loops) -> "Soft":
        """That of a scaling, the t eliminated."""
        w = scaling.w[1:]
        size = inner(w, w)
        raised = scaling.square * rise
        rank = 2 * (1 - raised) / (1 + (1 + 2 * size) * raised)
        return cls(scaling.square, rank, w, size, loops)

    @property
    def along(self) -> Floats:
        """Eigenvalue along w; the others are `square`."""
        return self.square * (1 + self.rank * self.size)

    def times(self, z: Floats) -> Floats:
        """``C z``."""
        return self.loops.stretched(self.square, self.rank, self.w, z)

    def flow(self, rate: Floats) -> Floats:
        """The z that makes up for rates along w, of cones that flow freely."""
        free = self.size > _FLOWING
        share = np.where(free, inner(self.w, rate) / (self.along * np.maximum(self.size, 1.0)), 0.0)
        return np.asarray(share * self.w)

    def inverse(self, delta: Floats) -> tuple[Floats, Floats]:
        """``(C + delta)^-1 = first (1 - second w w^T)``."""
        first = 1 / (self.square + delta)
        second = self.square * self.rank / (self.along + delta)
        return first, second


@dataclass(frozen=True)
class Border:
    """What tau does to the rates of costly cones, and stresses and tau to the gap.

    Attributes:
        rates: shape (d, m) each.
        stresses: slopes of the gap by z, shape (d, m) each.
        tau: slope of the gap by tau.
    """

    rates: tuple[Floats, ...]
    stresses: tuple[Floats, ...]
    tau: float


class System:
    """The equations of a program, with a pattern that stays."""

    def __init__(self, conic: Conic, stiffness: Stiffness, solver: SymmetricSolver) -> None:
        self._conic, self._stiffness, self._solver = conic, stiffness, solver
        self.layout = Layout(conic)
        self._weights = np.ones(self.layout.size)

    def elastic(self, costly: Sequence[Floats], equal: Floats, free: Sequence[Floats]) -> Floats:
        """``K^-1 F0`` of springs with stiffnesses of each kind of points, shape (m,) each."""
        conic, blocks = self._conic, []
        for rows, stiffness in zip(conic.kinds, [*costly, *free, equal], strict=True):
            blocks.append(np.eye(rows.dim)[:, :, None] * stiffness)
        self._take(blocks)
        return self._solver.solve(conic.load)

    def _take(self, blocks: Sequence[Floats]) -> Floats:
        """Factorise; the diagonal."""
        matrix = self._stiffness.upper(blocks)
        diagonal = matrix.data[self._stiffness.diagonal]
        floor = np.finfo(float).tiny + _SHIFT**2 * diagonal.max(initial=1.0)
        matrix.data[self._stiffness.diagonal] = np.maximum(diagonal * (1 + _SHIFT), floor)
        self._solver.factorise_upper(matrix)
        return np.asarray(np.maximum(diagonal, floor))

    def factorise(
        self, soft: Sequence[Soft], scalings: Sequence[Scaling], reference: float, border: Border
    ) -> None:
        """Take the compliances of all cones; `reference` is one of those that flow, per norm.

        Raises:
            SingularError: the matrix is not definite.
        """
        conic, weights = self._conic, self.layout.zeros()
        self._soft, self._scalings, self._border = soft, scalings, border
        least = reference / _CAP
        stiff = [
            own.inverse(least * one.rows.norms) for one, own in zip(conic.costly, soft, strict=True)
        ]
        self._first, self._less = [first for first, _ in stiff], [-second for _, second in stiff]
        self._steep = [
            Steep.of(scaling, least * kind.rows.norms)
            for kind, scaling in zip(conic.free, scalings, strict=True)
        ]
        self._held = _VOLUME / (reference * conic.equal.norms)
        blocks = []
        for own, (first, second) in zip(soft, stiff, strict=True):
            block = -(first * second) * own.w[:, None] * own.w
            which = np.arange(own.w.shape[0])
            block[which, which] += first
            blocks.append(block)
        blocks += [steep.blocks for steep in self._steep]
        weights.force[:] = 1 / np.sqrt(self._take([*blocks, self._held[None, None]]))
        weights.equal[:] = np.sqrt(self._held)
        for part, one in zip(weights.costly, soft, strict=True):
            part[:] = 1 / np.sqrt(one.square)
        for part, scaling in zip(weights.free, scalings, strict=True):
            part[:] = 1 / np.sqrt(scaling.square)
        by_load, by_tau = self.layout.zeros(), self.layout.zeros()
        by_load.force[:] = -conic.load
        by_tau.force[:] = -conic.dead
        by_tau.equal[:] = conic.given
        for part, rate in zip(by_tau.costly, border.rates, strict=True):
            part[:] = -rate
        for part, kind in zip(by_tau.free, conic.free, strict=True):
            part[:] = -kind.offset
        by_load, by_tau = self._inner(by_load, by_tau)
        self._columns = by_load, by_tau
        work = float(conic.load @ by_load.force)
        self._small = np.array(
            [
                [work, conic.load @ by_tau.force - 1],
                [self._gap(by_load) - 1, self._gap(by_tau) + border.tau],
            ]
        )
        unit = np.sqrt(abs(work)) + np.finfo(float).tiny
        weights.data[-2:] = 1 / unit, 1 / (1 / unit + np.sqrt(abs(self._small[1, 1])))
        self._weights = weights.data

    def _gap(self, x: Vector) -> float:
        """What all but lambda and tau add to the gap."""
        conic = self._conic
        total = -float(conic.dead @ x.force) - float(conic.given @ x.equal)
        for slope, z in zip(self._border.stresses, x.costly, strict=True):
            total += float(np.vdot(slope, z))
        for kind, r in zip(conic.free, x.free, strict=True):
            total += float(np.vdot(kind.offset, r))
        return total

    def once(self, right: Vector) -> Vector:
        """The solution with the small compliances."""
        (x,) = self._inner(right)
        by_load, by_tau = self._columns
        rest = np.array([right.load - self._conic.load @ x.force, right.tau - self._gap(x)])
        load, tau = np.linalg.solve(self._small, rest)
        x.data[:] += load * by_load.data
        x.data[:] += tau * by_tau.data
        x.data[-2:] = load, tau
        return x

    def _inner(self, *rights: Vector) -> list[Vector]:
        """Those without lambda and tau, of several right-hand sides in one go."""
        forces = np.column_stack([self._pulled(right) for right in rights])
        found = self._solver.solve(forces)
        return [self._moved(right, u) for right, u in zip(rights, found.T, strict=True)]

    def _pulled(self, right: Vector) -> Floats:
        """Forces of a right-hand side on velocities alone."""
        conic = self._conic
        force = conic.equal.force((self._held * right.equal)[None])
        force -= right.force
        for number, one in enumerate(conic.costly):
            force += one.rows.force(self._stiff(number, right.costly[number]))
        for kind, steep, part in zip(conic.free, self._steep, right.free, strict=True):
            force += kind.rows.force(steep.times(part))
        return np.asarray(force)

    def _moved(self, right: Vector, u: Floats) -> Vector:
        """The solution with such velocities."""
        conic, x = self._conic, self.layout.zeros()
        x.force[:] = u
        x.equal[:] = self._held * (right.equal - conic.equal.at(u)[0])
        for number, one in enumerate(conic.costly):
            x.costly[number][:] = self._stiff(number, right.costly[number] - one.rows.at(u))
        for number, kind in enumerate(conic.free):
            x.free[number][:] = self._steep[number].times(right.free[number] - kind.rows.at(u))
        return x

    def _stiff(self, number: int, a: Floats) -> Floats:
        own, first, less = self._soft[number], self._first[number], self._less[number]
        return own.loops.stretched(first, less, own.w, a)

    def times(self, x: Vector) -> Vector:
        """The left-hand sides."""
        conic, border, out = self._conic, self._border, self.layout.zeros()
        u, force = x.force, out.force
        force[:] = x.load * conic.load + x.tau * conic.dead
        parts = zip(conic.costly, self._soft, border.rates, x.costly, out.costly, strict=True)
        for one, own, rate, z, part in parts:
            one.rows.both(u, z, force, part)
            part += own.times(z)
            part += x.tau * rate
        for kind, scaling, r, part in zip(
            conic.free, self._scalings, x.free, out.free, strict=True
        ):
            kind.rows.both(u, r, force, part)
            part += scaling.twice(r)
            part += x.tau * kind.offset
        conic.equal.both(u, x.equal[None], force, out.equal[None])
        out.equal[:] -= x.tau * conic.given
        out.data[-2] = float(conic.load @ x.force) - x.tau
        out.data[-1] = self._gap(x) - x.load + border.tau * x.tau
        return out

    def left(self, right: Vector, x: Vector) -> Vector:
        """What a solution leaves of the equations."""
        return right.plus(self.times(x), -1.0)

    def solve(self, right: Vector, start: Vector, exactness: float, most: int) -> Vector:
        """The solution from a start, by at most so many solves.

        Flexible GMRES, in units of the scaling: what the small compliances leave is large in a few
        directions, which plain refinement takes back slowly.
        """
        x, left = start, self.left(right, start)
        first = size = self._size(left)
        goal = exactness * self._size(right)
        weights = self._weights
        basis, solutions, images = [weights * left.data / size], [], []
        small = np.zeros((most + 1, most))
        best: Floats = np.zeros(0)
        for k in range(most):
            if size <= goal:
                break
            solutions.append(self.once(Vector(self.layout, basis[k] / weights)))
            images.append(self.times(solutions[k]).data)
            image = weights * images[k]
            for i, known in enumerate(basis):
                small[i, k] = image @ known
                image -= small[i, k] * known
            small[k + 1, k] = np.linalg.norm(image)
            wanted = np.zeros(k + 2)
            wanted[0] = first
            found = np.linalg.lstsq(small[: k + 2, : k + 1], wanted, rcond=None)[0]
            best = np.asarray(found, dtype=float)
            size = float(np.linalg.norm(small[: k + 2, : k + 1] @ best - wanted))
            if small[k + 1, k] <= 1e-14 * abs(small[: k + 1, k]).max():
                break
            basis.append(image / small[k + 1, k])
        for share, solution, image in zip(best, solutions, images, strict=True):
            x, left = x.plus(solution, share), Vector(self.layout, left.data - share * image)
        return self._along(x, left)

    def _size(self, x: Vector) -> float:
        return float(np.linalg.norm(self._weights * x.data))

    def _along(self, x: Vector, left: Vector) -> Vector:
        """The rates of what flows made exact: there z hardly feels it, and cones feel it most.

        A flowing cone is as near to its edge as mu is to zero, and what is left of its rate along
        the flow moves it by as much. Stresses that take it up are too small for equilibrium.
        """
        moved = x.plus(self.layout.zeros())
        for z, a, own in zip(moved.costly, left.costly, self._soft, strict=True):
            z += own.flow(a)
        return moved


@dataclass(frozen=True)
class Steep:
    """``(W^2 + delta)^-1`` of free cones, in the frame of each."""

    plain: Floats
    both: Floats
    cross: Floats
    direction: Floats

    @classmethod
    def of(cls, scaling: Scaling, delta: Floats) -> "Steep":
        square, w = scaling.square, scaling.w
        size = np.sqrt(inner(w[1:], w[1:]))
        high = 1 / (square * (w[0] + size) ** 2 + delta)
        low = 1 / (square / (w[0] + size) ** 2 + delta)
        direction = w[1:] / np.maximum(size, np.finfo(float).tiny)
        if w.shape[0] == 1:
            high = low = 1 / (square + delta)
        return cls(1 / (square + delta), (high + low) / 2, (high - low) / 2, direction)

    def times(self, g: Floats) -> Floats:
        along = inner(self.direction, g[1:])
        found = np.empty_like(g)
        found[0] = self.both * g[0] + self.cross * along
        more = self.cross * g[0] + (self.both - self.plain) * along
        found[1:] = self.plain * g[1:] + more * self.direction
        return found

    @property
    def blocks(self) -> Floats:
        """Shape (dim, dim, m)."""
        dim, direction = 1 + self.direction.shape[0], self.direction
        block = np.zeros((dim, dim, self.plain.size))
        block[0, 0] = self.both
        block[0, 1:] = block[1:, 0] = self.cross * direction
        block[1:, 1:] = (self.both - self.plain) * direction[:, None] * direction
        which = np.arange(1, dim)
        block[which, which] += self.plain
        return block
