"""Loops over points and elements in NumPy, equivalent to those of `compiled`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_matrix

from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore_backends._embedding.cones import (
    Compliance,
    Compliances,
    Eliminated,
    Inverses,
    Scaling,
    clipped,
    determinant,
    inner,
    lengths,
    product,
    quotient,
)
from lacore_backends._embedding.loops.stack import Stack

name = "NumPy"
Indices = npt.NDArray[np.int32]  # type of the indices of matrices for PARDISO


def pattern(elements: Sequence[Ints], n: int) -> tuple[Indices, Indices, list[Indices]]:
    """Return the pattern of the upper triangle of a matrix summed over elements.

    The diagonal is always included.

    Args:
        elements: unknowns of elements with equal numbers of them, shape (e, c), ascending.
        n: number of unknowns.

    Returns:
        Starts and columns of the rows, shape (n + 1,) and (nonzero,), and the places of the upper
        triangles of the elements, row by row, shape (e, c (c + 1)/2) each.
    """
    # Combine row and column of each entry in one number, in the order of a sparse matrix.
    keys = [np.arange(n, dtype=np.int64) * (n + 1)]
    for own in elements:
        row, column = np.triu_indices(own.shape[1])
        keys.append((own[:, row] * n + own[:, column]).ravel())
    every = np.concatenate(keys)
    order = np.argsort(every)
    ascending = every[order]
    new = np.append(True, ascending[1:] > ascending[:-1])
    places = np.empty(every.size, dtype=np.int32)
    places[order] = np.cumsum(new) - 1
    row, column = np.divmod(ascending[new], n)
    starts = np.searchsorted(row, np.arange(n + 1)).astype(np.int32)
    ends = np.cumsum([key.size for key in keys])
    parts = np.split(places, ends[:-1])[1:]
    shaped = [part.reshape(len(own), -1) for part, own in zip(parts, elements, strict=True)]
    return starts, column.astype(np.int32), shaped


def touched(starts: Indices, columns: Indices, dim: int, n: int) -> tuple[Indices, Indices]:
    """Return the unknowns of each point, ascending, for points of `dim` rows each.

    Returns:
        Starts, shape (m + 1,), and unknowns.
    """
    row = np.repeat(np.arange(starts.size - 1) // dim, np.diff(starts))
    every = np.unique(row * n + columns[: starts[-1]])
    point, found = np.divmod(every, n)
    ends = np.searchsorted(point, np.arange((starts.size - 1) // dim + 1))
    return ends.astype(np.int32), found.astype(np.int32)


def dense(matrix: Sparse, points: Ints, columns: Ints, dim: int) -> Floats:
    """Return the rows of points, shape (e, k), by columns, shape (e, c).

    The shape is (e, k, dim, c).
    """
    elements, size = points.shape
    width = columns.shape[1]
    every = (points[:, :, None] * dim + np.arange(dim)).ravel()
    picked = csr_matrix(matrix[every])
    at = np.repeat(np.arange(every.size), np.diff(picked.indptr))
    element = at // (size * dim)
    keys = (np.arange(elements)[:, None] * (int(matrix.shape[1]) + 1) + columns).ravel()
    place = np.searchsorted(keys, element * (int(matrix.shape[1]) + 1) + picked.indices)
    found = np.zeros((every.size, width))
    found[at, place - element * width] = picked.data
    return found.reshape(elements, size, dim, width)


def assembled(
    size: int,
    rows: Sequence[Floats],
    points: Sequence[Ints],
    places: Sequence[Indices],
    blocks: Sequence[Floats],
) -> Floats:
    """Return ``sum R^T M R`` of elements, scattered, shape (size,).

    Args:
        size: size of the result.
        rows: R of elements of equal size, shape (e, k, dim, c), for k points each.
        points: numbers of the points, shape (e, k) each.
        places: places of the upper triangles, shape (e, c (c + 1)/2) each.
        blocks: M of all points, shape (dim, dim, m) each.
    """
    sums: dict[int, Floats] = {}
    for own, which, place, block in zip(rows, points, places, blocks, strict=True):
        more = _summed(own, which, block)
        known = sums.get(id(place))
        sums[id(place)] = more if known is None else known + more
    where = {id(place): place for place in places}
    weights = [_triangles(sums[key]) for key in where]
    data = np.bincount(
        np.concatenate([np.zeros(0, dtype=np.int32), *(place.ravel() for place in where.values())]),
        weights=np.concatenate([np.zeros(0), *weights]),
        minlength=size,
    )
    return np.asarray(data, dtype=float)


def rates(matrix: Sparse, dim: int, velocity: Floats) -> Floats:
    """Return ``matrix u`` of points with `dim` rows each, shape (dim, m)."""
    return np.ascontiguousarray((matrix @ velocity).reshape(-1, dim).T)


def forces(matrix: Sparse, parts: Floats) -> Floats:
    """Return ``matrix^T parts`` of components of shape (dim, m), shape (n,)."""
    return np.asarray(matrix.T @ np.ascontiguousarray(parts.T).ravel())


def pulled(stack: Stack, stiff: Inverses, right: Floats, force: Floats) -> None:
    """Add ``matrix^T M a`` to a force, a in the array of a `Vector`."""
    parts = [
        stiff_of.times(a).T.ravel()
        for stiff_of, a in zip(stiff.parts(stack.spans), _parts(stack, right), strict=True)
    ]
    force += stack.matrix.T @ np.concatenate(parts)


def moved(stack: Stack, stiff: Inverses, right: Floats, x: Floats) -> None:
    """Write ``M (a - matrix u)`` to x, where a, u and x are in the arrays of a `Vector`."""
    rates = stack.matrix @ x[: stack.matrix.shape[1]]
    triples = zip(
        stiff.parts(stack.spans), _parts(stack, right), _parts(stack, x), _split(stack), strict=True
    )
    for stiff_of, a, z, own in triples:
        z[:] = stiff_of.times(a - rates[own].reshape(-1, len(a)).T)


def times(stack: Stack, soft: Compliances, x: Floats, out: Floats) -> None:
    """Add ``matrix^T z`` to the forces in out, and ``matrix u + C z`` to its other parts."""
    n = stack.matrix.shape[1]
    rates = stack.matrix @ x[:n]
    parts = _parts(stack, x)
    for soft_of, z, found, own in zip(
        soft.parts(stack.spans), parts, _parts(stack, out), _split(stack), strict=True
    ):
        found += rates[own].reshape(-1, len(z)).T + soft_of.times(z)
    out[:n] += stack.matrix.T @ np.concatenate([z.T.ravel() for z in parts])


def along(stack: Stack, soft: Compliances, steep: float, left: Floats, x: Floats) -> None:
    """Add the z that corrects rates along flow directions.

    These are directions more than `steep` times as compliant as those across the flow.
    """
    for soft_of, rates, z in zip(
        soft.parts(stack.spans), _parts(stack, left), _parts(stack, x), strict=True
    ):
        z += soft_of.along(rates, steep)


def inverted(stack: Stack, soft: Compliances, delta: Floats) -> Inverses:
    """Return ``(C + delta)^-1`` of all points, delta of shape (points,)."""
    ends = np.cumsum(stack.spans[:, 1])[:-1]
    pairs = zip(soft.parts(stack.spans), np.split(delta, ends), strict=True)
    return Inverses.of([soft_of.inverse(own) for soft_of, own in pairs])


def blocks(stack: Stack, stiff: Inverses) -> list[Floats]:
    """Return the blocks of each kind, shape (dim, dim, m)."""
    return [own.blocks for own in stiff.parts(stack.spans)]


def framed(values: Floats, vectors: Floats, a: Floats) -> Floats:
    """Return ``V values V^T a``.

    The values have the shape (dim, m) and the directions (m, dim, dim).
    """
    along = values * np.einsum("mij,im->jm", vectors, a)
    return np.asarray(np.einsum("mij,jm->im", vectors, along))


def frames(first: Scaling, others: Floats, slope: Floats, sheared: int) -> tuple[Floats, Floats]:
    """Return values and directions of ``sum B_i^T W_i^2 B_i`` of k planes at each of m points.

    They are computed from the factor ``W_i B_i``, so that small values are as exact as the root of
    the largest allows.

    Args:
        first: scaling of planes with a norm, (1 + d, k_1 m).
        others: ``W^2`` of the others, shape (k_2 m,).
        slope: slopes in B, shape (k, L, m).
        sheared: d.

    Returns:
        Arrays of shape (d + L, m) and (m, d + L, d + L), with one direction per column.
    """
    k, volumes, m = slope.shape
    normed, dim = first.square.size // m, sheared + volumes
    unit = np.zeros((normed, dim, 1 + sheared, m))
    unit[:, np.arange(sheared), 1 + np.arange(sheared)] = 1.0
    unit[:, sheared:, 0] = slope[:normed]
    columns = unit.transpose(1, 2, 0, 3).reshape(dim, 1 + sheared, -1)
    rows = np.stack([first.times(column) for column in columns])
    rows = rows.reshape(dim, 1 + sheared, normed, m).transpose(3, 2, 1, 0).reshape(m, -1, dim)
    sides = np.zeros((m, k - normed, dim))
    sides[:, :, sheared:] = slope[normed:].transpose(2, 0, 1)
    sides *= np.sqrt(others).reshape(k - normed, m).T[:, :, None]
    none = np.zeros((m, dim, dim))  # There must be as many rows as columns.
    every = np.concatenate([rows, sides, none], axis=1)
    _, values, turned = np.linalg.svd(every, full_matrices=False)
    return np.ascontiguousarray(values.T**2), np.ascontiguousarray(turned.transpose(0, 2, 1))


def scaled(s: Floats, z: Floats) -> Scaling:
    """Return the scaling between interior points of shape (1 + d, m)."""
    return Scaling.between(s, z)


def eliminated(
    scaling: Scaling, cost: Floats, rise: Floats, lead: Floats, tau: float
) -> Eliminated:
    """Return the eliminated t of cones with a scaling, where t is `lead`."""
    first, square, w = scaling.w[0], scaling.square, scaling.w[1:]
    both = square * (2 * first**2 - 1)
    raised, by = 1 + both * rise, square * rise
    return Eliminated(
        raised,
        -both * cost / raised,
        2 * square * first / raised * w,
        2 * (1 - by) / (1 + (1 + 2 * inner(w, w)) * by),
        cost + rise * lead * (2 / tau),
    )


def reduced(
    own: Eliminated, rise: Floats, height: Floats, missed: Floats, share: float, right: Floats
) -> Floats:
    """Return ``height_0/raised`` of t, and write the rest of the right-hand side to `right`.

    Args:
        own: the eliminated t.
        rise: h.
        height: ``W^2 dz + ds``.
        missed: residual of the rates.
        share: share of it that the step removes.
        right: output.
    """
    right[:] = height[1:] - rise * height[0] * own.across - share * missed
    return np.asarray(height[0] / own.raised)


def strained(
    scaling: Scaling,
    own: Eliminated,
    costs: tuple[Floats, Floats],
    given: tuple[Floats, Floats],
    tau: float,
    z: Floats,
) -> Floats:
    """Return ``(dt, dy)`` of a step of tau and z_1, shape (1 + d, m).

    Products reach their aim whatever the residual of the solution is. Errors of the rates are left
    to the next step, because they could bring the cones to their edges and end this one.

    Args:
        scaling: scaling of the cones.
        own: the eliminated t.
        costs: c and h.
        given: ``height_0/raised``, and the height.
        tau: step of tau.
        z: step of z_1.
    """
    (cost, rise), (lead, height) = costs, given
    lead = lead + own.by_tau * tau - inner(own.across, z)
    found = flowed(scaling, height, np.vstack([cost * tau + rise * lead, z]))
    found[0] = lead
    return found


def flowed(scaling: Scaling, height: Floats, z: Floats) -> Floats:
    """Return ``height - W^2 z``."""
    return np.asarray(height - Compliance.twice(scaling).times(z))


def heights(scaling: Scaling, wanted: Floats) -> Floats:
    """Return ``W q`` of the q whose products with ``W z`` are given."""
    return scaling.times(quotient(scaling.middle, wanted))


def corrected(scaling: Scaling, ds: Floats, dz: Floats, mu: float) -> Floats:
    """Return ``mu e`` minus the products of the points and of their changes, in the frame of W."""
    found = -product(scaling.by(ds), scaling.times(dz))
    found -= product(scaling.middle, scaling.middle)
    found[0] += mu
    return found


def banded(
    scaling: Scaling, ds: Floats, dz: Floats, share: float, band: tuple[float, float]
) -> Floats:
    """Return the changes that bring eigenvalues of the products after a step into a band."""
    slack = scaling.middle + share * scaling.by(ds)
    return clipped(product(slack, scaling.middle + share * scaling.times(dz)), *band)


def farthest(x: Floats, change: Floats) -> float:
    """Return the largest share of a change that stays in all cones; inf if all of it does."""
    size = np.sqrt(determinant(x))
    unit, rate = x / size, change / size
    along = unit[0] * rate[0] - inner(unit[1:], rate[1:])
    share = (along + rate[0]) / (unit[0] + 1)
    fastest = float(np.max(lengths(rate[1:] - share * unit[1:]) - along, initial=0.0))
    return 1 / fastest if fastest > 0 else np.inf


def _parts(stack: Stack, data: Floats) -> list[Floats]:
    """Return the multipliers of each kind in the array of a `Vector`, shape (dim, m)."""
    return [
        data[place : place + dim * count].reshape(dim, count)
        for dim, count, _, _, place in stack.spans.tolist()
    ]


def _split(stack: Stack) -> list[slice]:
    """Return the rows of each kind."""
    return [slice(row, row + dim * count) for dim, count, row, *_ in stack.spans.tolist()]


def _summed(rows: Floats, points: Ints, block: Floats) -> Floats:
    """Return ``sum R^T M R`` of each element, shape (e, c, c)."""
    elements, count, dim, width = rows.shape
    own = block[:, :, points][..., None]
    times = np.empty_like(rows)
    for i in range(dim):
        times[:, :, i] = own[i, 0] * rows[:, :, 0]
        for j in range(1, dim):
            times[:, :, i] += own[i, j] * rows[:, :, j]
    flat = (elements, count * dim, width)
    return np.asarray(rows.reshape(flat).transpose(0, 2, 1) @ times.reshape(flat))


def _triangles(sums: Floats) -> Floats:
    """Return the upper triangles of matrices of shape (e, c, c), joined."""
    width = sums.shape[1]
    row, column = np.triu_indices(width)
    return np.asarray(np.take(sums.reshape(-1, width * width), row * width + column, 1).ravel())
