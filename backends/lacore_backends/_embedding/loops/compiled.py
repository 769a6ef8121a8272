"""Loops over points and elements compiled by numba, of the extra ``fast``.

The import raises ImportError if numba is not installed; `plain` then does the same in NumPy.
"""

from __future__ import annotations

from collections.abc import Sequence

import numba
import numpy as np

from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore_backends._embedding.cones import Compliances, Eliminated, Inverses, Scaling
from lacore_backends._embedding.loops import (
    compliances,
    cones,
    matrices,
    principal,
    products,
    steps,
)
from lacore_backends._embedding.loops.plain import Indices
from lacore_backends._embedding.loops.stack import Stack

name = f"numba {numba.__version__}"


def pattern(elements: Sequence[Ints], n: int) -> tuple[Indices, Indices, list[Indices]]:
    """See `plain.pattern`."""
    sizes = [np.full(len(own), own.shape[1]) for own in elements]
    ends = np.cumsum(np.concatenate([np.zeros(1, dtype=np.int64), *sizes]))
    columns = np.concatenate([np.zeros(0, dtype=np.int64), *(own.ravel() for own in elements)])
    first, members = matrices.members(columns, ends, n)
    starts, indices = matrices.pattern(columns, ends, first, members, n)
    return starts, indices, [matrices.places(own, starts, indices) for own in elements]


def touched(starts: Indices, columns: Indices, dim: int, n: int) -> tuple[Indices, Indices]:
    """See `plain.touched`."""
    ends, found = matrices.touched(starts, columns, dim, n)
    return ends, found


def dense(matrix: Sparse, points: Ints, columns: Ints, dim: int) -> Floats:
    """See `plain.dense`."""
    found = np.zeros((*points.shape, dim, columns.shape[1]))
    matrices.dense(matrix.indptr, matrix.indices, matrix.data, points, columns, found)
    return found


def assembled(
    size: int,
    rows: Sequence[Floats],
    points: Sequence[Ints],
    places: Sequence[Indices],
    blocks: Sequence[Floats],
) -> Floats:
    """See `plain.assembled`."""
    data = np.zeros(size)
    for own, which, place, block in zip(rows, points, places, blocks, strict=True):
        matrices.add(data, own, which, place, block)
    return data


