"""The linear equations of a step: factorised on velocities, refined in all unknowns.

    D^T z + E^T p + G^T r + R^T zeta = f    with C and W^2 the scalings of the cones,
    D u + C z = a,  E u = b,  G u + W^2 r = g,  R u + C zeta = d

z, zeta, p and r are eliminated point by point, with small compliances added where there is almost
none: ``K = D^T (C + delta)^-1 D + G^T (W^2 + delta)^-1 G + E^T delta^-1 E``, plus a term of R like
that of D. Iterative refinement of the original equations removes their effect.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Floats, Sparse
from lacore.numerics.linear_algebra import SymmetricSolver
from lacore_backends._embedding.arrays import Conic
from lacore_backends._embedding.cones import Compliance, Compliances
from lacore_backends._embedding.frames import Frame
from lacore_backends._embedding.rows import Rows, stacked
from lacore_backends._embedding.stiffness import Stiffness
from lacore_backends._embedding.vectors import Layout, Vector

_ROUGH = 1e-3  # allowed residual of `improved`, by the right-hand side
_TINY = np.finfo(float).tiny
_CAP = 1e9  # largest stiffness of cones, by that of flowing ones
_VOLUME = 1e8  # the same for rows that hold exactly
_FLOWING = 1e4  # w.w above which a cone is compliant along its flow
_LEAST = 1e-20  # smallest diagonal, by the largest: PARDISO fails below it
_SHIFT = 1e-14  # shift of the diagonal, so that motions without stiffness do not fail


@dataclass(frozen=True)
class Border:
    """Columns and row of tau, lambda and the gap.

    Attributes:
        rates: derivative of the rates of cones by tau, shape (dim, m) each.
        slopes: derivative of the gap by multipliers, shape (dim, m) each.
        tau: derivative of the gap by tau.
    """

    rates: tuple[Floats, ...]
    slopes: tuple[Floats, ...]
    tau: float


@dataclass(frozen=True)
class _Framed:
    """Planes of a kind: their rows, the place of their multipliers, and both compliances."""

    rows: Rows
    own: slice
    shape: tuple[int, int]
    soft: Frame
    stiff: Frame

    def part(self, x: Vector) -> Floats:
        """Return their multipliers, shape (dim, m)."""
        return x.data[self.own].reshape(self.shape)


class System:
    """Equations of a program with a constant pattern."""

    def __init__(self, conic: Conic, stiffness: Stiffness, solver: SymmetricSolver) -> None:
        self._conic, self._stiffness, self._solver = conic, stiffness, solver
        self.layout = layout = Layout(conic)
        kinds = list(zip(conic.kinds, layout.parts, strict=True))
        of_planes = slice(layout.free, len(kinds) - 1)
        self._planes = [(rows, own) for rows, own in kinds[of_planes]]
        kinds[of_planes] = []
        self._stack = stacked([rows for rows, _ in kinds], [own.start for _, (own, _) in kinds])
        self._loops = conic.equal.loops

    def elastic(self, costly: Sequence[Floats], equal: Floats, free: Sequence[Floats]) -> Floats:
        """Return ``K^-1 F0`` of springs with these stiffnesses of points, shape (m,) each."""
        conic, blocks = self._conic, []
        for rows, stiffness in zip(conic.kinds, [*costly, *free, equal], strict=True):
            blocks.append(np.eye(rows.dim)[:, :, None] * stiffness)
        self._take(blocks)
        if not np.any(conic.load[conic.loose]):
            return self._solver.solve(conic.load)
        # These unknowns have no resistance, so nothing else moves.
        alone = np.zeros_like(conic.load)
        alone[conic.loose] = conic.load[conic.loose]
        return alone

    def _take(self, blocks: Sequence[Floats]) -> Floats:
        """Factorise; the diagonal."""
        matrix, diagonal = self._summed(blocks)
        self._solver.factorise_upper(matrix)
        return diagonal

    def _summed(self, blocks: Sequence[Floats]) -> tuple[Sparse, Floats]:
        """Return the upper triangle of K, and its diagonal."""
        matrix = self._stiffness.upper(blocks)
        diagonal = matrix.data[self._stiffness.diagonal]
        diagonal[self._conic.loose] = diagonal.mean()  # The value does not matter: see `_bordered`.
        floor = _TINY + _LEAST * diagonal.max(initial=1.0)
        matrix.data[self._stiffness.diagonal] = np.maximum(diagonal * (1 + _SHIFT), floor)
        return matrix, np.asarray(np.maximum(diagonal, floor))

    def factorise(
        self, soft: Sequence[Compliance | Frame], reference: float, border: Border, right: Vector
    ) -> Vector:
        """Factorise for the compliances of all cones.

        Args:
            soft: compliances of the cones.
            reference: compliance of a flowing cone, by the squared norm of its rows.
            border: columns of tau and lambda.
            right: first right-hand side, which is solved together with the border.

        Returns:
            The result of `once` for the first right-hand side.

        Raises:
            SingularError: the matrix is not definite.
        """
        conic = self._conic
        self._soft: list[Compliance | Frame] = [*soft, Compliance.none(conic.equal.count)]
        least, held = reference / _CAP, _VOLUME / (reference * conic.equal.norms)
        self._flat = Compliances.of([own for own in self._soft if isinstance(own, Compliance)])
        delta = least * self._stack.norms
        delta[delta.size - held.size :] = 1 / held
        self._stiff = self._loops.inverted(self._stack, self._flat, delta)
        frames = [own for own in soft if isinstance(own, Frame)]
        self._frames = [
            _Framed(rows, own, shape, frame, frame.inverse(least * rows.norms))
            for (rows, (own, shape)), frame in zip(self._planes, frames, strict=True)
        ]
        weights, rate, slope = (self.layout.zeros() for _ in range(3))
        added = self.layout.zeros()
        self._least = [*(least * rows.norms for rows in conic.kinds[:-1]), 1 / held]
        for part, more in zip(added.parts, self._least, strict=True):
            part[:] = more
        self._added = added.data
        weights.force[:] = 1 / np.sqrt(self._factorised(reference))
        weights.equal[:] = np.sqrt(held)
        for part, own in zip(weights.parts, soft, strict=False):
            part[:] = 1 / np.sqrt(own.square)
        # Effects of tau on each equation, and of each unknown on the gap.
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
        unit = np.sqrt(abs(work)) + _TINY
        weights.data[-2:] = 1 / unit, 1 / (1 / unit + np.sqrt(abs(small[1, 1])))
        self._weights = weights.data
        return self._bordered(right, first)

    def _factorised(self, reference: float) -> Floats:
        """Factorise the matrix of the stiffness blocks, and return the diagonal of K."""
        return self._take(self._stiff_blocks())

    def _stiff_blocks(self) -> list[Floats]:
        """Return the blocks of all kinds, shape (dim, dim, m) each."""
        *found, equal = self._loops.blocks(self._stack, self._stiff)
        return [*found, *(own.stiff.blocks for own in self._frames), equal]

    def _gap(self, x: Vector) -> float:
        """Return the contribution of all unknowns except lambda and tau to the gap."""
        return float(self._slope[:-2] @ x.data[:-2])

    def once(self, right: Vector) -> Vector:
        """Return the solution of the equations with the small compliances."""
        (x,) = self._inner(right)
        return self._bordered(right, x)

    def _bordered(self, right: Vector, x: Vector) -> Vector:
        """Add lambda, tau, and the unknowns that only they move."""
        by_load, by_tau = self._columns
        loose = self._conic.loose
        rest = right.load - float(self._conic.load @ x.force), right.tau - self._gap(x)
        if loose.size:
            load, tau, *own = np.linalg.solve(self._small, [*rest, *right.force[loose]])
            # With this lambda and tau the equations of these unknowns have no residual.
            x.force[loose] += own
        else:
            load, tau = _pair(self._small, *rest)
        x.data[:] += load * by_load.data
        x.data[:] += tau * by_tau.data
        x.data[-2:] = load, tau
        return x

    def _inner(self, *rights: Vector) -> list[Vector]:
        """Return the solutions without lambda and tau for several right-hand sides."""
        found = []
        for right in rights:  # PARDISO takes up to twice as long for three at once.
            force, x = -right.force, Vector(self.layout, np.empty(self.layout.size))
            self._loops.pulled(self._stack, self._stiff, right.data, force)
            for own in self._frames:
                own.stiff.pulled(own.rows, own.part(right), force)
            x.force[:] = self._solver.solve(force)
            self._loops.moved(self._stack, self._stiff, right.data, x.data)
            for own in self._frames:
                own.stiff.moved(own.rows, x.force, own.part(right), own.part(x))
            x.data[-2:] = 0.0
            found.append(x)
        return found

    def times(self, x: Vector) -> Vector:
        """Return the left-hand sides."""
        load, out = self._conic.load, Vector(self.layout, x.tau * self._rate)
        out.force[:] += x.load * load
        self._loops.times(self._stack, self._flat, x.data, out.data)
        for own in self._frames:
            own.soft.applied(own.rows, x.force, own.part(x), out.force, own.part(out))
        out.data[-2:] = load @ x.force - x.tau, self._slope @ x.data
        return out

    def left(self, right: Vector, x: Vector) -> Vector:
        """Return the residual of a solution."""
        return right.plus(self.times(x), -1.0)

    def leaves(self, right: Vector, x: Vector) -> Vector:
        """Return the residual of `once` without round-off: the added compliances times x."""
        return Vector(self.layout, self._added * x.data)

    def improved(self, right: Vector, start: Vector, left: Vector) -> tuple[Vector, Vector]:
        """Return a solution and its residual, improved by a single solve if the residual is large.

        As `solve`, but with the residuals of `leaves`.
        """
        size = self._size(left)
        if size <= _ROUGH * self._size(right):
            return start, left
        more = self.once(left)
        image = left.plus(self.leaves(left, more), -1.0)
        taken = self._weights * image.data
        share = float(taken @ (self._weights * left.data)) / max(float(taken @ taken), _TINY)
        return start.plus(more, share), left.plus(image, -share)

    def solve(self, right: Vector, start: Vector, exactness: float, most: int) -> Vector:
        """Return the solution from a start with at most `most` solves.

        Flexible GMRES in the units of the scaling is used, because the effect of the small
        compliances is large in a few directions, where plain refinement converges slowly.
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
        return self.along(x, left)

    def _size(self, x: Vector) -> float:
        return float(np.linalg.norm(self._weights * x.data))

    def along(self, x: Vector, left: Vector) -> Vector:
        """Return the solution with exact rates along the flow.

        There z has hardly any effect, but cones react most. A flowing cone is as close to its edge
        as mu is to zero, and the residual of its rate along the flow moves it by as much. The
        stresses that remove this residual are too small to affect equilibrium.
        """
        moved = Vector(self.layout, x.data.copy())
        self._loops.along(self._stack, self._flat, _FLOWING, left.data, moved.data)
        for own in self._frames:
            own.soft.along(_FLOWING, own.part(left), own.part(moved))
        return moved


def _pair(small: Floats, first: float, second: float) -> tuple[float, float]:
    """Return the solution of two equations in a twentieth of the time of a LAPACK call."""
    (a, b), (c, d) = small.tolist()
    if abs(c) > abs(a):
        a, b, c, d, first, second = c, d, a, b, second, first
    try:
        share = c / a
        other = (second - share * first) / (d - share * b)
        return (first - b * other) / a, other
    except ZeroDivisionError as error:
        raise np.linalg.LinAlgError("the border is singular") from error
