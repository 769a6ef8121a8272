"""Matrices on the velocities of blocks: not symmetric, with the pattern of a stiffness (T79)."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, csr_array, csr_matrix
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from lacore.coupling.constants import FREE_SHIFT, LEAST_PIVOT
from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.numerics.linear_algebra import SingularError
from lacore.reporting.showing import Compact

_PANEL = 1  # columns at once: those of a wall have little in common


@dataclass(frozen=True, repr=False)
class Pattern(Compact):
    """``K = B' D B``, B the normal and tangential rows, with blocks D of points that change.

    Attributes:
        sums: entries of K, column by column, from all entries of D.
        rows, columns: of the entries.
        starts: of the columns.
        diagonal: which entries are on it.
    """

    sums: Sparse
    rows: Ints
    columns: Ints
    starts: Ints
    diagonal: Ints

    @classmethod
    def of(cls, normal: Sparse, tangential: Sparse, rough: Ints, d: int) -> "Pattern":
        """Of rows (m, n) and, at points `rough`, (k d, n).

        Entries of D: the normal ones (m,), then of each tangential row those with the normal row
        and with each tangential one, (k,) each.
        """
        m, n, k = normal.shape[0], normal.shape[1], rough.size
        across = [csr_matrix(tangential[axis::d]) for axis in range(d)]
        own = csr_matrix(normal[rough])
        pairs = [(normal, normal), *((a, b) for a in across for b in (own, *across))]
        terms = [_outer(*pair) for pair in pairs]
        point, row, column, value = map(np.concatenate, zip(*terms, strict=True))
        starts = np.concatenate([[0], m + k * np.arange(len(pairs))])
        every = np.repeat(starts[:-1], [term[0].size for term in terms]) + point
        diagonal = np.arange(n)
        keys, where = np.unique(
            np.concatenate([column * n + row, diagonal * n + diagonal]), return_inverse=True
        )
        sums = csr_matrix((value, (where[: value.size], every)), (keys.size, int(starts[-1])))
        begins = np.searchsorted(keys, np.arange(n + 1) * n)
        return cls(sums, keys % n, keys // n, begins, where[value.size :])

    def scaled(self, entries: Floats) -> tuple[csc_array, Floats]:
        """K with ones on its diagonal, and the square roots of what was there, inverted.

        Raises:
            SingularError: nothing, or no number, was there.
        """
        data = self.sums @ entries
        size = np.abs(data[self.diagonal])
        if not (np.all(size > 0) and np.isfinite(data).all()):
            raise SingularError("an entry of the diagonal is zero, or one of the matrix not finite")
        scale = 1 / np.sqrt(size)
        data = data * scale[self.rows] * scale[self.columns]
        data[self.diagonal] += FREE_SHIFT
        n = scale.size
        return csc_array((data, self.rows, self.starts), shape=(n, n)), scale


class Factor:
    """A matrix factorised, with the sign of its determinant."""

    def __init__(self, pattern: Pattern, entries: Floats) -> None:
        """Raises `SingularError`."""
        matrix, self._scale = pattern.scaled(entries)
        try:
            self._factor = splu(
                matrix,
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=LEAST_PIVOT,
                panel_size=_PANEL,
                options={"SymmetricMode": True},
            )
        except RuntimeError as error:  # SuperLU's word for it
            raise SingularError(str(error)) from error

    def solve(self, right: Floats) -> Floats:
        """Solution, not refined: to as many digits as small pivots leave."""
        return np.asarray(self._scale * self._factor.solve(self._scale * right))

    @property
    def sign(self) -> float:
        """Of the determinant."""
        orders = _parity(self._factor.perm_r) * _parity(self._factor.perm_c)
        return float(orders * np.prod(np.sign(self._factor.U.diagonal())))


def _outer(left: Sparse, right: Sparse) -> tuple[Ints, Ints, Ints, Floats]:
    """Point, row, column and value of the entries of ``left[j].T right[j]`` of all points j."""
    points = np.repeat(np.arange(left.shape[0]), np.diff(left.indptr))
    counts = np.diff(right.indptr)[points]
    one = np.repeat(np.arange(points.size), counts)
    within = np.arange(one.size) - np.repeat(np.cumsum(counts) - counts, counts)
    other = right.indptr[points][one] + within
    values = left.data[one] * right.data[other]
    rows, columns = left.indices[one].astype(np.int64), right.indices[other].astype(np.int64)
    return points[one], rows, columns, values


def _parity(order: Ints) -> int:
    """Of a permutation: 1 for even ones, -1 for odd ones."""
    ones = csr_array((np.ones(order.size), (np.arange(order.size), order)))
    cycles, _ = connected_components(ones, directed=False)
    return 1 - 2 * int((order.size - cycles) % 2)
