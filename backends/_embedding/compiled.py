"""Loops over points and elements that numba compiles, of the extra ``fast``.

ImportError where numba is not installed: `backends._embedding.plain` then does the same in NumPy.
"""

from collections.abc import Sequence

import numba
import numpy as np
from numba import njit

from backends._embedding.plain import Indices
from lacore.arrays import Floats, Ints, Sparse

name = f"numba {numba.__version__}"


def pattern(elements: Sequence[Ints], n: int) -> tuple[Indices, Indices, list[Indices]]:
    """See `backends._embedding.plain.pattern`."""
    sizes = [np.full(len(own), own.shape[1]) for own in elements]
    ends = np.cumsum(np.concatenate([np.zeros(1, dtype=np.int64), *sizes]))
    columns = np.concatenate([np.zeros(0, dtype=np.int64), *(own.ravel() for own in elements)])
    first, members = _members(columns, ends, n)
    starts, indices = _pattern(columns, ends, first, members, n)
    return starts, indices, [_places(own, starts, indices) for own in elements]


def assembled(
    size: int,
    rows: Sequence[Floats],
    points: Sequence[Ints],
    places: Sequence[Indices],
    blocks: Sequence[Floats],
) -> Floats:
    """See `backends._embedding.plain.assembled`."""
    data = np.zeros(size)
    for own, which, place, block in zip(rows, points, places, blocks, strict=True):
        _add(data, own, which, place, block)
    return data


