"""Yield surfaces that depend on pressure, and their dissipation (T39, T40).

At each point stresses ``q = ||s||`` and ``p`` stay within planes, and flow is normal to them:

    normed_i q + slope_i . p <= strength_i
    ||d|| <= sum_i normed_i lam_i,  v = sum_i slope_i lam_i,  lam >= 0,  D = sum_i strength_i lam_i

Here s and d belong to the cone rows, p and v to the volumetric rows. The planes bound a polyhedron
of (q, p). Its corners give the dissipation, ``D = max (q ||d|| + p . v)``, and its unbounded edges
the possible flow, ``q ||d|| + p . v <= 0`` along each. For Mohr-Coulomb in plane strain there is
one corner, the apex, and ``D = c cot(phi) theta`` with ``theta >= sin(phi) ||d||`` (T38).

Non-associated flow (dilation angle smaller than the friction angle, T49) becomes convex if friction
is frozen at a pressure, or if flow is frozen. Both give surfaces with associated flow (T52, T88).
"""

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np

from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.numerics.polyhedra import corners, far_edges, nearest
from lacore.reporting.showing import Compact

_SWEEPS = 3  # corrections of a strain rate that violates edges, of which there are few
_ON = 1e-9  # of the sizes of the terms: a point closer to a plane lies on it


@dataclass(frozen=True)
class ClosestPoint:
    """Stresses within surfaces that are closest to elastic ones (T65).

    Attributes:
        stress: (q, p), shape (m, 1+L), Pa.
        tangent: derivative by ``(||d||, v)``, symmetric, shape (m, 1+L, 1+L), Pa s.
    """

    stress: Floats
    tangent: Floats


