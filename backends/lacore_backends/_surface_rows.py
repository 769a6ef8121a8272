"""What strength, hardening and volumes that depend on each other make of the rows of a form."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, diags_array, identity

from lacore.numerics.arrays import Bools, Floats, Sparse
from lacore.program.kinematic import DissipationGroup

_SLIGHT = 1e-3  # hardening per bound, at rates of order 1
_SMALL = 0.1  # weight times strain rate per velocity, in natural units: of a few hundred elements


@dataclass(frozen=True)
class Leads:
    """What bounds the norms of a law: sums of unknowns of its own, whose costs are strengths.

    Attributes:
        shares: of the unknowns in each bound, shape (m, own).
        slopes: and in each volumetric row (T39), shape (m L, own); None: the unknowns are the
            bounds, and in no other row.
        single: whether each is all of a bound. It has the sign of a length then, which said twice
            takes a fifth more iterations.
    """

    shares: Sparse
    slopes: Sparse | None
    single: bool

    @classmethod
    def plain(cls, count: int) -> "Leads":
        """One unknown for each norm."""
        return cls(csr_matrix(identity(count)), None, single=True)

    @classmethod
    def of(cls, group: DissipationGroup) -> "Leads":
        """Those of a group: multipliers of surfaces, times weights."""
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
    """What a form says of the volumes of a group: ``weights rows U``.

    Attributes:
        rows: shape (k, n).
        weights: of them, shape (k,).
        gain: share of them that is that of `volumetric_gain`, shape (k,).
        means: from multipliers of them to mean stresses of the group, shape (m L, k).
    """

    rows: Sparse
    weights: Floats
    gain: Floats
    means: Sparse

    @classmethod
    def of(cls, group: DissipationGroup, unit: Floats, soft: bool) -> "Volumes":
        """Those of a group whose points are in units.

        The rows themselves where they are softened: an energy of each point.
        """
        gain = volumetric_gain(group)
        weights = np.repeat(group.weights / unit, group.volumes)
        combined, rows = group.conditions, group.conditioned
        if combined is None or rows is None or soft:
            # With surfaces a row without an entry says that their multipliers sum to zero.
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
    """Which rows have an entry; the others would say ``0 = 0``."""
    return np.asarray(abs(rows).sum(axis=1)).ravel() > 0


def volumetric_gain(group: DissipationGroup) -> Floats:
    """What volumetric rows are multiplied by, so that slopes in them are of order one, (m L,).

    Where friction is slight mean stresses are as large as its apex is far away, and what a solver
    leaves of a row counts as often.
    """
    if group.surfaces is None:
        return np.ones(group.volumetric.shape[0])
    steepest = np.abs(group.surfaces.slope).max(axis=1).ravel()
    return np.asarray(1 / np.where(steepest > 0, steepest, 1.0))


def stress_besides(group: DissipationGroup, velocity: Floats) -> Floats:
    """Stresses of hardening that are not among the duals, shape (m, dim) or none, Pa."""
    if group.surfaces is None or group.modulus is None:
        return np.zeros((1, group.dim))
    return group.modulus[:, None] * group.cone_vectors(velocity)


def point_units(group: DissipationGroup) -> Floats:
    """What the rows of each point are divided by, and its stresses multiplied, shape (m,).

    With surfaces roots of the sizes of small weighted rows, else 1. What a solver adds to its
    diagonal, and leaves of a row, is the same for all of them, and beside a row of 1e-4 (thousands
    of elements, those next to an axis of revolution the least) it is no little: 59 iterations in
    place of 28, and a load that is off by 3e-6. In units of their own sizes round-off of stresses
    ends the solve early.

    Roots of all sizes of points that harden: 24 programs take 435 iterations in place of 520,
    to a tolerance of 1e-4 234 in place of 326, and leave 4e-10 at most in place of 2e-8. Of those
    that hardly do, by 1e-6 so that one velocity is the answer, none: a bar was pulled unevenly.
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
