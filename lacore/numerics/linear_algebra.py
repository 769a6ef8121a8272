"""Sparse symmetric matrices of one pattern, repeatedly formed and factorised.

Second-order methods on velocities spend most of their time here: ``K = sum_i R_i^T D_i R_i`` with
small dense blocks D that change and constant rows R, and solutions with K.
"""

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from scipy.sparse import csc_array, csr_matrix, triu, vstack
from scipy.sparse.linalg import splu

from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.reporting.errors import LacoreError


class SingularError(LacoreError):
    """Raised for a matrix that cannot be factorised."""


def require_numbers(entries: Floats) -> None:
    """Raise `SingularError` if an entry is NaN or infinite, as there would be no pivot."""
    if not np.isfinite(entries).all():
        raise SingularError("an entry of the matrix is not a number")


class Gram:
    """``K = sum_i R_i^T D_i R_i`` with a pattern that does not depend on zeros in D."""

    def __init__(self, rows: Sequence[Sparse], dims: Sequence[int]) -> None:
        """Store the rows R_i of shape (m_i dim_i, n), whose blocks have dim_i rows."""
        self._rows = csr_matrix(vstack(rows, format="csr"))
        self._columns = csr_matrix(self._rows.T)
        first, columns, lengths = 0, [], []
        for matrix, dim in zip(rows, dims, strict=True):
            count = matrix.shape[0] // dim
            own = first + np.arange(matrix.shape[0]).reshape(count, 1, dim)
            columns.append(np.broadcast_to(own, (count, dim, dim)).ravel())
            lengths.append(np.full(matrix.shape[0], dim))
            first += matrix.shape[0]
        self._block_columns = np.concatenate(columns)
        self._block_starts = np.concatenate([[0], np.cumsum(np.concatenate(lengths))])
        full = abs(self._columns) @ self._blocks(np.ones(self._block_columns.size))
        self._full = csr_matrix(full @ abs(self._rows))
        self._full.sort_indices()
        self._keys = _keys(self._full)

    def matrix(self, blocks: Sequence[Floats]) -> Sparse:
        """Return K for symmetric blocks of shape (m_i, dim_i, dim_i)."""
        diagonal = self._blocks(np.concatenate([block.ravel() for block in blocks]))
        product = csr_matrix(self._columns @ csr_matrix(diagonal @ self._rows))
        product.sort_indices()
        if product.nnz == self._full.nnz:
            return product
        # The product leaves out entries that happen to cancel, so they are put back as zeros.
        data = np.zeros(self._full.nnz)
        data[np.searchsorted(self._keys, _keys(product))] = product.data
        return csr_matrix((data, self._full.indices, self._full.indptr), shape=product.shape)

    def _blocks(self, data: Floats) -> Sparse:
        count = self._rows.shape[0]
        return csr_matrix((data, self._block_columns, self._block_starts), shape=(count, count))


def _keys(matrix: Sparse) -> Ints:
    """Return row and column of each entry as one number, ascending for sorted indices."""
    rows = np.repeat(np.arange(matrix.shape[0], dtype=np.int64), np.diff(matrix.indptr))
    return np.asarray(rows * matrix.shape[1] + matrix.indices)


class SymmetricSolver(Protocol):
    """Solver that factorises symmetric positive definite matrices of one pattern in turn."""

    name: str

    def factorise(self, matrix: Sparse) -> None:
        """Take a matrix with sorted indices; raises `SingularError`."""

    def factorise_upper(self, matrix: Sparse) -> None:
        """Take the upper triangle of one, with all of its diagonal; raises `SingularError`."""

    def solve(self, right: Floats) -> Floats:
        """Return the solution for the last matrix, shape (n,), or several, shape (n, k)."""

    def close(self) -> None:
        """Give the factors back."""


class SuperLU:
    """SuperLU in symmetric mode, from SciPy, which is always installed."""

    name = "SuperLU"

    def __init__(self) -> None:
        self._factor: Any = None

    def factorise(self, matrix: Sparse) -> None:
        """Implement `SymmetricSolver`."""
        require_numbers(matrix.data)
        symmetric = csc_array((matrix.data, matrix.indices, matrix.indptr), shape=matrix.shape)
        try:
            self._factor = splu(
                symmetric,
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )
        except RuntimeError as error:
            raise SingularError(f"SuperLU: {error}") from error

    def factorise_upper(self, matrix: Sparse) -> None:
        """Implement `SymmetricSolver`."""
        full = csr_matrix(matrix + triu(matrix, 1).T)
        full.sort_indices()
        self.factorise(full)

    def solve(self, right: Floats) -> Floats:
        """Implement `SymmetricSolver`."""
        return np.asarray(self._factor.solve(right))

    def close(self) -> None:
        """Implement `SymmetricSolver`."""
        self._factor = None
