"""``K = sum R^T M R`` of the same rows and other blocks again and again: its pattern, and its sum.

Points that touch the same unknowns, those of an element, are summed up by dense products before
anything is scattered: a fifth of the time of products of sparse matrices.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from backends._embedding.loops.best import Loops
from backends._embedding.rows import Rows
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
    """K of kinds of rows, always with the same pattern, whatever zeros the blocks hold.

    Attributes:
        diagonal: where in its data the diagonal is, shape (n,).
    """

    def __init__(self, kinds: Sequence[Rows], loops: Loops) -> None:
        self._n, self._loops = kinds[0].matrix.shape[1], loops
        self._buckets = [
            (kind, bucket) for kind, rows in enumerate(kinds) for bucket in _buckets(rows, loops)
        ]
        self._elements: list[Ints] = []
        numbers = [self._known(bucket.columns) for _, bucket in self._buckets]
        starts, indices, places = loops.pattern(self._elements, self._n)
        self._pattern = csr_matrix((np.zeros(indices.size), indices, starts), (self._n, self._n))
        self._places = [places[number] for number in numbers]
        self.diagonal = starts[:-1]

    def _known(self, columns: Ints) -> int:
        """Which of the elements have these unknowns: strain and volume are of the same."""
        for number, known in enumerate(self._elements):
            if np.array_equal(known, columns):
                return number
        self._elements.append(columns)
        return len(self._elements) - 1

    def upper(self, blocks: Sequence[Floats]) -> Sparse:
        """The upper triangle of K for symmetric blocks of shape (dim, dim, m) of each kind."""
        data = self._loops.assembled(
            self._pattern.nnz,
            [bucket.rows for _, bucket in self._buckets],
            [bucket.points for _, bucket in self._buckets],
            self._places,
            [blocks[kind] for kind, _ in self._buckets],
        )
        matrix = copy(self._pattern)  # what it is made of is checked at every other making
        matrix.data = data
        return matrix


def _buckets(rows: Rows, loops: Loops) -> list[_Bucket]:
    """Points by how many unknowns they touch, and by how many points touch the same."""
    dim, matrix = rows.dim, rows.matrix
    if not rows.count:
        return []
    first_of, columns_of = loops.touched(matrix, dim)
    widths = np.diff(first_of)
    found = []
    for width in np.unique(widths):
        if width == 0:
            continue
        points = np.flatnonzero(widths == width)
        columns = columns_of[first_of[points][:, None] + np.arange(width)]
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
            found.append(_Bucket(own, loops.dense(matrix, own, wide, dim), wide))
    return found
