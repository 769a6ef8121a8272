"""Null spaces with sparse bases: some of the unknowns, and those that depend on them."""

import numpy as np
import scipy.linalg
from scipy.sparse import block_array, csc_matrix, csr_matrix, identity
from scipy.sparse.csgraph import connected_components

from lacore.numerics.arrays import Floats, Sparse

_DEPENDENT = 1e-9  # sine far above round-off and far below any intended angle
_ROUND_OFF = 1e-13  # by an entry of order one


def null_space(conditions: Floats) -> Floats:
    """Return a basis of the x with ``conditions x = 0``, (n, free), in some of the x.

    Unlike an orthonormal basis it is sparse: a beam that moves sideways is one unknown.
    """
    n = conditions.shape[1]
    if not n:
        return np.zeros((0, 0))
    triangle, pivots = scipy.linalg.qr(conditions, mode="r", pivoting=True)
    size = np.abs(np.diagonal(triangle))
    rank = int(np.sum(size > _DEPENDENT))
    following = -scipy.linalg.solve_triangular(triangle[:rank, :rank], triangle[:rank, rank:])
    following[np.abs(following) < _ROUND_OFF] = 0.0
    basis = np.zeros((n, n - rank))
    basis[pivots[:rank]] = following
    basis[pivots[rank:], np.arange(n - rank)] = 1.0
    return basis


def null_space_by_parts(conditions: Sparse) -> Sparse:
    """Return a basis for sparse conditions, (n, free), by connected parts."""
    linked = csr_matrix(abs(conditions).T @ abs(conditions))
    count, part = connected_components(linked, directed=False)
    touched = linked.diagonal() > 0
    alone = np.flatnonzero(~touched)
    n, columns = conditions.shape[1], csc_matrix(conditions)
    found = [csr_matrix(identity(n, format="csr")[:, alone])]
    for number in range(count):
        own = np.flatnonzero((part == number) & touched)
        if own.size:
            rows = columns[:, own]
            local = null_space(rows[np.unique(rows.indices)].toarray())
            place = csr_matrix((np.ones(own.size), (own, np.arange(own.size))), (n, own.size))
            found.append(csr_matrix(place @ csr_matrix(local)))
    return csr_matrix(block_array([found]))
