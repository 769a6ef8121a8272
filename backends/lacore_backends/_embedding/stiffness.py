"""``K = sum R^T M R`` of the same rows and other blocks again and again: its pattern, and its sum.

Points that touch the same unknowns, those of an element, are summed up by dense products before
anything is scattered: a fifth of the time of products of sparse matrices.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore_backends._embedding.loops.best import Loops
from lacore_backends._embedding.rows import Rows

_RUNS = (1, 2, 3, 4, 6, 7, 12)  # points of an element
_FIRST = 84 * 4  # points that tell how many they are: a number of runs of each


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
    """Runs of points by how many unknowns they touch."""
    if not rows.count:
        return []
    matrix, dim, run = rows.matrix, rows.dim, _run(rows, loops)
    starts, every = loops.touched(matrix.indptr, matrix.indices, dim * run, matrix.shape[1])
    widths = np.diff(starts)
    found = []
    for width in np.unique(widths[widths > 0]):
        which = np.flatnonzero(widths == width)
        columns = every[starts[which][:, None] + np.arange(width)].astype(np.int64)
        points = which[:, None] * run + np.arange(run)
        found.append(_Bucket(points, loops.dense(matrix, points, columns, dim), columns))
    return found


def _run(rows: Rows, loops: Loops) -> int:
    """How many points, one after the other, to sum up before anything is scattered.

    Those of an element touch the same unknowns, but for some whose rates are zero at a point. As
    many as scatter the fewest entries, of the first points.
    """
    starts, first = rows.matrix.indptr[: _FIRST * rows.dim + 1], {}
    for run in _RUNS:
        if rows.count % run == 0:
            count = (starts.size - 1) // (rows.dim * run) * rows.dim * run
            own = starts[: count + 1]
            ends, _ = loops.touched(own, rows.matrix.indices, rows.dim * run, rows.matrix.shape[1])
            first[run] = float(np.sum(np.diff(ends) ** 2.0))
    return min(first, key=lambda run: first[run])
