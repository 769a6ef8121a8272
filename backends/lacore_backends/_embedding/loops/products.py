"""Compiled products with sparse rows of points.

For signed indices numba checks whether they count from the end, which doubles the time of a
product.
"""

import numpy as np
from numba import njit


@njit(cache=True)
def _span(starts, row):  # type: ignore[no-untyped-def]
    return range(np.uintp(starts[row]), np.uintp(starts[row + 1]))


@njit(cache=True)
def rates(starts, columns, data, velocity, found):  # type: ignore[no-untyped-def]
    dim, count = found.shape
    for m in range(count):
        for i in range(dim):
            total = 0.0
            for at in _span(starts, m * dim + i):
                total += data[at] * velocity[np.uintp(columns[at])]
            found[i, m] = total


@njit(cache=True)
def forces(starts, columns, data, parts, force):  # type: ignore[no-untyped-def]
    dim, count = parts.shape
    for m in range(count):
        for i in range(dim):
            part = parts[i, m]
            for at in _span(starts, m * dim + i):
                force[np.uintp(columns[at])] += data[at] * part


@njit(cache=True)
def _inverted(plain, one, two, w, first, a, found):  # type: ignore[no-untyped-def]
    """See `lacore_backends._embedding.cones.Inverse.times`."""
    dim, count = a.shape
    for m in range(count):
        along = 0.0
        for i in range(1, dim):
            along += w[i, m] * a[i, m]
        if first > 0:
            along = one[m] * (along + w[0, m] * a[0, m])
            for i in range(dim):
                found[i, m] = plain[m] * (a[i, m] + along * w[i, m])
        else:
            high, low = one[m] * ((a[0, m] + along) / 2), two[m] * ((a[0, m] - along) / 2)
            found[0, m] = high + low
            for i in range(1, dim):
                found[i, m] = plain[m] * (a[i, m] - along * w[i, m]) + (high - low) * w[i, m]


@njit(cache=True)
def pulled(starts, columns, data, spans, plain, one, two, first, w, right, force):  # type: ignore[no-untyped-def]
    for k in range(spans.shape[0]):
        dim, count, row, point, place = spans[k]
        if count == 0:
            continue
        rows, points = slice(row, row + dim * count), slice(point, point + count)
        a = right[place : place + dim * count].reshape(dim, count)
        parts, own = np.empty((dim, count)), w[rows].reshape(dim, count)
        _inverted(plain[points], one[points], two[points], own, first[k], a, parts)
        forces(starts[row:], columns, data, parts, force)


@njit(cache=True)
def moved(starts, columns, data, spans, plain, one, two, first, w, right, x):  # type: ignore[no-untyped-def]
    for k in range(spans.shape[0]):
        dim, count, row, point, place = spans[k]
        if count == 0:
            continue
        rows, points = slice(row, row + dim * count), slice(point, point + count)
        a = right[place : place + dim * count].reshape(dim, count)
        z = x[place : place + dim * count].reshape(dim, count)
        rest, own = np.empty((dim, count)), w[rows].reshape(dim, count)
        rates(starts[row:], columns, data, x, rest)
        for i in range(dim):
            for m in range(count):
                rest[i, m] = a[i, m] - rest[i, m]
        _inverted(plain[points], one[points], two[points], own, first[k], rest, z)


@njit(cache=True)
def framed(values, vectors, a, found):  # type: ignore[no-untyped-def]
    dim, count = a.shape
    for m in range(count):
        for i in range(dim):
            found[i, m] = 0.0
        for j in range(dim):
            along = 0.0
            for i in range(dim):
                along += vectors[m, i, j] * a[i, m]
            along *= values[j, m]
            for i in range(dim):
                found[i, m] += vectors[m, i, j] * along


@njit(cache=True)
def _times(starts, columns, data, u, z, square, rank, first, w, force, found):  # type: ignore[no-untyped-def]
    dim, count = z.shape
    for m in range(count):
        along = 0.0
        for i in range(dim):
            along += w[i, m] * z[i, m]
        along *= rank[m]
        for i in range(dim):
            part = z[i, m]
            sign = first if i == 0 else 1.0
            total = 0.0
            for at in _span(starts, m * dim + i):
                force[np.uintp(columns[at])] += data[at] * part
                total += data[at] * u[np.uintp(columns[at])]
            found[i, m] += total + square[m] * (sign * part + along * w[i, m])


@njit(cache=True)
def times(starts, columns, data, spans, square, rank, first, w, x, out):  # type: ignore[no-untyped-def]
    for k in range(spans.shape[0]):
        dim, count, row, point, place = spans[k]
        if count == 0:
            continue
        rows, points = slice(row, row + dim * count), slice(point, point + count)
        z = x[place : place + dim * count].reshape(dim, count)
        found = out[place : place + dim * count].reshape(dim, count)
        own = w[rows].reshape(dim, count)
        _times(
            starts[row:],
            columns,
            data,
            x,
            z,
            square[points],
            rank[points],
            first[k],
            own,
            out,
            found,
        )
