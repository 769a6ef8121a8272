"""Rows of the embedding, point by point."""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.numerics.arrays import Floats, Sparse
from lacore_backends._embedding.loops.best import Loops
from lacore_backends._embedding.loops.stack import Stack


@dataclass(frozen=True)
class Rows:
    """Rows of m points with `dim` components each.

    Attributes:
        matrix: shape (m dim, n).
        dim: number of components of a point.
        norms: mean squared norm of the rows of each point, shape (m,).
        loops: loops over points.
    """

    matrix: Sparse
    dim: int
    norms: Floats
    loops: Loops

    @classmethod
    def of(cls, matrix: Sparse, dim: int, weights: Floats, loops: Loops) -> "Rows":
        """Return the rows times the weights of their points, shape (m,)."""
        row = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
        own = copy(matrix)  # SciPy would check the arrays again each time a matrix is made of them.
        own.data = matrix.data * np.repeat(weights, dim)[row]
        squares = np.bincount(row // dim, own.data**2, weights.size) / dim
        largest = float(squares.max(initial=0.0)) or 1.0
        return cls(own, dim, np.maximum(squares, 1e-12 * largest), loops)

    @property
    def count(self) -> int:
        """Points m."""
        return int(self.norms.size)

    def at(self, velocity: Floats) -> Floats:
        """Return the components of all points, shape (dim, m)."""
        return self.loops.rates(self.matrix, self.dim, velocity)

    def force(self, parts: Floats) -> Floats:
        """Return ``matrix^T parts`` of components of shape (dim, m), shape (n,)."""
        return self.loops.forces(self.matrix, parts)


def stacked(kinds: Sequence[Rows], places: Sequence[int]) -> Stack:
    """Stack kinds of rows whose multipliers begin at these places."""
    sizes = [(rows.dim, rows.count) for rows in kinds]
    first_row = np.cumsum([0, *(dim * count for dim, count in sizes)])
    first_point = np.cumsum([0, *(count for _, count in sizes)])
    spans = [
        (*size, row, point, place)
        for size, row, point, place in zip(sizes, first_row, first_point, places, strict=False)
    ]
    return Stack(
        csr_matrix(vstack([rows.matrix for rows in kinds])),
        np.array(spans, dtype=np.int64),
        np.concatenate([rows.norms for rows in kinds]),
    )
