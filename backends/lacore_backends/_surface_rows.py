"""Rows of a form for strength, hardening and volumes that depend on each other."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, diags_array, identity

from lacore.numerics.arrays import Bools, Floats, Sparse
from lacore.program import DissipationGroup

_SLIGHT = 1e-3  # small hardening, by the bound, at rates of order 1
_SMALL = 0.1  # weight times strain rate by velocity, in natural units, of a few hundred elements


@dataclass(frozen=True)
class Leads:
    """Bounds of the norms of a law: sums of separate unknowns, whose costs are strengths.

    Attributes:
        shares: shares of the unknowns in each bound, shape (m, own).
        slopes: shares in each volumetric row (T39), shape (m L, own); None if the unknowns are the
            bounds, and in no other row.
        single: whether each unknown is a whole bound. Its sign is then that of a length, and a
            second constraint on it would take a fifth more iterations.
    """

    shares: Sparse
    slopes: Sparse | None
    single: bool

    @classmethod
    def plain(cls, count: int) -> "Leads":
        """Return one unknown for each norm."""
        return cls(csr_matrix(identity(count)), None, single=True)

    @classmethod
    def of(cls, group: DissipationGroup) -> "Leads":
        """Return the unknowns of a group: multipliers of surfaces, times weights."""
        surfaces, m = group.surfaces, group.weights.size
        if surfaces is None:
            return cls.plain(m)
        own = np.arange(m * surfaces.count)
        point, row = own // surfaces.count, np.arange(m * surfaces.volumes)
        shares = csr_matrix((np.tile(surfaces.normed, m), (point, own)), (m, own.size))
        shares.eliminate_zeros()
        at = np.broadcast_to(own.reshape(m, -1, 1), surfaces.slope.shape)
        rows = np.broadcast_to(row.reshape(m, 1, -1), surfaces.slope.shape)
        entries = (surfaces.slope.ravel(), (rows.ravel(), at.ravel()))
        slopes = csr_matrix(entries, (row.size, own.size))
        slopes.eliminate_zeros()
        return cls(shares, slopes, single=surfaces.count == 1)


@dataclass(frozen=True)
class Volumes:
    """Volumetric rows of a group in a form: ``weights rows U``.

    Attributes:
        rows: shape (k, n).
        weights: weights of the rows, shape (k,).
        gain: factor of the rows, see `volumetric_gain`, shape (k,).
        means: matrix from their multipliers to mean stresses of the group, shape (m L, k).
    """

    rows: Sparse
    weights: Floats
    gain: Floats
    means: Sparse

    @classmethod
    def of(cls, group: DissipationGroup, unit: Floats, soft: bool) -> "Volumes":
        """Return the volumes of a group whose points have these units.

        Softened rows are not combined, because each point has an energy.
        """
        gain = volumetric_gain(group)
        weights = np.repeat(group.weights / unit, group.volumes)
        combined, rows = group.conditions, group.conditioned
        if combined is None or rows is None or soft:
            # With surfaces, an empty row states that their multipliers sum to zero.
            own = np.flatnonzero(filled(group.volumetric) | (group.surfaces is not None))
            factors = gain / np.repeat(unit, group.volumes)
            entries = (factors[own], (own, np.arange(own.size)))
            means = csr_matrix(entries, (weights.size, own.size))
            return cls(group.volumetric[own], (gain * weights)[own], gain[own], means)
        own = np.flatnonzero(filled(rows))
        combined, roots = combined[own], np.sqrt(group.weights)
        size = np.asarray(combined.power(2) @ (weights / roots))
        means = csr_matrix(diags_array(1 / roots) @ combined.T @ diags_array(size))
        return cls(rows[own], size, np.ones(own.size), means)


def filled(rows: Sparse) -> Bools:
    """Return which rows have an entry; the others would state ``0 = 0``."""
    return np.asarray(abs(rows).sum(axis=1)).ravel() > 0


def volumetric_gain(group: DissipationGroup) -> Floats:
    """Return the factors of volumetric rows that make their slopes of order one, (m L,).

    With small friction, mean stresses are as large as the apex is far away, and they multiply the
    residual that a solver leaves in a row.
    """
    if group.surfaces is None:
        return np.ones(group.volumetric.shape[0])
    steepest = np.abs(group.surfaces.slope).max(axis=1).ravel()
    return np.asarray(1 / np.where(steepest > 0, steepest, 1.0))


def stress_besides(group: DissipationGroup, velocity: Floats) -> Floats:
    """Return the stresses of hardening that are not duals, shape (m, dim) or none, Pa."""
    if group.surfaces is None or group.modulus is None:
        return np.zeros((1, group.dim))
    return group.modulus[:, None] * group.cone_vectors(velocity)


def point_units(group: DissipationGroup) -> Floats:
    """Return the divisors of the rows of each point, which multiply its stresses, shape (m,).

    With surfaces they are roots of the sizes of small weighted rows, else 1. The regularisation and
    the residuals of a solver are the same for all rows, and not negligible for a row of 1e-4
    (thousands of elements, the smallest ones next to an axis of symmetry): without units one solve
    took 59 iterations instead of 28, and the load had an error of 3e-6. If divided by their full
    sizes, round-off of stresses ends the solve early.

    For points with hardening, roots of all sizes are used: 24 programs take 435 iterations instead
    of 520, to a tolerance of 1e-4 234 instead of 326, and residuals are at most 4e-10 instead of
    2e-8. Points with hardening of about 1e-6, which only makes the velocity unique, have none: a
    bar was stretched unevenly.
    """
    largest = np.zeros(group.weights.size)
    if group.surfaces is None and group.modulus is None:
        return largest + 1.0
    for rows, dim in ((group.rows, group.dim), (group.volumetric, group.volumes)):
        squared = np.asarray(rows.multiply(rows).sum(axis=1)).reshape(-1, dim)
        largest = np.maximum(largest, np.sqrt(squared.max(axis=1, initial=0.0)))
    size = group.weights * largest
    if group.surfaces is not None:
        size = np.minimum(size / _SMALL, 1.0)
    elif group.modulus is not None:
        size = np.where(group.modulus > _SLIGHT * group.bound, size, 1.0)
    return np.asarray(np.sqrt(np.where(size > 0, size, 1.0)))
