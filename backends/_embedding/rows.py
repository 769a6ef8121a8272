"""Rows of the embedding, point by point."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from backends._embedding.loops.best import Loops
from lacore.arrays import Floats, Sparse


@dataclass(frozen=True)
class Rows:
    """Rows of m points of `dim` components each, point by point.

    Attributes:
        matrix: shape (m dim, n).
        dim: components of a point.
        norms: squared norm of the rows of a point, their mean, shape (m,).
        loops: over points.
    """

    matrix: Sparse
    dim: int
    norms: Floats
    loops: Loops

    @classmethod
    def of(cls, matrix: Sparse, dim: int, weights: Floats, loops: Loops) -> "Rows":
        """Rows times the weights of their points, shape (m,)."""
        data = matrix.data * np.repeat(np.repeat(weights, dim), np.diff(matrix.indptr))
        own = csr_matrix((data, matrix.indices, matrix.indptr), matrix.shape)
        squares = np.asarray(own.multiply(own).sum(axis=1)).reshape(-1, dim).mean(axis=1)
        largest = float(squares.max(initial=0.0)) or 1.0
        return cls(own, dim, np.maximum(squares, 1e-12 * largest), loops)

    @property
    def count(self) -> int:
        """Points m."""
        return int(self.norms.size)

    def at(self, velocity: Floats) -> Floats:
        """Components of all points, shape (dim, m)."""
        return self.loops.rates(self.matrix, self.dim, velocity)

    def force(self, parts: Floats) -> Floats:
        """``matrix^T parts`` of components of shape (dim, m), shape (n,)."""
        return self.loops.forces(self.matrix, parts)
