"""Groups whose strength depends on pressure as cones and rows of the embedding (T39).

    ||d|| <= sum_i n_i lam_i,  v - e = sum_i a_i lam_i,  lam >= 0,  at the cost of sum_i b_i lam_i

The multipliers lam are unknowns beside the velocities, as speeds: times a length of their point, so
that they are of the size of what moves it. A single plane with an apex needs none of them:
``lam = (v - e)/a`` is a lead itself, and its cost a dead load (T38).
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.sparse import csr_matrix

from lacore.arrays import Floats, Sparse
from lacore.program import DissipationGroup


@dataclass(frozen=True)
class Lead:
    """What bounds ``||d||`` of the m points of a group, without their weights.

    Attributes:
        velocity: rows of the lead on velocities, shape (m, n).
        own: on unknowns of the group, shape (m, k).
        offset: what is added, shape (m,).
    """

    velocity: Sparse
    own: Sparse
    offset: Floats


@dataclass(frozen=True)
class Held:
    """Rows that hold exactly, without weights: ``velocity u + own y = given``, of r rows.

    Attributes:
        velocity, own: shape (r, n) and (r, k).
        given: shape (r,).
        gain: what they were multiplied by, shape (r,).
        weights: of their points, shape (r,).
    """

    velocity: Sparse
    own: Sparse
    given: Floats
    gain: Floats
    weights: Floats


class Pressed(Protocol):
    """A group in such unknowns.

    Attributes:
        lead, held: rows.
        sizes: lam per unknown, all of them >= 0, shape (k,).
        weights: of their points, shape (k,).
        cost_by_velocity, cost: of velocities and of the unknowns, shape (n,) and (k,).
    """

    @property
    def lead(self) -> Lead: ...

    @property
    def held(self) -> Held: ...

    @property
    def sizes(self) -> Floats: ...

    @property
    def weights(self) -> Floats: ...

    @property
    def cost_by_velocity(self) -> Floats: ...

    @property
    def cost(self) -> Floats: ...

    def mean(self, lead: Floats, held: Floats) -> Floats:
        """Mean stresses of multipliers of lead and rows, shape (m L,)."""


def pressed(group: DissipationGroup) -> Pressed:
    """Whichever of both a group can be."""
    surfaces = group.surfaces
    assert surfaces is not None
    alone = surfaces.count == 1 and surfaces.volumes == 1 and bool(surfaces.normed[0] > 0)
    return Apex(group) if alone and bool(np.all(surfaces.slope > 0)) else Planes(group)


class Apex:
    """One plane with an apex at each point."""

    def __init__(self, group: DissipationGroup) -> None:
        surfaces = group.surfaces
        assert surfaces is not None
        n, count = int(group.rows.shape[1]), group.weights.size
        slope = surfaces.slope[:, 0, 0]
        self._slope, self._strength = slope, surfaces.strength[:, 0]
        share = surfaces.normed[0] / slope
        rows = csr_matrix(group.volumetric.multiply(share[:, None]))
        none = csr_matrix((count, 0))
        self.lead = Lead(rows, none, -share * surfaces.besides)
        self.held = Held(csr_matrix((0, n)), csr_matrix((0, 0)), *np.zeros((3, 0)))
        self.sizes = self.weights = self.cost = np.zeros(0)
        per = group.weights * self._strength / slope
        self.cost_by_velocity = np.asarray(group.volumetric.T @ per)
        self._share = share

    def mean(self, lead: Floats, held: Floats) -> Floats:
        """See `Pressed`."""
        return np.asarray(self._strength / self._slope - self._share * lead)


class Planes:
    """Several planes, whose multipliers are unknowns, point after point."""

    def __init__(self, group: DissipationGroup) -> None:
        surfaces = group.surfaces
        assert surfaces is not None
        m, k, volumes = surfaces.slope.shape
        n, own = int(group.rows.shape[1]), np.arange(m * k)
        squares = np.asarray(group.rows.multiply(group.rows).sum(axis=1)).ravel()
        per_length = np.sqrt(squares.reshape(m, -1).mean(axis=1))
        per_length[per_length == 0] = 1.0
        self.sizes = np.repeat(per_length, k)
        self.weights = np.repeat(group.weights, k)
        normed = (np.tile(surfaces.normed, m) * self.sizes, (own // k, own))
        self.lead = Lead(csr_matrix((m, n)), csr_matrix(normed, (m, own.size)), np.zeros(m))
        steepest = np.abs(surfaces.slope).max(axis=1).ravel()
        gain = 1 / np.where(steepest > 0, steepest, 1.0)
        slope = surfaces.slope * gain.reshape(m, 1, volumes) * per_length[:, None, None]
        at = np.broadcast_to(own.reshape(m, k, 1), slope.shape)
        row = np.broadcast_to(np.arange(m * volumes).reshape(m, 1, volumes), slope.shape)
        rows = csr_matrix((-slope.ravel(), (row.ravel(), at.ravel())), (m * volumes, own.size))
        rows.eliminate_zeros()
        self.held = Held(
            csr_matrix(group.volumetric.multiply(gain[:, None])),
            rows,
            gain * surfaces.besides,
            gain,
            group.volume_weights,
        )
        self.cost_by_velocity = np.zeros(n)
        self.cost = self.weights * surfaces.strength.ravel() * self.sizes

    def mean(self, lead: Floats, held: Floats) -> Floats:
        """See `Pressed`."""
        return np.asarray(-self.held.gain * held)
