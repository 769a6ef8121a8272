"""Groups whose strength depends on pressure (T39).

    D u = sum_i n_i d_i,  V u - e = sum_i a_i lam_i,  ||d_i|| <= lam_i,  cost sum_i b_i lam_i

n_i is 1, or 0 of a plane in p alone, whose ``lam_i >= 0``. Of the rows at a point the multipliers
are ``zeta = (s, p)``, and those of its cones are affine in them,

    z_i = tau c_i + B_i zeta,  c_i = (b_i, 0),  B_i zeta = (a_i.p, n_i s)

so that a step of ``dz_i`` is one of zeta, and all flows ``x_i = (lam_i, d_i)`` are eliminated at
their point, however many planes there are: what velocities feel is ``C = sum B_i^T W_i^2 B_i``.

A single plane with an apex is one cone of ``(theta/a, d)``, and its cost a dead load (T38).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from lacore.numerics.arrays import Floats
from lacore.numerics.interleaving import interleaved
from lacore.program.kinematic import DissipationGroup
from lacore_backends._embedding.loops.best import Loops
from lacore_backends._embedding.rows import Rows

_INSIDE = 0.01  # of the strengths of a point: what all planes must leave stress zero
_SHARPER = (4.0, 16.0, 64.0, 256.0, 1024.0)  # per strength: as sharp as corners get
_FAR = 4.0  # strengths: from where on a pressure counts as much as a plane that is near
_STEPS = 20


def alone(group: DissipationGroup) -> bool:
    """Whether there is a single plane with an apex at each point."""
    surfaces = group.surfaces
    assert surfaces is not None
    single = surfaces.count == 1 and surfaces.volumes == 1 and bool(surfaces.normed[0] > 0)
    return single and bool(np.all(surfaces.slope > 0))


class Apex:
    """One plane with an apex at each of m points.

    Attributes:
        lead: rows of what bounds ``||d||``, without weights, shape (m, n).
        offset: what is added to it, shape (m,).
        cost: of velocities, shape (n,).
    """

    def __init__(self, group: DissipationGroup) -> None:
        surfaces = group.surfaces
        assert surfaces is not None
        slope = surfaces.slope[:, 0, 0]
        self._slope, self._strength = slope, surfaces.strength[:, 0]
        self._share = surfaces.normed[0] / slope
        self.lead = csr_matrix(group.volumetric.multiply(self._share[:, None]))
        self.offset = -self._share * surfaces.besides
        self.cost = np.asarray(group.volumetric.T @ (group.weights * self._strength / slope))

    def mean(self, lead: Floats) -> Floats:
        """Mean stresses of multipliers of the lead, shape (m,)."""
        return np.asarray(self._strength / self._slope - self._share * lead)


@dataclass(frozen=True)
class Planes:
    """k planes at each of m points with d rows of D and L of V; those with a norm come first.

    Their cones are two arrays: of planes with a norm shape (1 + d, k_1 m), the others (1, k_2 m).

    Attributes:
        rows: of D and V, times what their multipliers are to be.
        slope: a, shape (k, L, m).
        strength: b, shape (k, m).
        normed: number k_1.
        given: e, shape (L, m).
        gain: of multipliers of V, per mean stress, shape (L, m).
    """

    rows: Rows
    slope: Floats
    strength: Floats
    normed: int
    given: Floats
    gain: Floats

    @classmethod
    def of(cls, group: DissipationGroup, loops: Loops) -> "Planes":
        """Those of a group."""
        surfaces = group.surfaces
        assert surfaces is not None
        m, _, volumes = surfaces.slope.shape
        order = np.argsort(-surfaces.normed, kind="stable")
        steepest = np.abs(surfaces.slope).max(axis=1)
        gain = 1 / np.where(steepest > 0, steepest, 1.0)
        changes = csr_matrix(group.volumetric.multiply(gain.reshape(-1, 1)))
        both = interleaved(group.rows, group.dim, changes, volumes)
        given = group.weights[:, None] * gain * surfaces.besides.reshape(m, volumes)
        return cls(
            rows=Rows.of(both, group.dim + volumes, group.weights, loops),
            slope=np.ascontiguousarray(
                (surfaces.slope[:, order] * gain[:, None]).transpose(1, 2, 0)
            ),
            strength=np.ascontiguousarray(surfaces.strength[:, order].T),
            normed=int((surfaces.normed > 0).sum()),
            given=np.ascontiguousarray(given.T),
            gain=np.ascontiguousarray(gain.T),
        )

    @property
    def sheared(self) -> int:
        """Rows d of a point."""
        return self.rows.dim - int(self.slope.shape[1])

    def cones(self, leads: Floats, sides: Floats) -> list[Floats]:
        """Of leads of shape (k, m), and what is beside those with a norm, (d, k_1 or 1, m)."""
        first = np.empty((1 + self.sheared, self.normed, self.rows.count))
        first[0], first[1:] = leads[: self.normed], sides
        return [first.reshape(1 + self.sheared, -1), leads[self.normed :].reshape(1, -1)]

    def leads(self, cones: Sequence[Floats]) -> Floats:
        """First components of all cones, shape (k, m)."""
        return np.concatenate([part[0] for part in cones]).reshape(self.strength.shape)

    def multipliers(self, tau: float, bounded: Floats) -> list[Floats]:
        """The z of all cones, of zeta of shape (d + L, m)."""
        d = self.sheared
        leads = tau * self.strength + np.einsum("klm,lm->km", self.slope, bounded[d:])
        return self.cones(leads, bounded[:d, None])

    def summed(self, cones: Sequence[Floats]) -> Floats:
        """``sum B_i^T x_i``, shape (d + L, m)."""
        d = self.sheared
        found = np.empty((self.rows.dim, self.rows.count))
        found[:d] = cones[0][1:].reshape(d, self.normed, -1).sum(axis=1)
        np.einsum("klm,km->lm", self.slope, self.leads(cones), out=found[d:])
        return found

    def cost(self, cones: Sequence[Floats]) -> float:
        """``sum c_i.x_i``."""
        return float(np.sum(self.strength * self.leads(cones)))

    def missed(self, velocity: Floats, tau: float, cones: Sequence[Floats]) -> Floats:
        """``R u - e tau - sum B_i^T x_i``, shape (d + L, m)."""
        found = self.rows.at(velocity) - self.summed(cones)
        found[self.sheared :] -= tau * self.given
        return found

    def inside(self) -> Floats:
        """Multipliers zeta inside of all planes, shape (d + L, m): none where that is inside.

        Without strength stress zero is at an edge. There p minimises a smooth maximum of what is
        used of planes, sharper and sharper until it is inside.
        """
        found = np.zeros((self.rows.dim, self.rows.count))
        size = np.median(np.abs(self.strength), axis=0)
        size = np.where(size > 0, size, np.abs(self.strength).max(axis=0))
        size = np.where(size > 0, size, 1.0)
        strength = self.strength / size
        apart = np.flatnonzero(strength.min(axis=0) < _INSIDE)
        slope, strength = self.slope[:, :, apart], strength[:, apart]
        p = np.zeros((apart.size, slope.shape[1]))
        for sharp in _SHARPER:
            out = _least(slope, strength, p) < _INSIDE
            if not out.any():
                break
            p[out] = _pushed(slope[:, :, out], strength[:, out], p[out], sharp)
        found[self.sheared :, apart] = p.T * size[apart]
        return found

    def mean(self, bounded: Floats) -> Floats:
        """Mean stresses, point by point, shape (m L,)."""
        return np.asarray(-(self.gain * bounded[self.sheared :]).T.ravel())


def _least(slope: Floats, strength: Floats, p: Floats) -> Floats:
    """What the nearest plane leaves, shape (m,)."""
    left = strength + np.einsum("klm,ml->km", slope, p)
    return np.asarray(left.min(axis=0))


def _pushed(slope: Floats, strength: Floats, p: Floats, sharp: float) -> Floats:
    """Newton's method for the log of ``sum exp(-sharp left_i)``, and little of ``|p|^2``."""
    own = np.eye(p.shape[1]) / _FAR**2
    for _ in range(_STEPS):
        left = strength + np.einsum("klm,ml->km", slope, p)
        share = np.exp(-sharp * (left - left.min(axis=0)))
        share /= share.sum(axis=0)
        mean = np.einsum("klm,km->ml", slope, share)
        spread = np.einsum("kim,kjm,km->mij", slope, slope, share)
        spread -= mean[:, :, None] * mean[:, None]
        slopes = p / _FAR**2 - mean
        step = np.linalg.solve(sharp * spread + own, slopes[:, :, None])[:, :, 0]
        # No longer than what all planes change little in: the curvature is that of this place.
        longest = np.abs(np.einsum("klm,ml->km", slope, step)).max(axis=0)
        p = p - step / np.maximum(1.0, sharp * longest / 2)[:, None]
    return p
