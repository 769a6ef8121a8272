"""``K = sum R^T M R`` of the same rows and other blocks again and again: its pattern, and its sum.

Points that touch the same unknowns, those of an element, are summed up by dense products before
anything is scattered: a fifth of the time of products of sparse matrices.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from backends._embedding.arrays import Rows
from lacore.arrays import Floats, Ints, Sparse


@dataclass(frozen=True)
class _Bucket:
    """Points with as many unknowns each, those of an element beside each other.

    Attributes:
        points: their numbers, shape (e, k): k points of each of e elements.
        rows: dense, shape (e, k, dim, c).
        columns: of the c unknowns, shape (e, c).
    """

    points: Ints
    rows: Floats
    columns: Ints


class Stiffness:
    """K of kinds of rows, always with the same pattern, whatever zeros the blocks hold."""

    def __init__(self, kinds: Sequence[Rows]) -> None:
        self._n = n = kinds[0].matrix.shape[1]
        self._buckets = [_buckets(rows) for rows in kinds]
        self._elements: list[Ints] = []
        self._sums = [[self._known(bucket.columns) for bucket in own] for own in self._buckets]
        pattern = _touching(self._elements, n)
        self._indices, self._starts = pattern.indices, pattern.indptr
        rows = np.repeat(np.arange(n, dtype=np.int64), np.diff(pattern.indptr))
        keys = rows * n + pattern.indices
        self.diagonal = np.searchsorted(keys, np.arange(n, dtype=np.int64) * (n + 1))
        places = [
            _found(keys, (own[:, :, None] * n + own[:, None, :]).ravel()) for own in self._elements
        ]
        self._places = np.concatenate([np.zeros(0, dtype=np.int64), *places])

    def _known(self, columns: Ints) -> int:
        """Which of the elements have these unknowns: strain and volume are of the same."""
        for number, known in enumerate(self._elements):
            if np.array_equal(known, columns):
                return number
        self._elements.append(columns)
        return len(self._elements) - 1

    def matrix(self, blocks: Sequence[Floats]) -> Sparse:
        """K for blocks of shape (dim, dim, m) each, symmetric."""
        sums: list[Floats | None] = [None] * len(self._elements)
        for own, numbers, block in zip(self._buckets, self._sums, blocks, strict=True):
            for bucket, number in zip(own, numbers, strict=True):
                known, more = sums[number], _summed(bucket, block)
                sums[number] = more if known is None else known + more
        every = np.concatenate([np.zeros(0), *(one.ravel() for one in sums if one is not None)])
        data = np.bincount(self._places, weights=every, minlength=self._indices.size)
        return csr_matrix((data, self._indices, self._starts), (self._n, self._n))


def _found(keys: Ints, wanted: Ints) -> Ints:
    """Where keys are, which ascend; in their order, as leaps through memory take longer."""
    order, places = np.argsort(wanted), np.empty_like(wanted)
    places[order] = np.searchsorted(keys, wanted[order])
    return places


def _touching(elements: Sequence[Ints], n: int) -> Sparse:
    """Which unknowns meet in an element, and each itself; sorted."""
    columns = np.concatenate([np.arange(n), *(own.ravel() for own in elements)])
    sizes = [np.ones(n, dtype=np.int64), *(np.full(len(own), own.shape[1]) for own in elements)]
    starts = np.concatenate([[0], np.cumsum(np.concatenate(sizes))])
    inside = csr_matrix((np.ones(columns.size, dtype=bool), columns, starts), (starts.size - 1, n))
    pattern = csr_matrix(inside.T @ inside)
    pattern.sort_indices()
    return pattern


def _summed(bucket: _Bucket, block: Floats) -> Floats:
    """``sum R^T M R`` of each element, shape (e, c, c)."""
    rows = bucket.rows
    elements, count, dim, width = rows.shape
    own = block[:, :, bucket.points][..., None]
    times = np.empty_like(rows)
    for i in range(dim):
        times[:, :, i] = own[i, 0] * rows[:, :, 0]
        for j in range(1, dim):
            times[:, :, i] += own[i, j] * rows[:, :, j]
    flat = (elements, count * dim, width)
    return np.asarray(rows.reshape(flat).transpose(0, 2, 1) @ times.reshape(flat))


def _buckets(rows: Rows) -> list[_Bucket]:
    """Points by how many unknowns they touch, and by how many points touch the same."""
    count, dim, matrix = rows.count, rows.dim, rows.matrix
    if not count:
        return []
    every = np.arange(count * dim)
    pick = csr_matrix((np.ones(every.size), (every // dim, every)), (count, every.size))
    touched = csr_matrix(pick @ abs(matrix))
    touched.sort_indices()
    widths = np.diff(touched.indptr)
    found = []
    for width in np.unique(widths):
        if width == 0:
            continue
        points = np.flatnonzero(widths == width)
        columns = touched.indices[touched.indptr[points][:, None] + np.arange(width)]
        # Rows of unknowns by one number each: sorting the rows themselves takes ten times as long.
        numbers = columns @ np.random.default_rng(width).integers(1, 2**62, width)
        _, first, element, sizes = np.unique(
            numbers, return_index=True, return_inverse=True, return_counts=True
        )
        if np.any(columns[first][element] != columns):
            first = element = np.arange(points.size)
            sizes = np.ones(points.size, dtype=np.int64)
        columns = columns[first]
        order = np.argsort(element, kind="stable")
        starts = np.concatenate([[0], np.cumsum(sizes)])
        for size in np.unique(sizes):
            which = np.flatnonzero(sizes == size)
            own = points[order[starts[which][:, None] + np.arange(size)]]
            wide = columns[which].astype(np.int64)
            found.append(_Bucket(own, _dense(matrix, own, wide, dim), wide))
    return found


def _dense(matrix: Sparse, points: Ints, columns: Ints, dim: int) -> Floats:
    """Rows of points of shape (e, k) by columns of shape (e, c), shape (e, k, dim, c)."""
    elements, size = points.shape
    width = columns.shape[1]
    every = (points[:, :, None] * dim + np.arange(dim)).ravel()
    picked = csr_matrix(matrix[every])
    at = np.repeat(np.arange(every.size), np.diff(picked.indptr))
    element = at // (size * dim)
    keys = (np.arange(elements)[:, None] * (int(matrix.shape[1]) + 1) + columns).ravel()
    place = np.searchsorted(keys, element * (int(matrix.shape[1]) + 1) + picked.indices)
    dense = np.zeros((every.size, width))
    dense[at, place - element * width] = picked.data
    return dense.reshape(elements, size, dim, width)
