"""Compiled loops over cones: see `lacore_backends._embedding.cones`."""

import numpy as np
from numba import njit


@njit(cache=True, error_model="numpy")
def _turned(m, root, sign, w, x, at, found):  # type: ignore[no-untyped-def]
    """Compute ``W x`` of a column, or ``W^-1 x`` if root and sign are those of the inverse."""
    across = 0.0
    for i in range(1, found.size):
        across += w[i, m] * x[i, at]
    found[0] = root * (w[0, m] * x[0, at] + sign * across)
    share = sign * x[0, at] + across / (1 + w[0, m])
    for i in range(1, found.size):
        found[i] = root * (x[i, at] + share * w[i, m])


@njit(cache=True, error_model="numpy")
def scaled(s, z, square, w, middle):  # type: ignore[no-untyped-def]
    dim, count = s.shape
    own = np.empty(dim)
    for m in range(count):
        s_size = z_size = 0.0
        for i in range(1, dim):
            s_size += s[i, m] * s[i, m]
            z_size += z[i, m] * z[i, m]
        s_size, z_size = np.sqrt(s_size), np.sqrt(z_size)
        s_size = np.sqrt((s[0, m] - s_size) * (s[0, m] + s_size))
        z_size = np.sqrt((z[0, m] - z_size) * (z[0, m] + z_size))
        inner = 0.0
        for i in range(dim):
            inner += s[i, m] / s_size * (z[i, m] / z_size)
        twice, size = 2 * np.sqrt((1 + inner) / 2), 0.0
        for i in range(1, dim):
            w[i, m] = (s[i, m] / s_size - z[i, m] / z_size) / twice
            size += w[i, m] * w[i, m]
        w[0, m] = np.sqrt(1 + size)
        square[m] = s_size / z_size
        _turned(m, np.sqrt(square[m]), 1.0, w, z, m, own)
        for i in range(dim):
            middle[i, m] = own[i]


@njit(cache=True, error_model="numpy")
def heights(square, w, middle, products, found):  # type: ignore[no-untyped-def]
    dim, count = products.shape
    quotient, own = np.empty((dim, 1)), np.empty(dim)
    for m in range(count):
        length = inner = 0.0
        for i in range(1, dim):
            length += middle[i, m] * middle[i, m]
            inner += middle[i, m] * products[i, m]
        length = np.sqrt(length)
        lead = middle[0, m]
        quotient[0, 0] = (lead * products[0, m] - inner) / ((lead - length) * (lead + length))
        for i in range(1, dim):
            quotient[i, 0] = (products[i, m] - quotient[0, 0] * middle[i, m]) / lead
        _turned(m, np.sqrt(square[m]), 1.0, w, quotient, 0, own)
        for i in range(dim):
            found[i, m] = own[i]


@njit(cache=True, error_model="numpy")
def corrected(square, w, middle, ds, dz, mu, found):  # type: ignore[no-untyped-def]
    dim, count = ds.shape
    slack, multiplier = np.empty(dim), np.empty(dim)
    for m in range(count):
        root = np.sqrt(square[m])
        _turned(m, 1 / root, -1.0, w, ds, m, slack)
        _turned(m, root, 1.0, w, dz, m, multiplier)
        lead, first = slack[0] * multiplier[0], middle[0, m]
        lead += first * first
        for i in range(1, dim):
            lead += slack[i] * multiplier[i] + middle[i, m] * middle[i, m]
            other = slack[0] * multiplier[i] + multiplier[0] * slack[i]
            found[i, m] = -other - 2 * first * middle[i, m]
        found[0, m] = mu - lead


@njit(cache=True, error_model="numpy")
def banded(square, w, middle, ds, dz, share, least, most, found):  # type: ignore[no-untyped-def]
    dim, count = ds.shape
    slack, multiplier = np.empty(dim), np.empty(dim)
    for m in range(count):
        root = np.sqrt(square[m])
        _turned(m, 1 / root, -1.0, w, ds, m, slack)
        _turned(m, root, 1.0, w, dz, m, multiplier)
        lead = 0.0
        for i in range(dim):
            slack[i] = middle[i, m] + share * slack[i]
            multiplier[i] = middle[i, m] + share * multiplier[i]
            lead += slack[i] * multiplier[i]
        length = 0.0
        for i in range(1, dim):
            found[i, m] = slack[0] * multiplier[i] + multiplier[0] * slack[i]
            length += found[i, m] * found[i, m]
        length = np.sqrt(length)
        low, high = lead - length, lead + length
        down = max(min(max(low, least), most) - low, -most)
        up = max(min(max(high, least), most) - high, -most)
        found[0, m] = (up + down) / 2
        turn = (up - down) / 2 / max(length, np.finfo(np.float64).tiny)
        for i in range(1, dim):
            found[i, m] *= turn


@njit(cache=True, error_model="numpy")
def fastest(x, change):  # type: ignore[no-untyped-def]
    dim, count = x.shape
    fastest = 0.0
    for m in range(count):
        length = 0.0
        for i in range(1, dim):
            length += x[i, m] * x[i, m]
        length = np.sqrt(length)
        per = 1 / np.sqrt((x[0, m] - length) * (x[0, m] + length))
        lead, rate = x[0, m] * per, change[0, m] * per
        along = lead * rate
        for i in range(1, dim):
            along -= x[i, m] * per * (change[i, m] * per)
        share = (along + rate) / (lead + 1)
        across = 0.0
        for i in range(1, dim):
            rest = change[i, m] * per - share * (x[i, m] * per)
            across += rest * rest
        speed = np.sqrt(across) - along
        if np.isnan(speed):
            return speed
        fastest = max(fastest, speed)
    return fastest
