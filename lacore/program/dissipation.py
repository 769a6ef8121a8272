"""Dissipation in the bodies of a program: cones, and surfaces that depend on pressure."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import csr_matrix, diags_array

from lacore.numerics.arrays import Floats, Sparse
from lacore.program.surfaces import Surfaces
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact

_ROUND_OFF = 16 * float(np.finfo(float).eps)  # of sums with about 16 terms
_DOUBTFUL = 1e-12  # of the largest term in a sum; larger values are not round-off
_CANCELLED = 1e-13  # of the largest entry of a row; smaller entries are round-off of sums


@dataclass(frozen=True, repr=False)
class DissipationGroup(Compact):
    """Cones of one kind: ``sum_g weights_g bound_g ||(rows U)_g||`` with ``volumetric U = 0``.

    Hardening adds ``weights_g modulus_g ||(rows U)_g||^2/2`` (T29): the stress at yield is then
    ``bound + modulus ||rows U||``. If strength depends on pressure, `surfaces` define the
    dissipation and the possible flow, in place of `bound` and ``volumetric U = 0``.

    Attributes:
        name: Name for messages and results.
        rows: Stacked cone rows, shape (m dim, n); cone g owns rows g dim ... (g+1) dim - 1.
        dim: Number of rows in a cone.
        weights: Integration weights, shape (m,), m^3; m^2 for plane bodies of unit thickness.
        bound: Largest norm of the conjugate stress, at zero pressure if there are `surfaces`, shape
            (m,), Pa.
        volumetric: Rows of theta, shape (m L, n). L is 1 unless surfaces depend on more stresses.
        volumetric_factor: See `lacore.model.materials.conic_form.ConicForm`.
        modulus: Modulus of hardening with the strain rate, >= 0, shape (m,), Pa s; None without
            hardening. With surfaces, it raises those that bound ``||s||`` and selects a velocity;
            flow at an apex then has no certificate.
        surfaces: Yield surfaces that depend on pressure; None without any.
        conditions: Orthonormal combinations of the volumetric rows times roots of their weights,
            shape (k, m), which are independent and equivalent to the rows; None for the rows
            themselves. Backends may use either; mean stresses belong to the rows.
    """

    name: str
    rows: Sparse
    dim: int
    weights: Floats
    bound: Floats
    volumetric: Sparse
    volumetric_factor: float
    modulus: Floats | None = None
    surfaces: Surfaces | None = None
    conditions: Sparse | None = None

    @property
    def volumes(self) -> int:
        """Volumetric rows L of each cone."""
        return 1 if self.surfaces is None else self.surfaces.volumes

    @property
    def volume_weights(self) -> Floats:
        """`weights` of the volumetric rows, shape (m L,)."""
        return np.repeat(self.weights, self.volumes)

    @cached_property
    def conditioned(self) -> Sparse | None:
        """Conditions on the velocities, shape (k, n); None without `conditions`.

        The value is cached, because one program has several forms.
        """
        if self.conditions is None:
            return None
        roots = diags_array(np.sqrt(self.volume_weights))
        rows = csr_matrix(self.conditions @ csr_matrix(roots @ self.volumetric))
        # A combination within one element of four has no entries of the other three.
        size = np.abs(rows.data)
        largest = np.maximum.reduceat(np.append(size, 0.0), rows.indptr[:-1])
        rows.data[size <= _CANCELLED * np.repeat(largest, np.diff(rows.indptr))] = 0.0
        rows.eliminate_zeros()
        return rows

    @property
    def rise(self) -> Floats:
        """`modulus`, zero where nothing hardens, shape (m,), Pa s."""
        return np.zeros(self.weights.size) if self.modulus is None else self.modulus

    def cone_vectors(self, velocity: Floats) -> Floats:
        """Return ``(rows U)`` by cone, shape (m, dim)."""
        return np.asarray(self.rows @ velocity).reshape(-1, self.dim)

    def rates(self, velocity: Floats) -> Floats:
        """Return ``||(rows U)||`` of each cone, shape (m,), with round-off replaced by zero.

        With a strength of 1e8 times the weight, the round-off of a rigid motion would dissipate.
        """
        lengths = np.linalg.norm(self.cone_vectors(velocity), axis=1)
        return _without_round_off(lengths, self.rows, self.dim, velocity)

    def volume_rates(self, velocity: Floats) -> Floats:
        """Return ``volumetric U``, shape (m L,), with round-off replaced by zero."""
        rates = np.asarray(self.volumetric @ velocity)
        sizes = _without_round_off(np.abs(rates), self.volumetric, 1, velocity)
        return np.asarray(np.sign(rates) * sizes)

    def dissipation(self, velocity: Floats) -> Floats:
        """Return the dissipation of each cone, shape (m,)."""
        volume = None if self.surfaces is None else self.volume_rates(velocity)
        return self.dissipated(self.rates(velocity), volume)

    def dissipated(self, rates: Floats, volume: Floats | None) -> Floats:
        """Return the dissipation of each cone at `rates`, and at `volume_rates` with surfaces."""
        if self.surfaces is None or volume is None:
            return np.asarray(self.weights * self.bound * rates)
        return np.asarray(self.weights * self.surfaces.dissipation(rates, volume))

    def strength_at(self, mean: Floats) -> Floats:
        """Return the largest ``||stress||`` at mean stresses (m L,): shape (m,), Pa, >= 0."""
        return self.bound if self.surfaces is None else self.surfaces.strength_at(mean)

    def impossible(self, velocity: Floats) -> Floats:
        """Return how far the flow of each cone is from possible flow, shape (m,), 1/s.

        It is ``|theta|`` without surfaces, see `lacore.program.surfaces.Surfaces.impossible`.
        """
        volume = np.asarray(self.volumetric @ velocity)
        if self.surfaces is None:
            return np.asarray(np.abs(volume))
        lengths = np.linalg.norm(self.cone_vectors(velocity), axis=1)
        return np.asarray(np.maximum(self.surfaces.impossible(lengths, volume), 0.0))

    def taken(self, velocity: Floats, mean: Floats) -> float:
        """Return an upper bound of the power of stresses on impossible flow.

        The rate of each cone is weighted, because near an axis of symmetry and in small elements
        the rate alone is not significant. The stress is the mean stress plus the strength at it. At
        least the average over all points is used, so that impossible flow counts at points without
        stress and strength as well.
        """
        if not self.weights.size:
            return 0.0
        if self.surfaces is None:
            return float(self.volume_weights @ (np.abs(mean) * self.impossible(velocity)))
        stress = np.abs(mean).reshape(-1, self.volumes).max(axis=1) + self.strength_at(mean)
        stress = np.maximum(stress, np.average(stress, weights=self.weights))
        return float(self.weights @ (stress * self.impossible(velocity)))

    def beyond(self, stress: Floats, mean: Floats) -> Floats:
        """Return the share by which stresses exceed the strength of each cone, shape (m,).

        Args:
            stress: Conjugate of the cone rows, shape (m, dim), Pa; NaN gives NaN.
            mean: Conjugate of the volumetric rows, shape (m L,), Pa.
        """
        size = np.linalg.norm(stress, axis=1)
        if self.surfaces is None:
            return _beyond(size, self.bound)
        return self.surfaces.beyond(size, mean)

    def uses(self, stress: Floats, mean: Floats) -> Floats:
        """Return the share of the strength at its pressure that each cone uses, shape (m,)."""
        size, most = np.linalg.norm(stress, axis=1), self.strength_at(mean)
        return np.asarray(size / np.where(most > 0, most, np.inf))

    def use(self, stress: Floats, mean: Floats) -> float:
        """Return the largest share of the strength that stresses use, see `beyond`; >= 0."""
        size = np.linalg.norm(stress, axis=1)
        if self.surfaces is None:
            return float((size / self.bound).max(initial=0.0))
        called, strength = self.surfaces.use(size, mean), self.surfaces.strength
        share = called / np.where(strength > 0, strength, 1.0)
        none = np.where(called > 0, np.inf, 0.0)
        return float(np.where(strength > 0, share, none).max(initial=0.0))

    def times(self, factor: float | Floats) -> "DissipationGroup":
        """Return the group with its strength times one factor, or one per cone, shape (m,)."""
        surfaces = None if self.surfaces is None else self.surfaces.times(factor)
        return replace(self, bound=factor * self.bound, surfaces=surfaces)

    @property
    def frictional(self) -> bool:
        """Whether flow is non-associated, with friction in addition to dilation (T50)."""
        return self.surfaces is not None and self.surfaces.flow is not None

    @property
    def dilates_besides(self) -> bool:
        """Whether surfaces have a frozen dilation in addition to that of flow (T52, S-step)."""
        return self.surfaces is not None and self.surfaces.dilation is not None

    @property
    def sliding(self) -> bool:
        """Whether all cones are single planes of slip, which Davis's strength requires (T55)."""
        return self.surfaces is not None and self.surfaces.count == 1 and self.dim == 2

    @property
    def frictions(self) -> int:
        """Number of values that `friction` returns."""
        return 0 if self.surfaces is None or not self.frictional else self.surfaces.strength.size

    def friction(self, mean: Floats) -> Floats:
        """Return the friction of cones at mean stresses, shape (m k,), Pa, or an empty array."""
        if self.surfaces is None or not self.frictional:
            return np.zeros(0)
        return self.surfaces.friction(mean).ravel()

    def at_friction(self, friction: Floats) -> "DissipationGroup":
        """Return the group with frozen friction, shape (m k,), Pa (T52)."""
        if self.surfaces is None or not self.frictional:
            return self
        surfaces = self.surfaces.at_friction(friction.reshape(-1, self.surfaces.count))
        return replace(self, surfaces=surfaces)

    def at_flow(self, velocity: Floats, friction: Floats) -> "DissipationGroup":
        """Return the group with the flow of a velocity frozen, at a frozen friction (T52)."""
        frozen = self.at_friction(friction).surfaces
        if self.surfaces is None or frozen is None or not self.frictional:
            return self
        flows = frozen.multipliers(self.rates(velocity), self.volume_rates(velocity))
        return replace(self, surfaces=self.surfaces.at_flow(flows[:, : self.surfaces.count]))

    def associated(self) -> "DissipationGroup":
        """Return the group with flow normal to its surfaces."""
        if self.surfaces is None:
            return self
        return replace(self, surfaces=self.surfaces.associated())

    def davis(self) -> "DissipationGroup":
        """Return the group with Davis's strength (T55).

        Raises:
            InputError: The cones are not planes of slip.
        """
        if self.surfaces is None or not self.frictional:
            return self
        if not self.sliding:
            raise InputError(
                "coupling",
                "davis",
                f"his strength is that of planes of slip, and {self.name!r} has others, or none",
                "take it of MohrCoulomb in plane strain, without cut-offs",
            )
        return replace(self, surfaces=self.surfaces.davis())

    def hardened(self, velocity: Floats) -> "DissipationGroup":
        """Return the group with the stress bounds of a velocity, and without hardening.

        A velocity that is optimal with hardening is optimal with these bounds, with the same
        stresses, reactions and load factor, so a proof with these bounds is sufficient.
        """
        if self.modulus is None:
            return self
        rise = self.modulus * np.linalg.norm(self.cone_vectors(velocity), axis=1)
        surfaces = None if self.surfaces is None else self.surfaces.raised(rise)
        return replace(self, bound=self.bound + rise, surfaces=surfaces, modulus=None)


def _without_round_off(sizes: Floats, rows: Sparse, dim: int, velocity: Floats) -> Floats:
    """Return the sizes of vectors of `dim` rows at a velocity, with round-off replaced by zero."""
    largest = np.abs(rows.data).max(initial=0.0) * np.abs(velocity).max(initial=0.0)
    if not np.any(sizes <= _DOUBTFUL * largest):
        return np.asarray(sizes)
    sums = np.asarray(abs(rows) @ np.abs(velocity)).reshape(-1, dim)
    return np.where(sizes <= _ROUND_OFF * np.linalg.norm(sums, axis=1), 0.0, sizes)


def _beyond(size: Floats, bound: Floats) -> Floats:
    """Return the share by which stresses exceed their bound; inf for stress without strength."""
    strong = bound > 0
    share = size / np.where(strong, bound, 1.0) - 1
    return np.where(strong, share, np.where(size == 0, 0.0, np.where(size > 0, np.inf, np.nan)))
