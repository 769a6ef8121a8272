"""Regularised laws (T17, T18, T65) with a barrier that keeps stresses inside yield. Not a backend.

At rates x the energy of a point is

    max over sigma of sigma.x - sigma.C sigma/2 + mu sum_j log t_j,

where t_j is the distance of the stresses to each plane. A norm is two planes, since ``log(t^2 -
q^2)`` is ``log(t - q) + log(t + q)``. With shares ``z_j = mu/t_j`` of the normals, ``C sigma + G^T
z = x``. The law itself has mu = 0. For mu > 0 the energy is smooth, convex, and self-concordant, so
that Newton's method converges well.
"""

from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Bools, Floats, Ints
from lacore_backends._conic_laws import ConicLaw

_AWAY = 0.99  # share of the way to the planes
_NEAR = 1e-4  # relative step after which the next one would be round-off
_CENTRED = 2.0  # gap, by mu, below which mu is the aim of the next step
_FROM_NEAR, _FROM_AFAR = 12, 80  # limits of steps from a close and from a distant start
_STILL = 1e-12  # dimensionless rate that counts as zero
_TINY = 1e-150  # It keeps quotients of zeros finite.


@dataclass(frozen=True)
class Planes:
    """Planes ``normals.y <= bounds`` of j kinds at each of m points, in e unknowns y.

    y consists of ``q = ||s||`` if there is a norm, the other stresses, and the hardening of the
    strengths (T29) of each cone.

    Attributes:
        normals: shape (m, j, e).
        bounds: shape (m, j).
        compliance: shape (m, e).
    """

    normals: Floats
    bounds: Floats
    compliance: Floats


@dataclass(frozen=True)
class Centre:
    """Stresses at the centre of the barrier.

    Attributes:
        stress: y, shape (m, e).
        slacks, shares: t and z of the planes, shape (m, j).
    """

    stress: Floats
    slacks: Floats
    shares: Floats


@dataclass(frozen=True)
class Smoothed:
    """Smoothed law at a velocity.

    Attributes:
        energy: ``sum w`` times the energy of the points.
        stress: shape (m, dim).
        stiffness: ``w`` times the derivative of the stress by the rates, shape (m, dim, dim).
        multipliers: multipliers of each kind of cones, shape (m, k, c).
        sound: whether the centres of all points were found.
    """

    energy: float
    stress: Floats
    stiffness: Floats
    multipliers: tuple[Floats, ...]
    sound: bool