def rates(matrix: Sparse, dim: int, velocity: Floats) -> Floats:
    """See `plain.rates`."""
    found = np.empty((dim, matrix.shape[0] // dim))
    products.rates(
        matrix.indptr, matrix.indices, matrix.data, np.ascontiguousarray(velocity), found
    )
    return found


def forces(matrix: Sparse, parts: Floats) -> Floats:
    """See `plain.forces`."""
    force = np.zeros(matrix.shape[1])
    products.forces(matrix.indptr, matrix.indices, matrix.data, np.ascontiguousarray(parts), force)
    return force


def pulled(stack: Stack, stiff: Inverses, right: Floats, force: Floats) -> None:
    """See `plain.pulled`."""
    products.pulled(*_rows(stack), *_inverses(stiff), right, force)


def moved(stack: Stack, stiff: Inverses, right: Floats, x: Floats) -> None:
    """See `plain.moved`."""
    products.moved(*_rows(stack), *_inverses(stiff), right, x)


def times(stack: Stack, soft: Compliances, x: Floats, out: Floats) -> None:
    """See `plain.times`."""
    products.times(*_rows(stack), *_compliances(soft), x, out)


def along(stack: Stack, soft: Compliances, steep: float, left: Floats, x: Floats) -> None:
    """See `plain.along`."""
    compliances.along(stack.spans, *_compliances(soft), steep, left, x)


def inverted(stack: Stack, soft: Compliances, delta: Floats) -> Inverses:
    """See `plain.inverted`."""
    plain, one, two = np.empty((3, delta.size))
    turned = np.empty(soft.w.size)
    compliances.inverted(stack.spans, *_compliances(soft), delta, plain, one, two, turned)
    return Inverses(plain, one, two, turned, soft.first)


def blocks(stack: Stack, stiff: Inverses) -> list[Floats]:
    """See `plain.blocks`."""
    shapes = [(dim, dim, count) for dim, count, *_ in stack.spans.tolist()]
    ends = np.cumsum([0, *(a * b * c for a, b, c in shapes)])
    found = np.empty(ends[-1])
    compliances.blocks(stack.spans, *_inverses(stiff), found)
    return [found[a:b].reshape(shape) for a, b, shape in zip(ends, ends[1:], shapes, strict=False)]


def _rows(stack: Stack) -> tuple[Indices, Indices, Floats, Ints]:
    return stack.matrix.indptr, stack.matrix.indices, stack.matrix.data, stack.spans


def _compliances(soft: Compliances) -> tuple[Floats, Floats, Floats, Floats]:
    return soft.square, soft.rank, soft.first, soft.w


def _inverses(stiff: Inverses) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    return stiff.plain, stiff.one, stiff.two, stiff.first, stiff.w


def framed(values: Floats, vectors: Floats, a: Floats) -> Floats:
    """See `plain.framed`."""
    found = np.empty(a.shape)
    products.framed(values, vectors, a, found)
    return found


def frames(first: Scaling, others: Floats, slope: Floats, sheared: int) -> tuple[Floats, Floats]:
    """See `plain.frames`."""
    dim, count = sheared + slope.shape[1], slope.shape[2]
    values, vectors = np.empty((dim, count)), np.empty((count, dim, dim))
    principal.frames(first.square, first.w, others, slope, values, vectors)
    return values, vectors


def scaled(s: Floats, z: Floats) -> Scaling:
    """See `plain.scaled`."""
    square, w, middle = np.empty(s.shape[1]), np.empty(s.shape), np.empty(s.shape)
    cones.scaled(s, z, square, w, middle)
    return Scaling(square, w, middle)


def eliminated(
    scaling: Scaling, cost: Floats, rise: Floats, lead: Floats, tau: float
) -> Eliminated:
    """See `plain.eliminated`."""
    raised, by_tau, rank, slope = np.empty((4, cost.size))
    across = np.empty((scaling.w.shape[0] - 1, cost.size))
    at = scaling.square, scaling.w, cost, rise, lead, tau
    steps.eliminated(*at, raised, by_tau, across, rank, slope)
    return Eliminated(raised, by_tau, across, rank, slope)


def reduced(
    own: Eliminated, rise: Floats, height: Floats, missed: Floats, share: float, right: Floats
) -> Floats:
    """See `plain.reduced`."""
    lead = np.empty(rise.size)
    steps.reduced(own.raised, own.across, rise, height, missed, share, lead, right)
    return lead


def strained(
    scaling: Scaling,
    own: Eliminated,
    costs: tuple[Floats, Floats],
    given: tuple[Floats, Floats],
    tau: float,
    z: Floats,
) -> Floats:
    """See `plain.strained`."""
    found = np.empty_like(given[1])
    steps.strained(scaling.square, scaling.w, own.by_tau, own.across, *costs, *given, tau, z, found)
    return found


def flowed(scaling: Scaling, height: Floats, z: Floats) -> Floats:
    """See `plain.flowed`."""
    found = np.empty_like(height)
    steps.flowed(scaling.square, scaling.w, height, z, found)
    return found


def heights(scaling: Scaling, wanted: Floats) -> Floats:
    """See `plain.heights`."""
    found = np.empty(wanted.shape)
    cones.heights(scaling.square, scaling.w, scaling.middle, wanted, found)
    return found


def corrected(scaling: Scaling, ds: Floats, dz: Floats, mu: float) -> Floats:
    """See `plain.corrected`."""
    found = np.empty(ds.shape)
    cones.corrected(scaling.square, scaling.w, scaling.middle, ds, dz, mu, found)
    return found


def banded(
    scaling: Scaling, ds: Floats, dz: Floats, share: float, band: tuple[float, float]
) -> Floats:
    """See `plain.banded`."""
    found = np.empty(ds.shape)
    cones.banded(scaling.square, scaling.w, scaling.middle, ds, dz, share, *band, found)
    return found


def farthest(x: Floats, change: Floats) -> float:
    """See `plain.farthest`."""
    fastest = float(cones.fastest(x, change))
    return 1 / fastest if fastest > 0 else np.inf
