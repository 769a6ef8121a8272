"""Compiled steps of cones: see `lacore_backends._embedding.loops.plain`."""

from numba import njit


@njit(cache=True, error_model="numpy")
def eliminated(square, w, cost, rise, lead, tau, raised, by_tau, across, rank, slope):  # type: ignore[no-untyped-def]
    dim, count = w.shape
    for m in range(count):
        size = 0.0
        for i in range(1, dim):
            size += w[i, m] * w[i, m]
        both = square[m] * (2 * w[0, m] * w[0, m] - 1)
        more, by = 1 + both * rise[m], square[m] * rise[m]
        raised[m], by_tau[m] = more, -both * cost[m] / more
        rank[m] = 2 * (1 - by) / (1 + (1 + 2 * size) * by)
        slope[m] = cost[m] + rise[m] * lead[m] * (2 / tau)
        share = 2 * square[m] * w[0, m] / more
        for i in range(1, dim):
            across[i - 1, m] = share * w[i, m]


@njit(cache=True, error_model="numpy")
def reduced(raised, across, rise, height, missed, share, lead, right):  # type: ignore[no-untyped-def]
    dim, count = across.shape
    for m in range(count):
        lead[m] = height[0, m] / raised[m]
        own = rise[m] * height[0, m]
        for i in range(dim):
            right[i, m] = height[1 + i, m] - own * across[i, m] - share * missed[i, m]


@njit(cache=True)
def strained(square, w, by_tau, across, cost, rise, given, height, tau, z, found):  # type: ignore[no-untyped-def]
    dim, count = z.shape
    for m in range(count):
        lead, along = given[m] + by_tau[m] * tau, 0.0
        for i in range(dim):
            lead -= across[i, m] * z[i, m]
            along += w[1 + i, m] * z[i, m]
        along = 2 * (along + w[0, m] * (cost[m] * tau + rise[m] * lead))
        found[0, m] = lead
        for i in range(dim):
            found[1 + i, m] = height[1 + i, m] - square[m] * (z[i, m] + along * w[1 + i, m])


@njit(cache=True)
def flowed(square, w, height, z, found):  # type: ignore[no-untyped-def]
    dim, count = z.shape
    for m in range(count):
        along = 0.0
        for i in range(dim):
            along += w[i, m] * z[i, m]
        for i in range(dim):
            part = -z[i, m] if i == 0 else z[i, m]
            found[i, m] = height[i, m] - square[m] * (part + 2 * along * w[i, m])