@dataclass(frozen=True, repr=False)
class Surfaces(Compact):
    """Yield surfaces of m points, k of each, in L volumetric rows.

    Attributes:
        slope: Outward normals in p, shape (m, k, L).
        strength: Strengths, Pa, shape (m, k).
        normed: 1 for planes that depend on ``||s||``, 0 for planes in p alone, shape (k,).
        dilation: Volumetric rates in addition to those of flow, shape (m L,), 1/s; None for none.
            With them a velocity is strictly inside the possible flow (T45).
        flow: Slopes of the dilation on each surface, shape (m, k, L), the first at most as large as
            `slope`; None for `slope`, which is associated flow.
    """

    slope: Floats
    strength: Floats
    normed: Floats
    dilation: Floats | None = None
    flow: Floats | None = None

    @property
    def numbers(self) -> dict[str, Floats]:
        """Arrays that must be finite, by name."""
        numbers = {"slope": self.slope.ravel(), "strength of surfaces": self.strength.ravel()}
        if self.flow is not None:
            numbers["slope of flow"] = self.flow.ravel()
        return numbers

    @property
    def count(self) -> int:
        """Surfaces k of each point."""
        return int(self.normed.size)

    @property
    def volumes(self) -> int:
        """Volumetric rows L of each point."""
        return int(self.slope.shape[2])

    @property
    def besides(self) -> Floats:
        """`dilation`, or zeros without it, shape (m L,), 1/s."""
        none = np.zeros(self.strength.shape[0] * self.volumes)
        return none if self.dilation is None else self.dilation

    def times(self, factor: float | Floats, rate: float | Floats = 1.0) -> "Surfaces":
        """Return surfaces with strengths and rates times one factor, or one per point, (m,)."""
        dilation = self.dilation
        if dilation is not None:
            dilation = (dilation.reshape(-1, self.volumes) * np.reshape(rate, (-1, 1))).ravel()
        return replace(
            self, strength=self.strength * np.reshape(factor, (-1, 1)), dilation=dilation
        )

    def raised(self, by: Floats) -> "Surfaces":
        """Return surfaces with a higher strength of those that bound ``||s||``, shape (m,), Pa."""
        return replace(self, strength=self.strength + self.normed * by[:, None])

    def at(self, points: Bools | Ints) -> "Surfaces":
        """Return the surfaces of points, given by a mask or by numbers, without dilation."""
        return replace(
            self,
            slope=self.slope[points],
            strength=self.strength[points],
            dilation=None,
            flow=None if self.flow is None else self.flow[points],
        )

    def associated(self) -> "Surfaces":
        """Return the surfaces with flow normal to them."""
        return replace(self, flow=None)

    def friction(self, mean: Floats) -> Floats:
        """Return the friction at mean stresses of shape (m L,), shape (m, k), Pa, >= 0.

        It is ``(sin(phi) - sin(psi)) pi`` (T50), where pi is the pressure from the apex that acts
        on the surface (T88). It is zero for associated flow.
        """
        felt = np.einsum("mkl,ml->mk", self._kept, mean.reshape(-1, self.volumes))
        return np.asarray(np.maximum(self._of_friction * self.strength - felt, 0.0))

    def at_friction(self, friction: Floats) -> "Surfaces":
        """Return the surfaces with associated flow at a frozen friction (T52, K-step).

        Args:
            friction: Friction as of `friction`, shape (m, k), Pa.
        """
        rubs = np.any(self._kept, axis=(0, 2))
        first = int(rubs.argmax())
        apex = np.zeros_like(self.slope[:, :1])
        apex[:, 0, 0] = self.slope[:, first, 0]
        strength = (1.0 - self._of_friction) * self.strength + rubs * friction
        return Surfaces(
            slope=np.concatenate([self.slope - self._kept, apex], axis=1),
            strength=np.column_stack([strength, self.strength[:, first]]),
            normed=np.append(self.normed, 0.0),
        )

    def at_flow(self, multipliers: Floats) -> "Surfaces":
        """Return the surfaces with associated flow at a frozen flow (T52, S-step).

        Args:
            multipliers: Rates of flow on the surfaces, shape (m, k), 1/s.
        """
        more = np.einsum("mkl,mk->ml", self._kept, multipliers).ravel()
        return replace(self, dilation=self.besides - more, flow=None)

    def davis(self) -> "Surfaces":
        """Return surfaces with Davis's strength, that of lines without extension (T55)."""
        sine = self.slope[:, :, 0]
        cosine, dilating = np.sqrt(1 - sine**2), sine - self._kept[:, :, 0]
        share = np.sqrt(1 - dilating**2) * cosine / (1 - dilating * sine)
        tangent = share * sine / cosine
        along = 1 / np.sqrt(1 + tangent**2)
        strength = self.strength * share * along / cosine
        slope = (tangent * along)[:, :, None]
        return replace(self, slope=slope, strength=strength, flow=None)

    @property
    def _kept(self) -> Floats:
        """Part of the slopes without dilation, shape (m, k, L)."""
        return np.zeros_like(self.slope) if self.flow is None else self.slope - self.flow

    @property
    def _of_friction(self) -> Floats:
        """Share of each strength that is friction at the common apex, shape (m, k).

        At the apex p is ``(H, 0)``, because the first volumetric row is that of the volume.
        """
        kept, own = self._kept[:, :, 0], self.slope[:, :, 0]
        return np.asarray(np.divide(kept, own, out=np.zeros_like(kept), where=kept != 0))

    @property
    def largest_shear(self) -> float:
        """Largest ``||s||`` of all points at any pressure, Pa; inf if it grows with pressure."""
        if (self._edges[:, :, 0] > 0).any():
            return np.inf
        corners, real = self._corners
        return float(corners[:, :, 0].max(where=real, initial=0.0))

    def use(self, size: Floats, mean: Floats) -> Floats:
        """Return the used strength ``normed q + slope . p``, shape (m, k), Pa.

        Args:
            size: Norm ``||s||``, shape (m,), Pa.
            mean: Mean stresses p, shape (m L,), point after point, Pa.
        """
        pressed = np.einsum("mkl,ml->mk", self.slope, mean.reshape(-1, self.volumes))
        return np.asarray(self.normed * size[:, None] + pressed)

    def strength_at(self, mean: Floats) -> Floats:
        """Return the largest ``||s||`` at p of shape (m L,): shape (m,), Pa; 0 outside."""
        room = self.strength - self.use(np.zeros(self.strength.shape[0]), mean)
        return np.asarray(np.maximum(room[:, self.normed > 0].min(axis=1), 0.0))

    def beyond(self, size: Floats, mean: Floats) -> Floats:
        """Return the relative excess of stresses over the surfaces, shape (m,); NaN for NaN.

        It is relative to the terms of the surface, or to their mean over all points if that is
        larger, because all terms vanish at an apex. Each surface has its own scale: a crushing
        strength is not a scale for a cohesion.
        """
        if not size.size:
            return np.zeros(0)
        pressed = np.abs(mean).reshape(-1, self.volumes)
        own = np.abs(self.strength) + np.einsum("mkl,ml->mk", np.abs(self.slope), pressed)
        scale = np.maximum(own, own.mean(axis=0))
        excess = self.use(size, mean) - self.strength
        return np.asarray(np.max(excess / np.where(scale > 0, scale, 1.0), axis=1))

    def dissipation(self, length: Floats, volume: Floats) -> Floats:
        """Return the dissipation per volume of strain rates, shape (m,).

        Impossible rates are first replaced by possible ones with other volumetric rates. At small
        friction angles the apex is far away, so the residual of ``theta >= sin(phi) ||d||`` would
        otherwise change the dissipation considerably.

        Args:
            length: Norm ``||d||``, shape (m,).
            volume: Volumetric rates v, shape (m L,), point after point.
        """
        if self.flow is not None:
            raise ValueError("flow that is not associated dissipates at a friction: freeze it")
        if not length.size:
            return np.zeros(0)
        rates = self._possible(np.column_stack([length, volume.reshape(-1, self.volumes)]))
        corners, real = self._corners
        powers = np.einsum("mvl,ml->mv", corners, rates)
        return np.asarray(np.where(real, powers, -np.inf).max(axis=1, initial=-np.inf))

    def _possible(self, rates: Floats) -> Floats:
        """Return rates whose volumetric part is corrected to satisfy the edges, shape (m, 1+L)."""
        size = np.sum(self._edges[:, :, 1:] ** 2, axis=2)
        for _ in range(_SWEEPS):
            powers = np.einsum("mel,ml->me", self._edges, rates)
            worst = powers.argmax(axis=1)[:, None]
            wrong = np.maximum(np.take_along_axis(powers, worst, axis=1), 0.0)
            if not wrong.any():
                break
            edge = np.take_along_axis(self._edges, worst[:, :, None], axis=1)[:, 0, 1:]
            own = np.take_along_axis(size, worst, axis=1)
            rates = rates.copy()
            rates[:, 1:] -= wrong / np.where(own > 0, own, 1.0) * edge
        return rates

    def multipliers(self, length: Floats, volume: Floats) -> Floats:
        """Return the rates of flow on the surfaces with the least dissipation, (m, k), 1/s, >= 0.

        Of several possibilities with the same dissipation the slowest is returned. Impossible rates
        are replaced as in `dissipation`.
        """
        normals, felt = self.planes[0], np.append(True, ~self._lines)
        rates = self._possible(np.column_stack([length, volume.reshape(-1, self.volumes)]))
        corner = self._met[1].T
        found = np.zeros((len(corner), *normals.shape[:2]))
        for flowing, chosen, real in zip(found, self._bases, corner, strict=True):
            matrix = np.where(
                real[:, None, None], normals[:, chosen][:, :, felt], np.eye(felt.sum())
            )
            own = np.linalg.solve(matrix.transpose(0, 2, 1), rates[:, felt, None])[:, :, 0]
            flowing[:, chosen] = np.where(real[:, None], own, np.nan)
        least, most = found.min(axis=2), np.abs(found).max(axis=2)
        flows = least >= -_ON * most
        slowest = np.where(flows, found.sum(axis=2), np.inf).argmin(axis=0)
        nearest_by = np.where(corner, least, -np.inf).argmax(axis=0)
        choice = np.where(flows.any(axis=0), slowest, nearest_by)
        best = np.take_along_axis(found, choice[None, :, None], axis=0)[0]
        return np.asarray(np.nan_to_num(np.maximum(best[:, : self.count], 0.0)))

    def impossible(self, length: Floats, volume: Floats) -> Floats:
        """Return how far strain rates are from possible flow, shape (m,), 1/s; <= 0 if possible.

        For Mohr-Coulomb it is ``sin(phi) ||d|| - theta``. It is -inf if all flow is possible.
        """
        if not length.size:
            return np.zeros(0)
        rates = np.column_stack([length, volume.reshape(-1, self.volumes)])
        powers = np.einsum("mel,ml->me", self._edges, rates)
        return np.asarray(np.where(self._edges.any(axis=2), powers, -np.inf).max(axis=1))

    def closest_point(self, rates: Floats, stiffness: Floats) -> ClosestPoint:
        """Return the stresses within the surfaces that are closest to ``stiffness * rates``.

        The distance is the elastic energy ``sum stress^2/(2 stiffness)``.

        Args:
            rates: Rates ``(||d||, v)``, shape (m, 1+L), 1/s.
            stiffness: Stiffness of each of them, shape (1+L,), Pa s.
        """
        root = np.sqrt(stiffness)
        normals, strengths = self.planes
        found = nearest(normals * root, strengths, rates * root)
        return ClosestPoint(found.points * root, found.along * root * root[:, None])

    @cached_property
    def _lines(self) -> Bools:
        """Volumetric rows that no surface depends on, so that no flow is possible, shape (L,)."""
        return np.asarray(~self.slope.any(axis=(0, 1)))

    @cached_property
    def planes(self) -> tuple[Floats, Floats]:
        """Normals in (q, p), shape (m, k+1, 1+L), and strengths (m, k+1), of ``-q <= 0`` last."""
        m = self.slope.shape[0]
        normed = np.broadcast_to(self.normed[:, None], (m, self.count, 1))
        own = np.concatenate([normed, self.slope], axis=2)
        last = np.zeros((m, 1, 1 + self.volumes))
        last[:, :, 0] = -1.0
        normals = np.concatenate([own, last], axis=1)
        return normals, np.concatenate([self.strength, np.zeros((m, 1))], axis=1)

    @property
    def _bases(self) -> list[tuple[int, ...]]:
        """Sets of planes that may meet in a point; there are v sets."""
        size = 1 + self.volumes - int(self._lines.sum())
        return list(combinations(range(self.count + 1), size))

    @cached_property
    def _met(self) -> tuple[Floats, Bools]:
        """Points in which planes meet, and which of them are corners: (m, v, 1+L), (m, v)."""
        felt = np.append(True, ~self._lines)
        if _alike(self.slope) and _alike(self.strength):
            met, real = corners(*self._one.planes, felt)
            return _of_all(met, self.strength.shape[0]), _of_all(real, self.strength.shape[0])
        return corners(*self.planes, felt)

    @cached_property
    def _corners(self) -> tuple[Floats, Bools]:
        """The same for sets of planes that form a corner at some point."""
        met, real = self._met
        somewhere = real.any(axis=0)
        return met[:, somewhere], real[:, somewhere]

    @property
    def _one(self) -> "Surfaces":
        """Surfaces of the first point."""
        return self.at(np.arange(1))

    @property
    def edges(self) -> Floats:
        """Directions of stresses (q, p) without a bound, or zeros: shape (m, e, 1+L)."""
        return self._edges

    @cached_property
    def _edges(self) -> Floats:
        """Directions (q, p) to infinity, largest of p 1, or zeros: shape (m, e, 1+L)."""
        if _alike(self.slope):
            return np.asarray(_of_all(far_edges(self._one.planes[0]), self.slope.shape[0]))
        return far_edges(self.planes[0])


def _alike(values: Floats) -> bool:
    """Whether several points all have the same values, as those of a uniform soil."""
    return values.shape[0] > 1 and bool(np.all(values == values[:1]))


def _of_all(values: Any, count: int) -> Any:
    """Return the values of one point for `count` points, without copies."""
    return np.broadcast_to(values, (count, *values.shape[1:]))
