"""Stresses, slacks and multipliers of a law as cones, and their Newton steps. Not a backend.

They are eliminated point by point. With the scaling W of the cones, A = W^-1 G and y = W dz,

    C dsigma + A^T y = B dU + ...,   A dsigma - (1 + W^-1 H W^-1) y = ...,

where H is the hardening of the strengths. Both unknowns are kept: on the edge of a cone W^2 has
values as large as 1/mu and as small as mu, and stresses computed without y would be inaccurate.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.numerics.second_order_cones import (
    Scaling,
    applied,
    farthest,
    outside,
    product,
    quotient,
)
from lacore_backends._conic_laws import ConicLaw


@dataclass(frozen=True)
class Place:
    """Stresses, slacks and multipliers of the points of a law, or a step of them.

    Attributes:
        stress: sigma, shape (m, dim).
        slacks, multipliers: t and z of each kind of cones, shape (m, k, c).
    """

    stress: Floats
    slacks: tuple[Floats, ...]
    multipliers: tuple[Floats, ...]

    @property
    def sound(self) -> bool:
        """Whether all slacks and multipliers are strictly inside of their cones."""
        return all(outside(part) < 0 for part in (*self.slacks, *self.multipliers))

    def moved(self, step: "Place", share: float) -> "Place":
        """Return the place after a share of a step."""
        return Place(
            self.stress + share * step.stress,
            _moved(self.slacks, step.slacks, share),
            _moved(self.multipliers, step.multipliers, share),
        )

    def raised(self, slack: float, multiplier: float) -> "Place":
        """Return the place with slacks and multipliers moved along the axes of their cones."""
        return Place(
            self.stress, _raised(self.slacks, slack), _raised(self.multipliers, multiplier)
        )

    def farthest(self, step: "Place") -> float:
        """Return the largest share of a step that stays within all cones."""
        pairs = [
            *zip(self.slacks, step.slacks, strict=True),
            *zip(self.multipliers, step.multipliers, strict=True),
        ]
        return min((farthest(part, change) for part, change in pairs), default=np.inf)


@dataclass(frozen=True)
class Points:
    """Law at a place and a velocity, ready for Newton steps.

    Attributes:
        law: the law.
        place: stresses, slacks and multipliers.
        scalings: scalings of each kind of cones.
        rates: residual of the rates, shape (m, dim).
        strengths: residual of the strengths of each kind of cones, shape (m, k, c).
    """

    law: ConicLaw
    place: Place
    scalings: tuple[Scaling, ...]
    rates: Floats
    strengths: tuple[Floats, ...]

    @classmethod
    def at(cls, law: ConicLaw, place: Place, velocity: Floats) -> "Points":
        """Return the points at a place inside all cones."""
        rates = law.rates(velocity) + law.prescribed - place.stress * law.compliance
        strengths = []
        for cones, t, z in zip(law.cones, place.slacks, place.multipliers, strict=True):
            rates = rates - cones.rates(z)
            strengths.append(cones.strength(z) - cones.used(place.stress) - t)
        pairs = zip(place.slacks, place.multipliers, strict=True)
        scalings = tuple(Scaling.between(t, z) for t, z in pairs)
        return cls(law, place, scalings, rates, tuple(strengths))

    @classmethod
    def start(cls, law: ConicLaw) -> "Points":
        """Return the points at zero without cones: a step from there is a place with ``t = -z``."""
        offsets = tuple(cones.offset for cones in law.cones)
        nothing = tuple(np.zeros_like(h) for h in offsets)
        stress = np.zeros((law.weights.size, law.dim))
        scalings = tuple(Scaling.none(h) for h in offsets)
        return cls(law, Place(stress, nothing, nothing), scalings, stress + law.prescribed, offsets)

    @cached_property
    def _inverse(self) -> Floats:
        """Inverse of the matrix of stresses and y of each point, shape (m, e, e)."""
        m, dim = self.place.stress.shape
        sizes = [h.shape[1] * h.shape[2] for h in self.place.slacks]
        matrix = np.zeros((m, dim + sum(sizes), dim + sum(sizes)))
        diagonal = np.arange(matrix.shape[1])
        matrix[:, diagonal, diagonal] = np.append(self.law.compliance, -np.ones(sum(sizes)))
        first = dim
        for cones, scaling in zip(self.law.cones, self.scalings, strict=True):
            k, c = cones.offset.shape[1:]
            own = slice(first, first + k * c)
            scaled = (scaling.inverse @ cones.matrix).reshape(m, k * c, dim)
            matrix[:, own, :dim], matrix[:, :dim, own] = scaled, scaled.transpose(0, 2, 1)
            if cones.rise.any():
                column = scaling.inverse[..., 0]
                rise = cones.rise[..., None] * column[..., :, None] * column[..., None, :]
                for kind in range(k):
                    at = slice(first + kind * c, first + (kind + 1) * c)
                    matrix[:, at, at] -= rise[:, kind]
            first += k * c
        return np.asarray(np.linalg.inv(matrix))

    @property
    def stiffness(self) -> Floats:
        """``W K`` of ``B^T W K B``, shape (m, dim, dim)."""
        dim = self.law.dim
        block = self._inverse[:, :dim, :dim]
        return np.asarray(
            (block + block.transpose(0, 2, 1)) * (self.law.weights / 2)[:, None, None]
        )

    @property
    def gap(self) -> float:
        """Complementarity gap ``sum w t.z``, as a power."""
        pairs = zip(self.place.slacks, self.place.multipliers, strict=True)
        return sum(float(self.law.weights @ np.sum(t * z, axis=(1, 2))) for t, z in pairs)

    @property
    def missed_power(self) -> float:
        """Power of the residuals of rates and strengths with the present stresses."""
        power = np.sum(np.abs(self.rates * self.place.stress), axis=1)
        for missed, z in zip(self.strengths, self.place.multipliers, strict=True):
            power = power + np.sum(np.abs(missed * z), axis=(1, 2))
        return float(self.law.weights @ power)

    def missed(self, fastest: float) -> float:
        """Return the largest residual of rates, by the largest velocity, or of strengths."""
        parts = (self.rates / fastest, *self.strengths)
        return max(float(np.abs(part).max(initial=0.0)) for part in parts)

    @property
    def volume(self) -> float:
        """Sum of the weights of all cones: mu is the gap by it."""
        kinds = sum(part.shape[1] for part in self.place.slacks)
        return float(kinds * self.law.weights.sum())

    def at_rest(self) -> list[Floats]:
        """Return zero aims."""
        return [np.zeros_like(scaling.middle) for scaling in self.scalings]

    def to_edges(self) -> list[Floats]:
        """Return the aims of a step to the edges of all cones: ``t o z = 0``."""
        return [-scaling.middle for scaling in self.scalings]

    def to_centre(self, mu: float, step: Place) -> list[Floats]:
        """Return the aims of a step to ``t o z = mu e``, corrected for the error of another one."""
        aims = []
        for scaling, dt, dz in zip(self.scalings, step.slacks, step.multipliers, strict=True):
            left = product(applied(scaling.inverse, dt), scaling.times(dz))
            wanted = -left - product(scaling.middle, scaling.middle)
            wanted[..., 0] += mu
            aims.append(quotient(scaling.middle, wanted))
        return aims

    def right(self, aims: Sequence[Floats]) -> Floats:
        """Return the right-hand sides of all points for aims at a fixed velocity, shape (m, e)."""
        parts = zip(self.scalings, self.strengths, aims, strict=True)
        cones = [applied(scaling.inverse, missed) - aim for scaling, missed, aim in parts]
        return np.concatenate(
            [
                self.rates,
                *(part.reshape(part.shape[0], math.prod(part.shape[1:])) for part in cones),
            ],
            axis=1,
        )

    def force(self, right: Floats) -> Floats:
        """Return the nodal forces of the stresses for right-hand sides, shape (n,)."""
        return self.law.force(applied(self._inverse[:, : self.law.dim], right))

    def step(self, right: Floats, change: Floats) -> Place:
        """Return the step for right-hand sides and a change of velocity, shape (n,)."""
        dim = self.law.dim
        right = right.copy()
        right[:, :dim] += self.law.rates(change)
        found = applied(self._inverse, right)
        stress, first = found[:, :dim], dim
        slacks, multipliers = [], []
        for cones, scaling, missed in zip(
            self.law.cones, self.scalings, self.strengths, strict=True
        ):
            shape = cones.offset.shape
            scaled = found[:, first : first + shape[1] * shape[2]].reshape(shape)
            first += shape[1] * shape[2]
            dz = applied(scaling.inverse, scaled)
            slacks.append(missed - cones.used(stress) + cones.risen(dz))
            multipliers.append(dz)
        return Place(stress, tuple(slacks), tuple(multipliers))


def _moved(
    parts: tuple[Floats, ...], steps: tuple[Floats, ...], share: float
) -> tuple[Floats, ...]:
    return tuple(part + share * step for part, step in zip(parts, steps, strict=True))


def _raised(parts: tuple[Floats, ...], by: float) -> tuple[Floats, ...]:
    return tuple(part + by * (np.arange(part.shape[-1]) == 0) for part in parts)
