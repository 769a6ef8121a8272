"""Second-order cones in large numbers, handled without a loop over points.

The points of m cones of 1 + d components are arrays of shape (1 + d, m), with one component per
row. Sums over components then run along contiguous rows, ten times faster than over a last axis of
three. A cone of one component is a half-line. The algebra is that of
`lacore.numerics.second_order_cones`. The Nesterov-Todd scaling is kept as a vector and a number
instead of a matrix.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from lacore.numerics.arrays import Floats, Ints

_TINY = np.finfo(float).tiny


def lengths(x: Floats) -> Floats:
    """Return ``||x||`` of each column, shape (m,)."""
    return np.asarray(np.sqrt(np.einsum("cm,cm->m", x, x)))


def determinant(x: Floats) -> Floats:
    """Return ``x_0^2 - ||x_1||^2`` without cancellation, shape (m,)."""
    length = lengths(x[1:])
    return np.asarray((x[0] - length) * (x[0] + length))


def inside(x: Floats) -> bool:
    """Return whether all points are strictly inside; False if one is NaN."""
    return bool(np.all(x[0] > lengths(x[1:])))


def inner(x: Floats, y: Floats) -> Floats:
    """Return ``x.y`` of each cone, shape (m,)."""
    return np.asarray(np.einsum("cm,cm->m", x, y))


def product(x: Floats, y: Floats) -> Floats:
    """Return ``x o y = (x.y, x_0 y_1 + y_0 x_1)``."""
    found = x[0] * y + y[0] * x
    found[0] = inner(x, y)
    return np.asarray(found)


def quotient(x: Floats, y: Floats) -> Floats:
    """Return the point q with ``x o q = y``, x inside."""
    found = np.empty_like(y)
    found[0] = (x[0] * y[0] - inner(x[1:], y[1:])) / determinant(x)
    found[1:] = (y[1:] - found[0] * x[1:]) / x[0]
    return found


def clipped(x: Floats, least: float, most: float) -> Floats:
    """Return the changes that bring the eigenvalues ``x_0 -+ ||x_1||`` into an interval."""
    length = lengths(x[1:])
    low, high = x[0] - length, x[0] + length
    # Large values are reduced by no more than the upper end of the interval, as they do no harm.
    down = np.clip(low, least, most) - low
    up = np.clip(high, least, most) - high
    down, up = np.maximum(down, -most), np.maximum(up, -most)
    found = np.empty_like(x)
    found[0] = (up + down) / 2
    found[1:] = x[1:] / np.maximum(length, np.finfo(float).tiny) * ((up - down) / 2)
    return found


@dataclass(frozen=True)
class Scaling:
    """Symmetric map W of Nesterov and Todd between inner points: ``W z = W^-1 s``.

    ``W^2 = square (2 w w^T - J)`` with the mirror J = diag(1, -1, ...) and ``w.J w = 1``.

    Attributes:
        square: eta^2, shape (m,).
        w: shape (1 + d, m).
        middle: ``W z``, shape (1 + d, m).
    """

    square: Floats
    w: Floats
    middle: Floats

    @classmethod
    def between(cls, s: Floats, z: Floats) -> "Scaling":
        """Return the scaling of interior points s and z."""
        s_size, z_size = np.sqrt(determinant(s)), np.sqrt(determinant(z))
        unit, other = s / s_size, z / z_size
        half = np.sqrt((1 + inner(unit, other)) / 2)
        w = unit - other
        w[0] = unit[0] + other[0]
        w /= 2 * half
        # Enforce w.J w = 1 despite round-off.
        w[0] = np.sqrt(1 + inner(w[1:], w[1:]))
        scaling = cls(s_size / z_size, w, z)
        return cls(scaling.square, w, scaling.times(z))

    def times(self, z: Floats) -> Floats:
        """Return ``W z``."""
        root = np.sqrt(self.square)
        across = inner(self.w[1:], z[1:])
        found = np.empty_like(z)
        found[0] = root * (self.w[0] * z[0] + across)
        found[1:] = root * (z[1:] + (z[0] + across / (1 + self.w[0])) * self.w[1:])
        return found

    def by(self, s: Floats) -> Floats:
        """Return ``W^-1 s``."""
        root = 1 / np.sqrt(self.square)
        across = inner(self.w[1:], s[1:])
        found = np.empty_like(s)
        found[0] = root * (self.w[0] * s[0] - across)
        found[1:] = root * (s[1:] + (across / (1 + self.w[0]) - s[0]) * self.w[1:])
        return found


@dataclass(frozen=True)
class Compliance:
    """Compliance ``C = square (S + rank w w^T)`` of m points, with S = diag(first, 1, ..., 1).

    Attributes:
        square, rank: shape (m,).
        w: shape (dim, m).
        first: -1 where ``C = W^2`` of a scaling, which is definite although S is not; else 1.
    """

    square: Floats
    rank: Floats
    w: Floats
    first: float = 1.0

    @classmethod
    def twice(cls, scaling: Scaling) -> "Compliance":
        """Return ``W^2``."""
        return cls(scaling.square, np.full(scaling.square.size, 2.0), scaling.w, -1.0)

    @classmethod
    def none(cls, count: int) -> "Compliance":
        """Return the zero compliance of rows that hold exactly, of one component."""
        return cls(np.zeros(count), np.zeros(count), np.zeros((1, count)))

    def times(self, z: Floats) -> Floats:
        """Return ``C z``."""
        found = z + self.rank * inner(self.w, z) * self.w
        found[0] += (self.first - 1) * z[0]
        return np.asarray(self.square * found)

    def inverse(self, delta: Floats) -> "Inverse":
        """Return ``(C + delta)^-1``."""
        return self.through(lambda c: np.asarray(1 / (c + delta)))

    def through(self, function: Callable[[Floats], Floats]) -> "Inverse":
        """Return a function of C, given as a function of its eigenvalues."""
        square, w = self.square, self.w
        plain = function(square)
        if self.first > 0:
            size = inner(w, w)
            along = function(square * (1 + self.rank * size))
            one = (along / plain - 1) / np.maximum(size, _TINY)
            return Inverse(plain, one, np.zeros(one.size), w, self.first)
        if w.shape[0] == 1:
            return Inverse(plain, plain, plain, w, self.first)
        size = lengths(w[1:])
        high, low = function(square * (w[0] + size) ** 2), function(square / (w[0] + size) ** 2)
        return Inverse(plain, high, low, w / np.maximum(size, _TINY), self.first)

    def along(self, rates: Floats, steep: float) -> Floats:
        """Return the z that corrects rates along flow directions.

        These are directions more than `steep` times as compliant as those across the flow.
        """
        if self.first < 0:
            return self._at_edge(rates, steep)
        size = inner(self.w, self.w)
        flows = size > steep
        own = np.where(flows, self.square * (1 + self.rank * size) * size, 1.0)
        return np.asarray(np.where(flows, inner(self.w, rates) / own, 0.0) * self.w)

    def _at_edge(self, rates: Floats, steep: float) -> Floats:
        """Return the z that corrects rates along an edge for ``C = W^2``, where ``w.w > steep``."""
        if self.w.shape[0] == 1:
            return np.zeros_like(rates)
        size = lengths(self.w[1:])
        edge = np.vstack([np.ones_like(size), self.w[1:] / np.maximum(size, _TINY)])
        share = inner(edge, rates) / (2 * self.square * (self.w[0] + size) ** 2)
        return np.asarray(np.where(self.w[0] ** 2 > steep, share, 0.0) * edge)


@dataclass(frozen=True)
class Inverse:
    """``(C + delta)^-1`` or another function of C, as ``plain (1 + one w w^T)``.

    Where ``C = W^2`` it is kept in the frame of each point, because its eigenvalues differ widely
    near the edge of a cone: `one` along ``(1, w_1)``, `two` along ``(1, -w_1)``, and `plain` across
    both, where w_1 is a unit vector.

    Attributes:
        plain, one, two: shape (m,).
        w: shape (dim, m).
        first: see `Compliance`.
    """

    plain: Floats
    one: Floats
    two: Floats
    w: Floats
    first: float = 1.0

    def times(self, a: Floats) -> Floats:
        """Return the product with a."""
        if self.first > 0:
            return np.asarray(self.plain * (a + self.one * inner(self.w, a) * self.w))
        along = inner(self.w[1:], a[1:])
        one, two = self.one * ((a[0] + along) / 2), self.two * ((a[0] - along) / 2)
        found = np.empty_like(a)
        found[0] = one + two
        found[1:] = self.plain * (a[1:] - along * self.w[1:]) + (one - two) * self.w[1:]
        return found

    @property
    def blocks(self) -> Floats:
        """Shape (dim, dim, m)."""
        plain, w = self.plain, self.w
        if self.first > 0:
            return _block(plain, plain * self.one, w)
        block = np.empty((w.shape[0], *w.shape))
        both = (self.one + self.two) / 2
        block[0, 0] = both
        block[0, 1:] = block[1:, 0] = (self.one - self.two) / 2 * w[1:]
        block[1:, 1:] = _block(plain, both - plain, w[1:])
        return block


@dataclass(frozen=True)
class Eliminated:
    """The eliminated t of m cones ``(t, y)`` with the cost ``c t + h t^2/2`` in a step.

    ``dt = height_0/raised + by_tau dtau - across.dz_1`` for a given ``height = W^2 dz + ds``. The
    remaining equations give ``dy + C dz_1`` with ``C = square (1 + rank w w^T)``.

    Attributes:
        raised, by_tau: shape (m,).
        across: shape (d, m).
        rank: shape (m,).
        slope: derivative of the gap by t, shape (m,).
    """

    raised: Floats
    by_tau: Floats
    across: Floats
    rank: Floats
    slope: Floats


@dataclass(frozen=True)
class Compliances:
    """Compliances of several kinds, joined.

    See `Compliance` and `lacore_backends._embedding.rows.Stack`.

    Attributes:
        square, rank: values of all points.
        w: values of all kinds, shape (dim, m) each, as one array.
        first: value of each kind.
    """

    square: Floats
    rank: Floats
    w: Floats
    first: Floats

    @classmethod
    def of(cls, parts: Sequence[Compliance]) -> "Compliances":
        """Join the compliances of each kind."""
        return cls(*_joined(parts))

    def parts(self, spans: Ints) -> list[Compliance]:
        """Return the compliance of each kind."""
        return [Compliance(*part) for part in _split(self, spans)]


@dataclass(frozen=True)
class Inverses:
    """Inverses of several kinds, joined: see `Inverse` and `Compliances`."""

    plain: Floats
    one: Floats
    two: Floats
    w: Floats
    first: Floats

    @classmethod
    def of(cls, parts: Sequence[Inverse]) -> "Inverses":
        """Join the inverses of each kind."""
        return cls(*_joined(parts))

    def parts(self, spans: Ints) -> list[Inverse]:
        """Return the inverse of each kind."""
        return [Inverse(*part) for part in _split(self, spans)]


def _joined(parts: Sequence[Compliance] | Sequence[Inverse]) -> Iterator[Floats]:
    """Yield each field of several kinds as one array: those of points, w, and `first`."""
    for field in fields(parts[0]):
        yield np.concatenate([np.ravel(getattr(part, field.name)) for part in parts])


def _split(joined: Compliances | Inverses, spans: Ints) -> Iterator[tuple[Any, ...]]:
    """Yield the fields of each kind, the inverse of `_joined`."""
    *numbers, w, firsts = (getattr(joined, field.name) for field in fields(joined))
    for (dim, count, row, point, _), first in zip(spans.tolist(), firsts, strict=True):
        own = [number[point : point + count] for number in numbers]
        yield *own, w[row : row + dim * count].reshape(dim, count), float(first)


def _block(plain: Floats, rank: Floats, w: Floats) -> Floats:
    """Return ``plain + rank w w^T``, shape (dim, dim, m)."""
    block = rank * w[:, None] * w
    which = np.arange(w.shape[0])
    block[which, which] += plain
    return np.asarray(block)
