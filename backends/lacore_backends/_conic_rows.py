"""Rows and cones of the single laws of a conic form (`lacore_backends._conic_form`)."""

from dataclasses import dataclass
from typing import Any

import clarabel
import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.numerics.arrays import Floats, Sparse
from lacore.program import DissipationGroup, interleaved


@dataclass(frozen=True)
class Law:
    """Rows of a law, `dim` per point, with the weights of the points; soft if stiffness < inf."""

    rows: Sparse
    dim: int
    weights: Floats
    stiffness: float

    @property
    def softened(self) -> int:
        """Number of its y."""
        return self.rows.shape[0] if np.isfinite(self.stiffness) else 0

    def over(self, columns: int, first: int) -> Sparse:
        """Return ``weights (rows U - y/sqrt(K))`` over all columns, with the y from `first` on."""
        weights = np.repeat(self.weights, self.dim)
        whole = wide(self.rows, columns, weights)
        if not self.softened:
            return whole
        own = np.arange(weights.size)
        share = weights / np.sqrt(self.stiffness)
        return csr_matrix(whole - csr_matrix((share, (own, first + own)), whole.shape))


@dataclass(frozen=True)
class Norm:
    """Cones ``||follow|| <= lead``, `count` of them, each with `dim` rows of `follow`.

    Attributes:
        linear: whether they are pairs of half-spaces, of one row.
    """

    count: int
    dim: int
    linear: bool = False

    @property
    def cones(self) -> list[Any]:
        """The cones of Clarabel."""
        return [] if self.linear else [clarabel.SecondOrderConeT(1 + self.dim)] * self.count

    def rows(self, lead: Sparse, follow: Sparse) -> Sparse:
        """Return the rows whose values are in the cones."""
        if self.linear:
            return csr_matrix(vstack([lead - follow, lead + follow]))
        return interleaved(lead, 1, follow, self.dim)

    def offset(self, lead: Floats) -> Floats:
        """Return the offset of the rows for an offset of the lead."""
        if self.linear:
            return np.concatenate([lead, lead])
        return np.column_stack([lead, np.zeros((self.count, self.dim))]).ravel()

    def duals(self, z: Floats) -> Floats:
        """Return the multipliers of lead and follow, shape (count, 1 + dim)."""
        if self.linear:
            below, above = z.reshape(2, -1)
            return np.column_stack([below + above, above - below])
        return z.reshape(-1, 1 + self.dim)


def strain_law(group: DissipationGroup, unit: Floats, stiffness: float, whole: bool) -> Law:
    """Return the law of the strain rates of a group, including volumes if they are `whole`."""
    if not whole or group.surfaces is not None:
        return Law(group.rows, group.dim, group.weights / unit, stiffness)
    volumes = group.volumetric * group.volumetric_factor
    rows = interleaved(group.rows, group.dim, volumes, 1)
    return Law(rows, group.dim + 1, group.weights, stiffness)


def placed(rows: Sparse, columns: int, first: int) -> Sparse:
    """Return the rows over all columns, with their own columns from `first` on."""
    return csr_matrix((rows.data, rows.indices + first, rows.indptr), (rows.shape[0], columns))


def wide(rows: Sparse, columns: int, weights: Floats) -> Sparse:
    """Return the rows times their weights, with empty columns appended, and without zeros."""
    # Scale the arrays directly: sparse products would take half of the time of a small solve.
    data = rows.data * np.repeat(weights, np.diff(rows.indptr))
    found = csr_matrix((data, rows.indices, rows.indptr), (rows.shape[0], columns))
    if not np.all(data):
        # Copy the arrays before zeros are removed, as they belong to the program.
        found = found.copy()
        found.eliminate_zeros()
    return found