def rates(matrix: Sparse, dim: int, velocity: Floats) -> Floats:
    """See `backends._embedding.plain.rates`."""
    found = np.empty((dim, matrix.shape[0] // dim))
    _rates(matrix.indptr, matrix.indices, matrix.data, np.ascontiguousarray(velocity), found)
    return found


def forces(matrix: Sparse, parts: Floats) -> Floats:
    """See `backends._embedding.plain.forces`."""
    force = np.zeros(matrix.shape[1])
    _forces(matrix.indptr, matrix.indices, matrix.data, np.ascontiguousarray(parts), force)
    return force


def both(matrix: Sparse, velocity: Floats, parts: Floats, force: Floats, found: Floats) -> None:
    """See `backends._embedding.plain.both`."""
    own = matrix.indptr, matrix.indices, matrix.data
    _both(*own, np.ascontiguousarray(velocity), np.ascontiguousarray(parts), force, found)


def stretched(scale: Floats, share: Floats, w: Floats, z: Floats) -> Floats:
    """See `backends._embedding.plain.stretched`."""
    found = np.empty(z.shape)
    _stretched(scale, share, w, z, found)
    return found


def farthest(x: Floats, change: Floats) -> float:
    """See `backends._embedding.plain.farthest`."""
    fastest = float(_fastest(x, change))
    return 1 / fastest if fastest > 0 else np.inf


@njit(cache=True)
def _rates(starts, columns, data, velocity, found):  # type: ignore[no-untyped-def]
    dim, count = found.shape
    for m in range(count):
        for i in range(dim):
            total = 0.0
            for at in range(starts[m * dim + i], starts[m * dim + i + 1]):
                total += data[at] * velocity[columns[at]]
            found[i, m] = total


@njit(cache=True)
def _forces(starts, columns, data, parts, force):  # type: ignore[no-untyped-def]
    dim, count = parts.shape
    for m in range(count):
        for i in range(dim):
            part = parts[i, m]
            for at in range(starts[m * dim + i], starts[m * dim + i + 1]):
                force[columns[at]] += data[at] * part


@njit(cache=True)
def _both(starts, columns, data, velocity, parts, force, found):  # type: ignore[no-untyped-def]
    dim, count = parts.shape
    for m in range(count):
        for i in range(dim):
            part, total = parts[i, m], 0.0
            for at in range(starts[m * dim + i], starts[m * dim + i + 1]):
                force[columns[at]] += data[at] * part
                total += data[at] * velocity[columns[at]]
            found[i, m] = total


@njit(cache=True)
def _stretched(scale, share, w, z, found):  # type: ignore[no-untyped-def]
    dim, count = z.shape
    for m in range(count):
        along = 0.0
        for i in range(dim):
            along += w[i, m] * z[i, m]
        along *= share[m]
        for i in range(dim):
            found[i, m] = scale[m] * (z[i, m] + along * w[i, m])


@njit(cache=True, error_model="numpy")
def _fastest(x, change):  # type: ignore[no-untyped-def]
    dim, count = x.shape
    fastest = 0.0
    for m in range(count):
        length = 0.0
        for i in range(1, dim):
            length += x[i, m] * x[i, m]
        length = np.sqrt(length)
        size = np.sqrt((x[0, m] - length) * (x[0, m] + length))
        lead, rate = x[0, m] / size, change[0, m] / size
        along = lead * rate
        for i in range(1, dim):
            along -= x[i, m] / size * (change[i, m] / size)
        share = (along + rate) / (lead + 1)
        across = 0.0
        for i in range(1, dim):
            rest = change[i, m] / size - share * (x[i, m] / size)
            across += rest * rest
        speed = np.sqrt(across) - along
        if np.isnan(speed):
            return speed
        fastest = max(fastest, speed)
    return fastest


@njit(cache=True)
def _members(columns, ends, n):  # type: ignore[no-untyped-def]
    """Which elements have an unknown, one after the other."""
    first = np.zeros(n + 1, np.int64)
    for column in columns:
        first[column + 1] += 1
    for i in range(n):
        first[i + 1] += first[i]
    free, members = first[:-1].copy(), np.empty(columns.size, np.int64)
    for e in range(ends.size - 1):
        for at in range(ends[e], ends[e + 1]):
            members[free[columns[at]]] = e
            free[columns[at]] += 1
    return first, members


@njit(cache=True)
def _pattern(columns, ends, first, members, n):  # type: ignore[no-untyped-def]
    """Starts and columns of the upper triangle, its diagonal in it."""
    seen = np.full(n, -1, np.int64)
    starts = np.zeros(n + 1, np.int32)
    indices = np.empty(0, np.int32)
    for turn in range(2):
        if turn:
            indices = np.empty(starts[n], np.int32)
        count = 0
        for i in range(n):
            begin = count
            seen[i] = i + turn * n
            if turn:
                indices[count] = i
            count += 1
            for place in range(first[i], first[i + 1]):
                e = members[place]
                for at in range(ends[e], ends[e + 1]):
                    j = columns[at]
                    if j > i and seen[j] != i + turn * n:
                        seen[j] = i + turn * n
                        if turn:
                            indices[count] = j
                        count += 1
            if turn:
                indices[begin:count].sort()
            starts[i + 1] = count
    return starts, indices


@njit(cache=True)
def _places(columns, starts, indices):  # type: ignore[no-untyped-def]
    """Of the upper triangles of elements, whose columns ascend, shape (e, c (c + 1)/2)."""
    elements, width = columns.shape
    places = np.empty((elements, width * (width + 1) // 2), np.int32)
    for e in range(elements):
        pair = 0
        for a in range(width):
            i = columns[e, a]
            at = starts[i]
            for b in range(a, width):
                while indices[at] != columns[e, b]:
                    at += 1
                places[e, pair] = at
                pair += 1
    return places


@njit(cache=True)
def _add(data, rows, points, places, block):  # type: ignore[no-untyped-def]
    """Add ``sum R^T M R`` of elements, rows of shape (e, k, dim, c)."""
    elements, count, dim, width = rows.shape
    times = np.empty((dim, width))
    own = np.empty(width * (width + 1) // 2)
    for e in range(elements):
        own[:] = 0.0
        for k in range(count):
            point = points[e, k]
            for i in range(dim):
                for a in range(width):
                    times[i, a] = 0.0
                for j in range(dim):
                    value = block[i, j, point]
                    for a in range(width):
                        times[i, a] += value * rows[e, k, j, a]
            for i in range(dim):
                pair = 0
                for a in range(width):
                    value = rows[e, k, i, a]
                    for b in range(width - a):
                        own[pair + b] += value * times[i, a + b]
                    pair += width - a
        for pair in range(own.size):
            data[places[e, pair]] += own[pair]
