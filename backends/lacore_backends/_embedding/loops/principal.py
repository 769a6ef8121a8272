"""Compiled computation of principal directions of the stiffness left by planes."""

import numpy as np
from numba import njit

_SWEEPS = 30  # limit: Jacobi's method converges within a few
_ROUND = 1e-14  # cosine that is zero except for round-off


@njit(cache=True, error_model="numpy")
def _triangle(rows, dim):  # type: ignore[no-untyped-def]
    """Reduce rows to R by Householder reflections, stored in the first rows."""
    count = rows.shape[0]
    for j in range(dim):
        size = 0.0
        for i in range(j, count):
            size += rows[i, j] * rows[i, j]
        size = np.sqrt(size)
        if size == 0.0:
            continue
        lead = rows[j, j]
        end = -size if lead > 0 else size
        first = lead - end
        for c in range(j + 1, dim):
            along = first * rows[j, c]
            for i in range(j + 1, count):
                along += rows[i, j] * rows[i, c]
            along /= -end * first
            rows[j, c] -= along * first
            for i in range(j + 1, count):
                rows[i, c] -= along * rows[i, j]
        rows[j, j] = end
        for i in range(j + 1, count):
            rows[i, j] = 0.0


@njit(cache=True, error_model="numpy")
def _turned(rows, turn, dim):  # type: ignore[no-untyped-def]
    """Make columns orthogonal by Jacobi rotations, which are accumulated in `turn`."""
    for _ in range(_SWEEPS):
        done = True
        for a in range(dim - 1):
            for b in range(a + 1, dim):
                one = other = both = 0.0
                for i in range(dim):
                    one += rows[i, a] * rows[i, a]
                    other += rows[i, b] * rows[i, b]
                    both += rows[i, a] * rows[i, b]
                if not np.abs(both) > _ROUND * np.sqrt(one * other):
                    continue
                done = False
                slope = (other - one) / (2 * both)
                tangent = 1 / (np.abs(slope) + np.sqrt(1 + slope * slope))
                if slope < 0:
                    tangent = -tangent
                cosine = 1 / np.sqrt(1 + tangent * tangent)
                sine = cosine * tangent
                for i in range(dim):
                    x, y = rows[i, a], rows[i, b]
                    rows[i, a], rows[i, b] = cosine * x - sine * y, sine * x + cosine * y
                    x, y = turn[i, a], turn[i, b]
                    turn[i, a], turn[i, b] = cosine * x - sine * y, sine * x + cosine * y
        if done:
            break


@njit(cache=True, error_model="numpy")
def frames(square, w, others, slope, values, vectors):  # type: ignore[no-untyped-def]
    planes, volumes, count = slope.shape
    dim = values.shape[0]
    sheared, normed = dim - volumes, square.size // count
    size = normed * (1 + sheared) + planes - normed
    rows, turn = np.empty((max(size, dim), dim)), np.empty((dim, dim))
    for m in range(count):
        rows[:] = 0.0
        for k in range(normed):
            at, first = k * count + m, k * (1 + sheared)
            root, lead = np.sqrt(square[at]), w[0, k * count + m]
            for j in range(sheared):
                own = root * w[1 + j, at]
                rows[first, j] = own
                for i in range(sheared):
                    rows[first + 1 + i, j] = own / (1 + lead) * w[1 + i, at]
                rows[first + 1 + j, j] += root
            for j in range(volumes):
                by = root * slope[k, j, m]
                rows[first, sheared + j] = by * lead
                for i in range(sheared):
                    rows[first + 1 + i, sheared + j] = by * w[1 + i, at]
        for k in range(normed, planes):
            root = np.sqrt(others[(k - normed) * count + m])
            for j in range(volumes):
                rows[normed * sheared + k, sheared + j] = root * slope[k, j, m]
        _triangle(rows, dim)
        turn[:] = 0.0
        for i in range(dim):
            turn[i, i] = 1.0
        _turned(rows, turn, dim)
        for j in range(dim):
            length = 0.0
            for i in range(dim):
                length += rows[i, j] * rows[i, j]
                vectors[m, i, j] = turn[i, j]
            values[j, m] = length