class BarrierLaw:
    """Barrier for one law; it starts from the centres of the last call."""

    def __init__(self, law: ConicLaw) -> None:
        self.law = law
        # The rows of a cone below the first are those of its norm, the same at all points.
        norms = [cones.matrix for cones in law.cones if cones.matrix.shape[2] > 1]
        self._normed = bool(norms)
        self._inner: Ints = np.zeros(0, dtype=np.intp)
        if norms and law.weights.size:
            self._inner = np.abs(norms[0][0, 0, 1:]).argmax(axis=1)
        elif norms:
            self._inner = np.arange(norms[0].shape[2] - 1)
        self._others: Ints = np.setdiff1d(np.arange(law.dim), self._inner)
        self._planes = self._made()
        self._last: Centre | None = None

    @property
    def volume(self) -> float:
        """Sum of the weights of all planes: the gap is mu times it."""
        return float(self.law.weights.sum() * self._planes.normals.shape[1])

    def _made(self) -> Planes:
        law, first = self.law, int(self._normed)
        felt = first + self._others.size
        kinds = [(cones, kind) for cones in law.cones for kind in range(cones.matrix.shape[1])]
        m, e = law.weights.size, felt + sum(cones.rise.any() for cones, _ in kinds)
        compliance = np.ones((m, e))
        compliance[:, :first] = law.compliance[self._inner[:first]]
        compliance[:, first:felt] = law.compliance[self._others]
        normals, bounds = [], []
        for cones, kind in kinds:
            normal = np.zeros((m, e))
            normal[:, first:felt] = cones.matrix[:, kind, 0, self._others]
            if cones.rise.any():
                rise = np.broadcast_to(cones.rise[:, kind % cones.rise.shape[1], 0], m)
                normal[:, felt] = -rise
                compliance[:, felt] = np.where(rise > 0, rise, 1.0)
                felt += 1
            for side in (1.0, -1.0) if cones.matrix.shape[2] > 1 else (0.0,):
                own = normal.copy()
                own[:, :first] = side
                normals.append(own)
                bounds.append(cones.offset[:, kind, 0])
        return Planes(
            np.stack(normals, axis=1) if normals else np.zeros((m, 0, e)),
            np.stack(bounds, axis=1) if bounds else np.zeros((m, 0)),
            compliance,
        )

    def at(self, velocity: Floats, mu: float) -> Smoothed:
        """Return energy, stresses and their derivative at a velocity of shape (n,)."""
        law, planes, first = self.law, self._planes, int(self._normed)
        rates = law.rates(velocity) + law.prescribed
        inner = rates[:, self._inner]
        length = np.linalg.norm(inner, axis=1)
        felt = np.zeros_like(planes.compliance)
        felt[:, :first] = length[:, None]
        felt[:, first : first + self._others.size] = rates[:, self._others]
        centre, sound = _centre(planes, felt, mu, self._last)
        self._last = centre if sound else None
        y = centre.stress
        energy = np.sum(y * (felt - planes.compliance * y / 2), axis=1)
        energy += mu * np.log(centre.slacks).sum(axis=1)
        along = inner / np.maximum(length, _TINY)[:, None]
        stress = np.empty_like(rates)
        stress[:, self._inner] = y[:, :first] * along
        stress[:, self._others] = y[:, first : first + self._others.size]
        return Smoothed(
            energy=float(law.weights @ energy),
            stress=stress,
            stiffness=law.weights[:, None, None] * self._stiffness(centre, along, length),
            multipliers=self._multipliers(centre.shares, along),
            sound=sound,
        )

    def _stiffness(self, centre: Centre, along: Floats, length: Floats) -> Floats:
        """Return the derivative of stresses by rates.

        It is that of y along d and ``q/||d||`` across it.
        """
        inner, others, first = self._inner, self._others, int(self._normed)
        tangent = _inverse(self._planes, centre)[:, : first + others.size, : first + others.size]
        found = np.empty((length.size, self.law.dim, self.law.dim))
        found[:, others[:, None], others] = tangent[:, first:, first:]
        if first:
            # At rest both are equal; close to it the quotient would be round-off.
            secant = tangent[:, 0, 0].copy()
            np.divide(centre.stress[:, 0], length, out=secant, where=length > _STILL)
            secant = np.clip(secant, 0.0, 1 / self._planes.compliance[:, 0])
            outer = along[:, :, None] * along[:, None, :]
            both = secant[:, None, None] * np.eye(inner.size)
            both = both + (tangent[:, 0, 0] - secant)[:, None, None] * outer
            cross = along[:, :, None] * tangent[:, 0, None, first:]
            found[:, inner[:, None], inner] = both
            found[:, inner[:, None], others] = cross
            found[:, others[:, None], inner] = cross.transpose(0, 2, 1)
        return found

    def _multipliers(self, shares: Floats, along: Floats) -> tuple[Floats, ...]:
        """Return the multipliers of the cones.

        The shares of a norm, and their difference along d.
        """
        found, at = [], 0
        for cones in self.law.cones:
            m, k, c = cones.offset.shape
            sides = 2 if c > 1 else 1
            own = shares[:, at : at + sides * k].reshape(m, k, sides)
            at += sides * k
            z = np.zeros((m, k, c))
            z[..., 0] = own.sum(axis=2)
            if c > 1:
                z[..., 1:] = -(own[..., 0] - own[..., 1])[..., None] * along[:, None]
            found.append(z)
        return tuple(found)


