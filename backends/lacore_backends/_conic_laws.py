"""Regularised laws (T17, T18, T65) as stresses within cones. Not a backend.

Each law is ``max over sigma of sigma.x - sigma.C sigma/2`` with ``t = h - G sigma`` in cones, where
x are the rates of a point and C the compliances, 1/penalty. With multipliers z of the cones the
rates are the sum of elastic and plastic ones, ``x = C sigma + G^T z``; with hardening h grows with
z (T29).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix

from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.program import FrozenContact, KinematicProgram, interleaved
from lacore.program.dissipation import DissipationGroup
from lacore.program.regularization import Penalties, RegularisedPoint, RegularisedValues, by_shifts
from lacore.program.state import ProgramState
from lacore.program.surfaces import Surfaces

# constants of a law without prescribed rates and without hardening
_NONE, _ZERO = np.zeros((1, 1)), np.zeros((1, 1, 1))


@dataclass(frozen=True)
class Cones:
    """Cones of k kinds at each of m points, of c components each.

    Attributes:
        matrix: G, shape (m, k, c, dim).
        offset: h, shape (m, k, c).
        rise: increase of the first component of h by that of z, shape (m, k, 1).
    """

    matrix: Floats
    offset: Floats
    rise: Floats

    def strength(self, multiplier: Floats) -> Floats:
        """Return ``h + H z`` for multipliers of shape (m, k, c)."""
        return self.offset + self.risen(multiplier)

    def risen(self, multiplier: Floats) -> Floats:
        """Return ``H z``, shape (m, k, c)."""
        risen = np.zeros_like(multiplier)
        risen[..., :1] = self.rise * multiplier[..., :1]
        return risen

    def used(self, stress: Floats) -> Floats:
        """Return ``G sigma``, shape (m, k, c)."""
        return np.asarray(np.einsum("mkcd,md->mkc", self.matrix, stress))

    def rates(self, multiplier: Floats) -> Floats:
        """Return ``G^T z``, shape (m, dim)."""
        return np.asarray(np.einsum("mkcd,mkc->md", self.matrix, multiplier))


@dataclass(frozen=True)
class ConicLaw:
    """Law of m points with `dim` rates each.

    Attributes:
        rows: rows of the rates, shape (m dim, n).
        weights: weights of the points, shape (m,).
        prescribed: prescribed part of the rates, shape (m, dim).
        compliance: C, shape (dim,).
        cones: empty for a linear law.
    """

    rows: Sparse
    weights: Floats
    prescribed: Floats
    compliance: Floats
    cones: tuple[Cones, ...]

    @property
    def dim(self) -> int:
        """Rates of a point."""
        return int(self.compliance.size)

    def rates(self, velocity: Floats) -> Floats:
        """Return the rates of the rows alone, shape (m, dim)."""
        return np.asarray(self.rows @ velocity).reshape(-1, self.dim)

    def force(self, stress: Floats) -> Floats:
        """Return ``B^T W sigma``, shape (n,)."""
        return np.asarray(self.rows.T @ (self.weights[:, None] * stress).ravel())

    def energy(self, stress: Floats) -> float:
        """Return ``sum w sigma.C sigma/2``."""
        return float(self.weights @ (stress**2 @ self.compliance)) / 2

    def plastic(self, multipliers: Sequence[Floats]) -> tuple[float, float]:
        """Return the dissipation ``sum w (h + H z).z``, and half of the part from hardening."""
        dissipation = hardening = 0.0
        for cones, z in zip(self.cones, multipliers, strict=True):
            dissipation += float(self.weights @ np.sum(cones.strength(z) * z, axis=(1, 2)))
            hardening += float(self.weights @ np.sum(cones.risen(z) * z, axis=(1, 2))) / 2
        return dissipation, hardening


class ConicLaws:
    """All laws of a program at a frozen contact, bodies first."""

    def __init__(
        self, program: KinematicProgram, contact: FrozenContact, penalty: Penalties
    ) -> None:
        self._program, self._contact = program, contact
        self._dilatant = contact.dilatancy > 0
        bound = contact.bound
        self._rubs = ~self._dilatant & np.isfinite(bound) & (bound > 0)
        self._sticks = ~self._dilatant & np.isinf(bound)
        bodies = (_body(group, penalty) for group in program.groups)
        self.each: tuple[ConicLaw, ...] = (*bodies, *self._interfaces(contact, penalty))

    @property
    def pattern(self) -> tuple[Bools, Bools, Bools]:
        """Which contact points rub, stick and dilate, which determines the rows of all laws."""
        return self._rubs, self._sticks, self._dilatant

    def _interfaces(self, contact: FrozenContact, penalty: Penalties) -> list[ConicLaw]:
        """Return the laws of points that do not dilate, rub, stick, and dilate (T18)."""
        points, along = self._program.contact, np.arange(self._program.contact.tangent_dim)
        normal = np.array([1 / penalty.normal])
        tangential = np.full(along.size, 1 / penalty.tangential)

        def law(
            mask: Bools, rows: Sparse, opening: Floats, compliance: Floats, *cones: Cones
        ) -> ConicLaw:
            return ConicLaw(csr_matrix(rows), points.weights[mask], opening, compliance, cones)

        def slip(mask: Bools) -> Sparse:
            return csr_matrix(points.tangential[np.repeat(mask, along.size)])

        plain, dilatant, rubs = ~self._dilatant, self._dilatant, self._rubs
        pressing = np.ones((int(plain.sum()), 1, 1, 1))
        steep = _balls(np.zeros((int(dilatant.sum()), 1)), 1 + along, 1 + along.size)
        steep.matrix[:, 0, 0, 0] = contact.dilatancy[dilatant]
        opening = np.zeros((int(dilatant.sum()), 1 + along.size))
        opening[:, 0] = contact.shift[dilatant]
        return [
            law(
                plain,
                points.normal[plain],
                contact.shift[plain, None],
                normal,
                Cones(pressing, np.zeros(pressing.shape[:3]), _ZERO),
            ),
            law(
                rubs,
                slip(rubs),
                _NONE,
                tangential,
                _balls(contact.bound[rubs, None], along, along.size),
            ),
            law(self._sticks, slip(self._sticks), _NONE, tangential),
            law(
                dilatant,
                interleaved(csr_matrix(points.normal[dilatant]), 1, slip(dilatant), along.size),
                opening,
                np.append(normal, tangential),
                steep,
            ),
        ]

    def point(
        self,
        velocity: Floats,
        multiplier: float,
        stresses: Sequence[Floats],
        multipliers: Sequence[Sequence[Floats]],
    ) -> RegularisedPoint:
        """Return values, state and gradient for the result of a solver.

        Args:
            velocity: shape (n,).
            multiplier: multiplier of ``F0.U = 1``.
            stresses: stresses of each law, shape (m, dim).
            multipliers: multipliers of each kind of cones of each law, shape (m, k, c).

        They are those of the law at the velocity as far as the duality gap is zero. In any case the
        stresses are in equilibrium and within yield, so their load factor is at most alpha*.
        """
        state = self._state(velocity, stresses)
        pairs = list(zip(self.each, stresses, multipliers, strict=True))
        energy = sum(law.energy(stress) for law, stress, _ in pairs)
        powers = np.array([law.plastic(z) for law, _, z in pairs]).sum(axis=0)
        gradient = -self._program.dead_load
        for law, stress, _ in pairs:
            gradient = gradient + law.force(stress)
        plastic = float(powers[0]) - float(self._program.dead_load @ velocity)
        load_factor = plastic + 2 * energy + by_shifts(self._program, self._contact, state)
        values = RegularisedValues(plastic, plastic + energy, load_factor, multiplier)
        state = replace(state, load_factor=load_factor)
        return RegularisedPoint(values, values.alpha_reg - float(powers[1]), gradient, state)

    def _state(self, velocity: Floats, stresses: Sequence[Floats]) -> ProgramState:
        groups, rows = self._program.groups, self._program.contact
        bodies, (plain, rubbed, stuck, pushed) = stresses[: len(groups)], stresses[len(groups) :]
        shear, means = [], []
        for group, stress in zip(groups, bodies, strict=True):
            shear.append(stress[:, : group.dim])
            mean = stress[:, group.dim :]
            if group.surfaces is None:
                mean = group.volumetric_factor * mean[:, :1] + mean[:, 1:]
            means.append(mean.ravel())
        normal = np.zeros(rows.count)
        tangential = np.zeros((rows.count, rows.tangent_dim))
        normal[~self._dilatant], normal[self._dilatant] = -plain[:, 0], -pushed[:, 0]
        for mask, stress in (
            (self._rubs, rubbed),
            (self._sticks, stuck),
            (self._dilatant, pushed[:, 1:]),
        ):
            tangential[mask] = -stress
        return ProgramState(
            velocity=velocity,
            load_factor=float("nan"),
            stress=tuple(shear),
            mean_stress=tuple(means),
            normal_reaction=normal,
            tangential_reaction=tangential,
        )


def _body(group: DissipationGroup, penalty: Penalties) -> ConicLaw:
    """Return the law of a group: surfaces in (d, v) (T65), or a ball with theta (T17)."""
    if group.surfaces is not None:
        return _pressed(group, group.surfaces, penalty)
    theta = group.volumetric
    rows = interleaved(group.rows, group.dim, theta * group.volumetric_factor, 1)
    ball = np.arange(group.dim + 1)
    return ConicLaw(
        rows=interleaved(rows, ball.size, theta, 1),
        weights=group.weights,
        prescribed=_NONE,
        compliance=np.append(np.full(ball.size, 1 / penalty.eta), 1 / penalty.bulk),
        cones=(_balls(group.bound[:, None], ball, ball.size + 1, group.rise[:, None, None]),),
    )


def _pressed(group: DissipationGroup, surfaces: Surfaces, penalty: Penalties) -> ConicLaw:
    stiffness = penalty.of_rates(surfaces.volumes)
    prescribed = np.zeros((group.weights.size, group.dim + surfaces.volumes))
    prescribed[:, group.dim :] = -surfaces.besides.reshape(-1, surfaces.volumes)
    shear, mean = np.arange(group.dim), np.arange(group.dim, prescribed.shape[1])
    cones = []
    for normed in (True, False):
        own = (surfaces.normed > 0) == normed
        if not own.any():
            continue
        balls = _balls(
            surfaces.strength[:, own], shear if normed else shear[:0], prescribed.shape[1]
        )
        balls.matrix[:, :, 0, mean] = surfaces.slope[:, own]
        cones.append(balls)
    return ConicLaw(
        rows=interleaved(group.rows, group.dim, group.volumetric, surfaces.volumes),
        weights=group.weights,
        prescribed=prescribed,
        compliance=1 / np.append(np.full(group.dim, stiffness[0]), stiffness[1:]),
        cones=tuple(cones),
    )


def _balls(bound: Floats, inner: Ints, dim: int, rise: Floats = _ZERO) -> Cones:
    """Return the cones ``||sigma|| <= bound`` of the components `inner`; bounds of shape (m, k)."""
    matrix = np.zeros((*bound.shape, 1 + inner.size, dim))
    matrix[:, :, 1 + np.arange(inner.size), inner] = -1.0
    offset = np.zeros(matrix.shape[:3])
    offset[..., 0] = bound
    return Cones(matrix, offset, rise)
