"""What straining the bodies of a program costs: cones, and surfaces that depend on pressure."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import csr_matrix, diags_array

from lacore.numerics.arrays import Floats, Sparse
from lacore.program.surfaces import Surfaces
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact

_ROUND_OFF = 16 * float(np.finfo(float).eps)  # of the sums: about as many terms in a row
_DOUBTFUL = 1e-12  # of the largest term in a sum: what is above is no round-off of it
_CANCELLED = 1e-13  # of the largest entry of a row: a sum of a dozen terms that is zero


@dataclass(frozen=True, repr=False)
class DissipationGroup(Compact):
    """Cones of one kind: ``sum_g weights_g bound_g ||(rows U)_g||`` with ``volumetric U = 0``.

    Hardening adds ``weights_g modulus_g ||(rows U)_g||^2/2`` (T29): the stress at yield is then
    ``bound + modulus ||rows U||``. Where strength depends on pressure, `surfaces` say what flow
    costs, and which is possible, in place of `bound` and of ``volumetric U = 0``.

    Attributes:
        name: for messages and results.
        rows: stacked cone rows, shape (m dim, n); cone g owns rows g dim ... (g+1) dim - 1.
        dim: rows in a cone.
        weights: integration weights, shape (m,), m^3; m^2 of plane bodies of unit thickness.
        bound: largest norm of the conjugate stress, with `surfaces` that without pressure, shape
            (m,), Pa.
        volumetric: rows of theta, shape (m L, n); L is 1 but for surfaces that feel more.
        volumetric_factor: see `lacore.model.materials.conic_form.ConicForm`.
        modulus: of hardening with the strain rate, >= 0, shape (m,), Pa s; None: there is none.
            Beside surfaces it raises all that bound ``||s||``, and chooses between velocities:
            flow of an apex has no certificate with it.
        surfaces: yield surfaces that depend on pressure; None: none does.
        conditions: combinations of volumetric rows times roots of their weights, orthonormal, shape
            (k, m): as many as do not depend on each other, and all of what the rows say; None: the
            rows themselves. Whoever solves may take either; mean stresses are those of the rows.
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
        """What `conditions` say of velocities, shape (k, n); None without them.

        Kept: of one program several forms are made.
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
        """``(rows U)`` by cone, shape (m, dim)."""
        return np.asarray(self.rows @ velocity).reshape(-1, self.dim)

    def rates(self, velocity: Floats) -> Floats:
        """``||(rows U)||`` of each cone, shape (m,); none where it is round-off of its own sums.

        The exact motion next to it does not strain: beside a strength of 1e8 weights what is left
        of a rigid motion would dissipate.
        """
        lengths = np.linalg.norm(self.cone_vectors(velocity), axis=1)
        return _without_round_off(lengths, self.rows, self.dim, velocity)

    def volume_rates(self, velocity: Floats) -> Floats:
        """``volumetric U``, shape (m L,); none where it is round-off of its own sums."""
        rates = np.asarray(self.volumetric @ velocity)
        sizes = _without_round_off(np.abs(rates), self.volumetric, 1, velocity)
        return np.asarray(np.sign(rates) * sizes)

    def dissipation(self, velocity: Floats) -> Floats:
        """Dissipation of each cone, shape (m,)."""
        volume = None if self.surfaces is None else self.volume_rates(velocity)
        return self.dissipated(self.rates(velocity), volume)

    def dissipated(self, rates: Floats, volume: Floats | None) -> Floats:
        """Dissipation of each cone at `rates`, and `volume_rates` where surfaces ask for them."""
        if self.surfaces is None or volume is None:
            return np.asarray(self.weights * self.bound * rates)
        return np.asarray(self.weights * self.surfaces.dissipation(rates, volume))

    def strength_at(self, mean: Floats) -> Floats:
        """Largest ``||stress||`` beside mean stresses of shape (m L,), shape (m,), Pa; >= 0."""
        return self.bound if self.surfaces is None else self.surfaces.strength_at(mean)

    def impossible(self, velocity: Floats) -> Floats:
        """How far each cone is from flow that is possible, ``|theta|`` where none changes volume.

        Shape (m,), 1/s; see `lacore.program.surfaces.Surfaces.impossible`.
        """
        volume = np.asarray(self.volumetric @ velocity)
        if self.surfaces is None:
            return np.asarray(np.abs(volume))
        lengths = np.linalg.norm(self.cone_vectors(velocity), axis=1)
        return np.asarray(np.maximum(self.surfaces.impossible(lengths, volume), 0.0))

    def taken(self, velocity: Floats, mean: Floats) -> float:
        """Power of stresses on flow that is not possible, from above.

        What a cone leaves of its conditions is a rate times a weight: near an axis of revolution,
        or in the least element, the rate alone says little. The stress is the mean one and what
        can be carried beside it, no less than on the average of all points: where both vanish, too,
        flow has to keep to its rule.
        """
        if not self.weights.size:
            return 0.0
        if self.surfaces is None:
            return float(self.volume_weights @ (np.abs(mean) * self.impossible(velocity)))
        stress = np.abs(mean).reshape(-1, self.volumes).max(axis=1) + self.strength_at(mean)
        stress = np.maximum(stress, np.average(stress, weights=self.weights))
        return float(self.weights @ (stress * self.impossible(velocity)))

    def beyond(self, stress: Floats, mean: Floats) -> Floats:
        """Share by which stresses exceed the strength of each cone, shape (m,); NaN of NaN.

        Args:
            stress: conjugate of the cone rows, shape (m, dim), Pa.
            mean: conjugate of the volumetric rows, shape (m L,), Pa.
        """
        size = np.linalg.norm(stress, axis=1)
        if self.surfaces is None:
            return _beyond(size, self.bound)
        return self.surfaces.beyond(size, mean)

    def uses(self, stress: Floats, mean: Floats) -> Floats:
        """Share of what each cone carries at its pressure that stresses use, shape (m,)."""
        size, most = np.linalg.norm(stress, axis=1), self.strength_at(mean)
        return np.asarray(size / np.where(most > 0, most, np.inf))

    def use(self, stress: Floats, mean: Floats) -> float:
        """Largest share of their strength that stresses call on, see `beyond`; >= 0."""
        size = np.linalg.norm(stress, axis=1)
        if self.surfaces is None:
            return float((size / self.bound).max(initial=0.0))
        called, strength = self.surfaces.use(size, mean), self.surfaces.strength
        share = called / np.where(strength > 0, strength, 1.0)
        none = np.where(called > 0, np.inf, 0.0)
        return float(np.where(strength > 0, share, none).max(initial=0.0))

    def times(self, factor: float | Floats) -> "DissipationGroup":
        """The group with its strength times a factor, of all cones or of each, shape (m,)."""
        surfaces = None if self.surfaces is None else self.surfaces.times(factor)
        return replace(self, bound=factor * self.bound, surfaces=surfaces)

    @property
    def frictional(self) -> bool:
        """Whether flow is not associated: friction dissipates beside what dilates (T50)."""
        return self.surfaces is not None and self.surfaces.flow is not None

    @property
    def dilates_besides(self) -> bool:
        """Whether flow has rates besides its own (T52, S-step)."""
        return self.surfaces is not None and self.surfaces.dilation is not None

    @property
    def sliding(self) -> bool:
        """Whether cones are planes of slip and nothing else, as Davis's strength is of (T55)."""
        return self.surfaces is not None and self.surfaces.count == 1 and self.dim == 2

    @property
    def frictions(self) -> int:
        """Numbers that `friction` lists."""
        return 0 if self.surfaces is None or not self.frictional else self.surfaces.strength.size

    def friction(self, mean: Floats) -> Floats:
        """Friction of all cones at mean stresses, shape (m k,), Pa; empty of associated flow."""
        if self.surfaces is None or not self.frictional:
            return np.zeros(0)
        return self.surfaces.friction(mean).ravel()

    def at_friction(self, friction: Floats) -> "DissipationGroup":
        """The group with its friction frozen, shape (m k,), Pa (T52)."""
        if self.surfaces is None or not self.frictional:
            return self
        surfaces = self.surfaces.at_friction(friction.reshape(-1, self.surfaces.count))
        return replace(self, surfaces=surfaces)

    def at_flow(self, velocity: Floats, friction: Floats) -> "DissipationGroup":
        """The group with the flow of a velocity frozen (T52), on its surfaces as friction says."""
        frozen = self.at_friction(friction).surfaces
        if self.surfaces is None or frozen is None or not self.frictional:
            return self
        flows = frozen.multipliers(self.rates(velocity), self.volume_rates(velocity))
        return replace(self, surfaces=self.surfaces.at_flow(flows[:, : self.surfaces.count]))

    def associated(self) -> "DissipationGroup":
        """The group with flow normal to its surfaces."""
        if self.surfaces is None:
            return self
        return replace(self, surfaces=self.surfaces.associated())

    def davis(self) -> "DissipationGroup":
        """The group with Davis's strength (T55), of cones that are planes of slip.

        Raises:
            InputError: other cones.
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
        """The group with the stress bounds of a velocity, and no hardening beyond them.

        A velocity that is optimal with hardening is optimal with these bounds, with the same
        stresses, reactions and load factor: all that is proven of it is proven with them.
        """
        if self.modulus is None:
            return self
        rise = self.modulus * np.linalg.norm(self.cone_vectors(velocity), axis=1)
        surfaces = None if self.surfaces is None else self.surfaces.raised(rise)
        return replace(self, bound=self.bound + rise, surfaces=surfaces, modulus=None)


def _without_round_off(sizes: Floats, rows: Sparse, dim: int, velocity: Floats) -> Floats:
    """Sizes of the vectors of `dim` rows at a velocity, 0 where they are round-off of the sums."""
    largest = np.abs(rows.data).max(initial=0.0) * np.abs(velocity).max(initial=0.0)
    if not np.any(sizes <= _DOUBTFUL * largest):
        return np.asarray(sizes)
    sums = np.asarray(abs(rows) @ np.abs(velocity)).reshape(-1, dim)
    return np.where(sizes <= _ROUND_OFF * np.linalg.norm(sums, axis=1), 0.0, sizes)


def _beyond(size: Floats, bound: Floats) -> Floats:
    """Share by which stresses exceed their bound; what has no strength carries none."""
    strong = bound > 0
    share = size / np.where(strong, bound, 1.0) - 1
    return np.where(strong, share, np.where(size == 0, 0.0, np.where(size > 0, np.inf, np.nan)))
