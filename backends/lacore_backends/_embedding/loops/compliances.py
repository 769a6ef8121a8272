"""Compiled loops over compliances and their inverses.

See `lacore_backends._embedding.cones.Compliance` and `lacore_backends._embedding.cones.Inverse`;
`spans` is explained in `lacore_backends._embedding.loops.stack.Stack`.
"""

import numpy as np
from numba import njit

_TINY = np.finfo(np.float64).tiny


@njit(cache=True, error_model="numpy")
def along(spans, square, rank, first, w, steep, left, x):  # type: ignore[no-untyped-def]
    for k in range(spans.shape[0]):
        dim, count, row, point, place = spans[k]
        if first[k] < 0 and dim == 1:
            continue
        for m in range(count):
            size = rate = 0.0
            for i in range(0 if first[k] > 0 else 1, dim):
                at = i * count + m
                size += w[row + at] * w[row + at]
                rate += w[row + at] * left[place + at]
            if first[k] > 0:
                if size > steep:
                    share = rate / (square[point + m] * (1 + rank[point + m] * size) * size)
                    for i in range(dim):
                        x[place + i * count + m] += share * w[row + i * count + m]
            elif w[row + m] * w[row + m] > steep:
                size = max(np.sqrt(size), _TINY)
                high = w[row + m] + size
                share = (left[place + m] + rate / size) / (2 * square[point + m] * high * high)
                x[place + m] += share
                for i in range(1, dim):
                    x[place + i * count + m] += share * w[row + i * count + m] / size


@njit(cache=True, error_model="numpy")
def inverted(spans, square, rank, first, w, delta, plain, one, two, turned):  # type: ignore[no-untyped-def]
    for k in range(spans.shape[0]):
        dim, count, row, point, _ = spans[k]
        for m in range(count):
            own, more, size = square[point + m], delta[point + m], 0.0
            by = 1 / (own + more)
            plain[point + m] = by
            for i in range(0 if first[k] > 0 else 1, dim):
                size += w[row + i * count + m] * w[row + i * count + m]
            per = 1.0
            if first[k] > 0:
                stiff = 1 / (own * (1 + rank[point + m] * size) + more)
                one[point + m], two[point + m] = (stiff / by - 1) / max(size, _TINY), 0.0
            elif dim == 1:
                one[point + m] = two[point + m] = by
            else:
                size = np.sqrt(size)
                high = (w[row + m] + size) * (w[row + m] + size)
                one[point + m], two[point + m] = 1 / (own * high + more), 1 / (own / high + more)
                per = max(size, _TINY)
            for i in range(dim):
                turned[row + i * count + m] = w[row + i * count + m] / per


@njit(cache=True)
def blocks(spans, plain, one, two, first, w, found):  # type: ignore[no-untyped-def]
    begin = 0
    for k in range(spans.shape[0]):
        dim, count, row, point, _ = spans[k]
        for i in range(dim):
            for j in range(dim):
                to = begin + (i * dim + j) * count
                for m in range(count):
                    own = plain[point + m]
                    both = (one[point + m] + two[point + m]) / 2
                    across = (one[point + m] - two[point + m]) / 2
                    if first[k] > 0:
                        rank, rest = own * one[point + m], own
                    else:
                        rank, rest = both - own, own
                    value = rank * w[row + i * count + m] * w[row + j * count + m]
                    if i == j:
                        value += rest
                    if first[k] < 0 and (i == 0 or j == 0):
                        value = both if i == j else across * w[row + max(i, j) * count + m]
                    found[to + m] = value
        begin += dim * dim * count
