"""Sparse rows of two kinds, point by point."""

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.numerics.arrays import Sparse


def interleaved(first: Sparse, first_dim: int, second: Sparse, second_dim: int) -> Sparse:
    """Return the rows of both by point.

    `first_dim` rows of the first, `second_dim` of the second.
    """
    count = first.shape[0] // first_dim
    order = np.concatenate(
        [
            np.arange(first.shape[0]).reshape(count, first_dim),
            first.shape[0] + np.arange(second.shape[0]).reshape(count, second_dim),
        ],
        axis=1,
    )
    return csr_matrix(csr_matrix(vstack([first, second], format="csr"))[order.ravel()])
