"""Loops over points and elements that numba compiles, of the extra ``fast``.

ImportError where numba is not installed: `plain` then does the same in NumPy.
"""

from collections.abc import Sequence

import numba
import numpy as np

from backends._embedding.cones import Compliance, Inverse, Scaling
from backends._embedding.loops import cones, matrices, principal, products
from backends._embedding.loops.plain import Indices
from lacore.arrays import Floats, Ints, Sparse

name = f"numba {numba.__version__}"


def pattern(elements: Sequence[Ints], n: int) -> tuple[Indices, Indices, list[Indices]]:
    """See `plain.pattern`."""
    sizes = [np.full(len(own), own.shape[1]) for own in elements]
    ends = np.cumsum(np.concatenate([np.zeros(1, dtype=np.int64), *sizes]))
    columns = np.concatenate([np.zeros(0, dtype=np.int64), *(own.ravel() for own in elements)])
    first, members = matrices.members(columns, ends, n)
    starts, indices = matrices.pattern(columns, ends, first, members, n)
    return starts, indices, [matrices.places(own, starts, indices) for own in elements]


def touched(matrix: Sparse, dim: int) -> tuple[Indices, Indices]:
    """See `plain.touched`."""
    return matrices.touched(matrix.indptr, matrix.indices, dim, matrix.shape[1])


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


def pulled(matrix: Sparse, stiff: Inverse, a: Floats, force: Floats) -> None:
    """See `plain.pulled`."""
    own = stiff.plain, stiff.one, stiff.two, stiff.w, stiff.first
    products.pulled(matrix.indptr, matrix.indices, matrix.data, *own, a, force)


def moved(matrix: Sparse, stiff: Inverse, u: Floats, a: Floats, z: Floats) -> None:
    """See `plain.moved`."""
    own = stiff.plain, stiff.one, stiff.two, stiff.w, stiff.first
    products.moved(matrix.indptr, matrix.indices, matrix.data, *own, u, a, z)


def times(
    matrix: Sparse, u: Floats, z: Floats, soft: Compliance, force: Floats, found: Floats
) -> None:
    """See `plain.times`."""
    own = matrix.indptr, matrix.indices, matrix.data
    products.times(*own, u, z, soft.square, soft.rank, soft.first, soft.w, force, found)


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


def along(soft: Compliance, free: float, rates: Floats, z: Floats) -> None:
    """See `plain.along`."""
    cones.along(soft.square, soft.rank, soft.w, free, rates, z)


def scaled(s: Floats, z: Floats) -> Scaling:
    """See `plain.scaled`."""
    square, w, middle = np.empty(s.shape[1]), np.empty(s.shape), np.empty(s.shape)
    cones.scaled(s, z, square, w, middle)
    return Scaling(square, w, middle)


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