def _centre(planes: Planes, rates: Floats, mu: float, near: Centre | None) -> tuple[Centre, bool]:
    """Return the centres of all points, and whether all were found.

    Points that fail from a close start are computed from a distant one.
    """
    if not planes.bounds.size:
        return Centre(rates / planes.compliance, planes.bounds, planes.bounds), True
    found, moving = None, np.ones(rates.shape[0], dtype=bool)
    if near is not None:
        found, moving = _followed(planes, rates, mu, near, _FROM_NEAR)
    if moving.any():
        own = Planes(planes.normals[moving], planes.bounds[moving], planes.compliance[moving])
        slacks = np.maximum(own.bounds, 1.0)
        fastest = np.abs(rates[moving]).max(axis=1, keepdims=True)
        start = Centre(0 * rates[moving], slacks, np.maximum(mu / slacks, fastest))
        other, still = _followed(own, rates[moving], mu, start, _FROM_AFAR)
        found = other if found is None else _put(found, moving, other)
        return found, not still.any()
    assert found is not None
    return found, True


def _put(whole: Centre, where: Bools, part: Centre) -> Centre:
    found = Centre(whole.stress.copy(), whole.slacks.copy(), whole.shares.copy())
    found.stress[where], found.slacks[where] = part.stress, part.slacks
    found.shares[where] = part.shares
    return found


def _followed(
    planes: Planes, rates: Floats, mu: float, start: Centre, steps: int
) -> tuple[Centre, Bools]:
    """Return the centres by primal-dual steps of each point (Mehrotra), and which still move."""
    place, moving = start, np.ones(rates.shape[0], dtype=bool)
    for _ in range(steps):
        t, z = place.slacks, place.shares
        inverse = _inverse(planes, place)
        used = np.matmul(planes.normals, place.stress[:, :, None])[:, :, 0]
        missed = planes.bounds - used - t
        left = rates - planes.compliance * place.stress
        left = left - np.matmul(z[:, None, :], planes.normals)[:, 0]
        gap = np.mean(t * z, axis=1)
        far = gap > _CENTRED * mu
        aim = np.full(gap.size, mu)
        second = np.zeros_like(t)
        if far.any():
            dy, dt, dz = _step(place, inverse, left, missed, -t * z)
            share = _share(dt / t, dz / z, 1.0)[:, None]
            after = np.mean((t + share * dt) * (z + share * dz), axis=1)
            aim = np.where(far, np.maximum((after / gap) ** 3 * gap, mu), mu)
            second = np.where(far[:, None], dt * dz, 0.0)
        dy, dt, dz = _step(place, inverse, left, missed, aim[:, None] - t * z - second)
        quick = np.maximum(np.abs(dt / t).max(axis=1), np.abs(dz / z).max(axis=1))
        share = np.where(moving, _share(dt / t, dz / z, _AWAY), 0.0)[:, None]
        place = Centre(place.stress + share * dy, t + share * dt, z + share * dz)
        moving &= ~(quick <= _NEAR)
        if not moving.any():
            break
    return place, moving


def _inverse(planes: Planes, place: Centre) -> Floats:
    """Return the inverse matrix of stresses and shares of each point, shape (m, e + j, e + j).

    The shares are not eliminated, because small entries along the planes would be lost in large
    ones.
    """
    m, j, e = planes.normals.shape
    matrix = np.zeros((m, e + j, e + j))
    diagonal = np.arange(e + j)
    matrix[:, diagonal[:e], diagonal[:e]] = planes.compliance
    matrix[:, diagonal[e:], diagonal[e:]] = -place.slacks / place.shares
    matrix[:, e:, :e] = planes.normals
    matrix[:, :e, e:] = planes.normals.transpose(0, 2, 1)
    return np.asarray(np.linalg.inv(matrix))


def _step(
    place: Centre, inverse: Floats, left: Floats, missed: Floats, aim: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return the changes of y, t and z that remove the residuals and increase ``t z`` by an aim."""
    right = np.concatenate([left, missed - aim / place.shares], axis=1)
    found = np.matmul(inverse, right[:, :, None])[:, :, 0]
    dy, dz = found[:, : left.shape[1]], found[:, left.shape[1] :]
    return dy, (aim - place.slacks * dz) / place.shares, dz


def _share(first: Floats, second: Floats, away: float) -> Floats:
    """Return the largest share of a step of relative changes that keeps all positive.

    The shape is (m,).
    """
    lowest = np.minimum(first.min(axis=1), second.min(axis=1))
    return np.asarray(np.minimum(1.0, away / np.maximum(-lowest, _TINY)))
