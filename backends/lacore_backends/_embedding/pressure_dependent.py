"""Groups with strength that depends on pressure (T39).

    D u = sum_i n_i d_i,  V u - e = sum_i a_i lam_i,  ||d_i|| <= lam_i,  cost sum_i b_i lam_i

n_i is 1, or 0 for a plane in p alone, for which ``lam_i >= 0``. The multipliers of the rows of a
point are ``zeta = (s, p)``, and those of its cones are affine in them,

    z_i = tau c_i + B_i zeta,  c_i = (b_i, 0),  B_i zeta = (a_i.p, n_i s)

Steps ``dz_i`` are therefore steps of zeta, and all flows ``x_i = (lam_i, d_i)`` are eliminated at
their point for any number of planes. The compliance of the velocities is ``C = sum B_i^T W_i^2
B_i``.

A single plane with an apex is one cone of ``(theta/a, d)``, and its cost a dead load (T38).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from lacore.numerics.arrays import Floats
from lacore.numerics.interleaving import interleaved
from lacore.program import DissipationGroup
from lacore_backends._embedding.loops.best import Loops
from lacore_backends._embedding.rows import Rows

_INSIDE = 0.01  # share of the strengths of a point that all planes must keep at the initial stress
_SHARPER = (4.0, 16.0, 64.0, 256.0, 1024.0)  # sharpness of the smooth maximum, per strength
_FAR = 4.0  # pressure, in strengths, that counts as much as a close plane
_STEPS = 20


def alone(group: DissipationGroup) -> bool:
    """Return whether each point has a single plane with an apex."""
    surfaces = group.surfaces
    assert surfaces is not None
    single = surfaces.count == 1 and surfaces.volumes == 1 and bool(surfaces.normed[0] > 0)
    return single and bool(np.all(surfaces.slope > 0))


class Apex:
    """One plane with an apex at each of m points.

    Attributes:
        lead: rows of the bound of ``||d||``, without weights, shape (m, n).
        offset: constant of this bound, shape (m,).
        cost: cost of velocities, shape (n,).
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
        """Return the mean stresses for multipliers of the lead, shape (m,)."""
        return np.asarray(self._strength / self._slope - self._share * lead)


@dataclass(frozen=True)
class Planes:
    """k planes at each of m points with d rows of D and L of V; those with a norm come first.

    Their cones are two arrays: planes with a norm have shape (1 + d, k_1 m), the others (1, k_2 m).

    Attributes:
        rows: rows of D and V, times the scale of their multipliers.
        slope: a, shape (k, L, m).
        strength: b, shape (k, m).
        normed: number k_1.
        given: e, shape (L, m).
        gain: multiplier of V per mean stress, shape (L, m).
    """

    rows: Rows
    slope: Floats
    strength: Floats
    normed: int
    given: Floats
    gain: Floats

    @classmethod
    def of(cls, group: DissipationGroup, loops: Loops) -> "Planes":
        """Return the planes of a group."""
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
        """Return the cones with these leads, shape (k, m), and sides of shape (d, k_1 or 1, m)."""
        first = np.empty((1 + self.sheared, self.normed, self.rows.count))
        first[0], first[1:] = leads[: self.normed], sides
        return [first.reshape(1 + self.sheared, -1), leads[self.normed :].reshape(1, -1)]

    def leads(self, cones: Sequence[Floats]) -> Floats:
        """Return the first components of all cones, shape (k, m)."""
        return np.concatenate([part[0] for part in cones]).reshape(self.strength.shape)

    def multipliers(self, tau: float, bounded: Floats) -> list[Floats]:
        """Return the z of all cones for zeta of shape (d + L, m)."""
        d = self.sheared
        leads = tau * self.strength + np.einsum("klm,lm->km", self.slope, bounded[d:])
        return self.cones(leads, bounded[:d, None])

    def summed(self, cones: Sequence[Floats]) -> Floats:
        """Return ``sum B_i^T x_i``, shape (d + L, m)."""
        d = self.sheared
        found = np.empty((self.rows.dim, self.rows.count))
        found[:d] = cones[0][1:].reshape(d, self.normed, -1).sum(axis=1)
        np.einsum("klm,km->lm", self.slope, self.leads(cones), out=found[d:])
        return found

    def cost(self, cones: Sequence[Floats]) -> float:
        """Return ``sum c_i.x_i``."""
        return float(np.sum(self.strength * self.leads(cones)))

    def missed(self, velocity: Floats, tau: float, cones: Sequence[Floats]) -> Floats:
        """Return ``R u - e tau - sum B_i^T x_i``, shape (d + L, m)."""
        found = self.rows.at(velocity) - self.summed(cones)
        found[self.sheared :] -= tau * self.given
        return found

    def inside(self) -> Floats:
        """Return multipliers zeta inside all planes, shape (d + L, m): zero if zero is inside.

        Without cohesion, zero stress is on an edge. There p minimises a smooth maximum of the
        utilisation of the planes, which is sharpened until p is inside.
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
        """Return the mean stress of each point, shape (m L,)."""
        return np.asarray(-(self.gain * bounded[self.sheared :]).T.ravel())


def _least(slope: Floats, strength: Floats, p: Floats) -> Floats:
    """Return the margin to the nearest plane, shape (m,)."""
    left = strength + np.einsum("klm,ml->km", slope, p)
    return np.asarray(left.min(axis=0))


def _pushed(slope: Floats, strength: Floats, p: Floats, sharp: float) -> Floats:
    """Minimise the log of ``sum exp(-sharp left_i)`` plus a little ``|p|^2`` by Newton's method."""
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
        # Limit the step, because the curvature changes where the margins of planes change much.
        longest = np.abs(np.einsum("klm,ml->km", slope, step)).max(axis=0)
        p = p - step / np.maximum(1.0, sharp * longest / 2)[:, None]
    return p
