"""Integrals over straight elements for the checks, independent of lacore."""

import numpy as np

from lacore.numerics.arrays import Floats, Ints

_LINE, _SHARE = np.polynomial.legendre.leggauss(4)
_LINE, _SHARE = (_LINE + 1) / 2, _SHARE / 2  # Points and weights on [0, 1].


def in_triangles(points: Floats, cells: Ints) -> tuple[Floats, Floats]:
    """Return places (2, cells, q) and weights (cells, q), exact to degree 6, by folded squares."""
    u, v = np.meshgrid(_LINE, _LINE)
    share = np.outer(_SHARE, _SHARE)
    first, second = u.ravel(), (v * (1 - u)).ravel()
    weight = (share * (1 - u)).ravel()
    a, b, c = (points[:, cells[i]] for i in range(3))
    ab, ac = b - a, c - a
    places = a[:, :, None] + ab[:, :, None] * first + ac[:, :, None] * second
    twice = np.abs(ab[0] * ac[1] - ab[1] * ac[0])
    return places, twice[:, None] * weight


def in_cells(points: Floats, cells: Ints) -> tuple[Floats, Floats]:
    """Return the same for triangles, or for convex quadrilaterals as two triangles each."""
    if len(cells) == 3:
        return in_triangles(points, cells)
    halves = (in_triangles(points, cells[[0, i, i + 1]]) for i in (1, 2))
    places, weights = zip(*halves, strict=True)
    return np.concatenate(places, axis=2), np.concatenate(weights, axis=1)


def on_edges(start: Floats, end: Floats) -> tuple[Floats, Floats]:
    """Return places (2, n, q) and weights (n, q) on straight edges, exact to degree 7."""
    places = start[:, :, None] + (end - start)[:, :, None] * _LINE
    return places, np.linalg.norm(end - start, axis=0)[:, None] * _SHARE
