"""Rows of several kinds in one matrix, over which the loops run."""

from dataclasses import dataclass

from lacore.numerics.arrays import Floats, Ints, Sparse


@dataclass(frozen=True)
class Stack:
    """Stacked rows of several kinds, so that one call handles all of them.

    Attributes:
        matrix: shape (all rows, n).
        spans: dim, count, first row, first point, and place of the multipliers in the array of a
            `Vector`, for each kind, shape (k, 5).
        norms: norms of all points.
    """

    matrix: Sparse
    spans: Ints
    norms: Floats
