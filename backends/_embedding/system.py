"""The linear equations of a step: factorised on velocities, refined in all unknowns.

    D^T z + E^T p + G^T r + R^T zeta = f    with C and W^2 the scalings of the cones,
    D u + C z = a,  E u = b,  G u + W^2 r = g,  R u + C zeta = d

z, zeta, p and r are eliminated point by point, with small compliances added where there is next to
none: ``K = D^T (C + delta)^-1 D + G^T (W^2 + delta)^-1 G + E^T delta^-1 E``, and of R as of D.
Refinement, of the equations without them, takes back what they change.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from backends._embedding.arrays import Conic
from backends._embedding.cones import Compliance, Inverse
from backends._embedding.frames import Frame
from backends._embedding.stiffness import Stiffness
from backends._embedding.vectors import Layout, Vector
from lacore.arrays import Floats, Sparse
from lacore.numerics.linear_algebra import SymmetricSolver

_CAP = 1e9  # of compliances of cones: how much stiffer than flowing ones they may get
_VOLUME = 1e8  # and of rows that hold exactly
_FLOWING = 1e4  # w.w: compliance along the flow, per that across it
_LEAST = 1e-20  # of the largest: a diagonal, with less of which PARDISO ends
_SHIFT = 1e-14  # of each diagonal, so that motions without any stiffness do not end it


@dataclass(frozen=True)
class Border:
    """What tau does to the rates of cones, and multipliers and tau to the gap.

    Attributes:
        rates: shape (dim, m) each.
        slopes: of the gap by multipliers, shape (dim, m) each.
        tau: slope of the gap by tau.
    """

    rates: tuple[Floats, ...]
    slopes: tuple[Floats, ...]
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
        if not np.any(conic.load[conic.loose]):
            return self._solver.solve(conic.load)
        alone = np.zeros_like(conic.load)  # they give way, and nothing else does
        alone[conic.loose] = conic.load[conic.loose]
        return alone

    def _take(self, blocks: Sequence[Floats]) -> Floats:
        """Factorise; the diagonal."""
        matrix, diagonal = self._summed(blocks)
        self._solver.factorise_upper(matrix)
        return diagonal

    def _summed(self, blocks: Sequence[Floats]) -> tuple[Sparse, Floats]:
        """The upper triangle of K, and its diagonal."""
        matrix = self._stiffness.upper(blocks)
        diagonal = matrix.data[self._stiffness.diagonal]
        diagonal[self._conic.loose] = diagonal.mean()  # one as good as another: `_bordered`
        floor = np.finfo(float).tiny + _LEAST * diagonal.max(initial=1.0)
        matrix.data[self._stiffness.diagonal] = np.maximum(diagonal * (1 + _SHIFT), floor)
        return matrix, np.asarray(np.maximum(diagonal, floor))

    def factorise(
        self, soft: Sequence[Compliance | Frame], reference: float, border: Border, right: Vector
    ) -> Vector:
        """Take the compliances of all cones; `reference` is one of those that flow, per norm.

        Returns:
            What `once` would of a first right-hand side, which the border is solved beside.

        Raises:
            SingularError: the matrix is not definite.
        """
        conic = self._conic
        self._soft: list[Compliance | Frame] = [*soft, Compliance.none(conic.equal.count)]
        least = reference / _CAP
        held = _VOLUME / (reference * conic.equal.norms)
        self._stiff = [
            own.inverse(least * rows.norms)
            for own, rows in zip(soft, conic.kinds[:-1], strict=True)
        ]
        self._stiff.append(Inverse.of(held))
        weights, rate, slope = (self.layout.zeros() for _ in range(3))
        self._least = [*(least * rows.norms for rows in conic.kinds[:-1]), 1 / held]
        weights.force[:] = 1 / np.sqrt(self._factorised(reference))
        weights.equal[:] = np.sqrt(held)
        for part, own in zip(weights.parts, soft, strict=False):
            part[:] = 1 / np.sqrt(own.square)
        # What tau does to each equation, and each unknown to the gap.
        rate.force[:], slope.force[:] = conic.dead, -conic.dead
        pairs = zip(rate.parts, slope.parts, border.rates, border.slopes, strict=False)
        for part, other, given, its_slope in pairs:
            part[:], other[:] = given, its_slope
        rate.data[-2:], slope.data[-2:] = (-1.0, border.tau), (-1.0, border.tau)
        self._rate, self._slope = rate.data, slope.data
        by_load = self.layout.zeros()
        by_load.force[:] = -conic.load
        by_tau = Vector(self.layout, -rate.data)
        by_load, by_tau, first = self._inner(by_load, by_tau, right)
        self._columns = by_load, by_tau
        work = float(conic.load @ by_load.force)
        small = np.zeros((2 + conic.loose.size, 2 + conic.loose.size))
        small[0, :2] = work, conic.load @ by_tau.force - 1
        small[1, :2] = self._gap(by_load) - 1, self._gap(by_tau) + border.tau
        small[0, 2:] = small[2:, 0] = conic.load[conic.loose]
        small[1, 2:], small[2:, 1] = -conic.dead[conic.loose], conic.dead[conic.loose]
        self._small = small
        unit = np.sqrt(abs(work)) + np.finfo(float).tiny
        weights.data[-2:] = 1 / unit, 1 / (1 / unit + np.sqrt(abs(small[1, 1])))
        self._weights = weights.data
        return self._bordered(right, first)

    def _factorised(self, reference: float) -> Floats:
        """Factorise what stiffness makes; the diagonal of K."""
        return self._take([own.blocks for own in self._stiff])

    def _gap(self, x: Vector) -> float:
        """What all but lambda and tau add to the gap."""
        return float(self._slope[:-2] @ x.data[:-2])

    def once(self, right: Vector) -> Vector:
        """The solution with the small compliances."""
        (x,) = self._inner(right)
        return self._bordered(right, x)

    def _bordered(self, right: Vector, x: Vector) -> Vector:
        """With lambda and tau, and unknowns that none but they move."""
        by_load, by_tau = self._columns
        loose = self._conic.loose
        rest = right.load - self._conic.load @ x.force, right.tau - self._gap(x)
        load, tau, *own = np.linalg.solve(self._small, [*rest, *right.force[loose]])
        x.data[:] += load * by_load.data
        x.data[:] += tau * by_tau.data
        x.force[loose] += own  # without them nothing is left there by the load and tau found
        x.data[-2:] = load, tau
        return x

    def _inner(self, *rights: Vector) -> list[Vector]:
        """Those without lambda and tau, of several right-hand sides in one go."""
        found = []
        for right in rights:  # PARDISO takes up to twice as long for three at once
            force = -right.force
            for rows, stiff, part in zip(self._conic.kinds, self._stiff, right.parts, strict=True):
                stiff.pulled(rows, part, force)
            found.append(self._moved(right, self._solver.solve(force)))
        return found

    def _moved(self, right: Vector, u: Floats) -> Vector:
        """The solution with such velocities."""
        x = Vector(self.layout, np.empty(self.layout.size))
        x.force[:] = u
        x.data[-2:] = 0.0
        pairs = zip(self._conic.kinds, self._stiff, right.parts, x.parts, strict=True)
        for rows, stiff, a, z in pairs:
            stiff.moved(rows, u, a, z)
        return x

    def times(self, x: Vector) -> Vector:
        """The left-hand sides."""
        load, out = self._conic.load, Vector(self.layout, x.tau * self._rate)
        u, force = x.force, out.force
        force += x.load * load
        for rows, own, z, part in zip(
            self._conic.kinds, self._soft, x.parts, out.parts, strict=True
        ):
            own.applied(rows, u, z, force, part)
        out.data[-2:] = load @ u - x.tau, self._slope @ x.data
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
        moved = Vector(self.layout, x.data.copy())
        pairs = zip(self._conic.kinds[:-1], self._soft, left.parts, moved.parts, strict=False)
        for rows, own, rates, z in pairs:
            own.along(rows, _FLOWING, rates, z)
        return moved
