"""Compiled patterns and sums of matrices of elements."""

import numpy as np
from numba import njit

_FEW = 48  # Up to this number columns are inserted in order; more are sorted.


@njit(cache=True)
def touched(starts, columns, dim, n):  # type: ignore[no-untyped-def]
    """Return the columns of all rows of each point, without repetition, ascending."""
    count = (starts.size - 1) // dim
    ends, found = np.zeros(count + 1, np.int32), np.empty(columns.size, np.int32)
    seen = np.full(n, -1, np.int64)
    end = 0
    for m in range(count):
        begin = end
        for at in range(starts[m * dim], starts[(m + 1) * dim]):
            column = columns[at]
            if seen[column] == m:
                continue
            seen[column] = m
            place = end
            while place > begin and found[place - 1] > column:
                found[place] = found[place - 1]
                place -= 1
            found[place] = column
            end += 1
        ends[m + 1] = end
    return ends, found[:end]


@njit(cache=True)
def dense(starts, columns, data, points, wide, found):  # type: ignore[no-untyped-def]
    """Fill the rows of points, shape (e, k, dim, c), by the columns of their elements."""
    elements, count, dim, _ = found.shape
    for e in range(elements):
        for k in range(count):
            for i in range(dim):
                row = points[e, k] * dim + i
                for at in range(starts[row], starts[row + 1]):
                    place = 0
                    while wide[e, place] != columns[at]:
                        place += 1
                    found[e, k, i, place] = data[at]


@njit(cache=True)
def members(columns, ends, n):  # type: ignore[no-untyped-def]
    """Return which elements have each unknown, joined."""
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
def pattern(columns, ends, first, members, n):  # type: ignore[no-untyped-def]
    """Return the starts and columns of the upper triangle, including the diagonal."""
    seen = np.full(n, -1, np.int64)
    starts, most = np.zeros(n + 1, np.int32), n
    for e in range(ends.size - 1):
        width = ends[e + 1] - ends[e]
        most += width * (width - 1) // 2
    indices = np.empty(most, np.int32)
    count = 0
    for i in range(n):
        begin = count
        seen[i] = i
        indices[count] = i
        count += 1
        for at_member in range(first[i], first[i + 1]):
            e = members[at_member]
            for at in range(ends[e], ends[e + 1]):
                j = columns[at]
                if j > i and seen[j] != i:
                    seen[j] = i
                    place = count
                    while count - begin < _FEW and indices[place - 1] > j:
                        indices[place] = indices[place - 1]
                        place -= 1
                    indices[place] = j
                    count += 1
        if count - begin > _FEW:
            indices[begin:count].sort()
        starts[i + 1] = count
    return starts, indices[:count].copy()


@njit(cache=True)
def places(columns, starts, indices):  # type: ignore[no-untyped-def]
    """Return the places of the upper triangles of elements, shape (e, c (c + 1)/2).

    The columns of each element ascend.
    """
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
def add(data, rows, points, places, block):  # type: ignore[no-untyped-def]
    """Add ``sum R^T M R`` of elements, rows of shape (e, k, dim, c)."""
    elements, count, dim, width = rows.shape
    times, own = np.empty(width), np.empty((width, width))
    for e in range(elements):
        own[:] = 0.0
        for k in range(count):
            point = np.uintp(points[e, k])
            for i in range(dim):
                times[:] = 0.0
                for j in range(dim):
                    value = block[i, j, point]
                    for a in range(width):
                        times[a] += value * rows[e, k, j, a]
                # A loop of constant length over the whole matrix is a quarter faster than one over
                # a triangle.
                for a in range(width):
                    value = rows[e, k, i, a]
                    for b in range(width):
                        own[a, b] += value * times[b]
        pair = 0
        for a in range(width):
            for b in range(a, width):
                data[np.uintp(places[e, pair])] += own[a, b]
                pair += 1
