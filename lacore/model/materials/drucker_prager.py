"""Criterion of Drucker and Prager (T41, T42)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import nan, sqrt

import numpy as np

from lacore.model.materials.angles import angles_told, flatter, require_angles
from lacore.model.materials.conic_form import KINEMATICS, SPACE, ConicForm, Surface
from lacore.model.materials.fields import Field, Given, Strength, Strengths, number_told, taken
from lacore.model.materials.planes import planes_form, require_not_negative
from lacore.model.materials.von_mises import VonMises
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError, require_known
from lacore.reporting.showing import Compact
from lacore.reporting.text import Symbol, join

MATCHES = ("plane_strain", "compression", "extension")
"""Where a Drucker-Prager cone matches a Mohr-Coulomb one."""
_LEAST_ROOT = 1e-3  # m of plane stress, below which a sheet is almost locked


@dataclass(frozen=True, repr=False)
class DruckerPrager(Compact):
    """A cone around the hydrostatic axis, ``sqrt(J2) <= k - a tr(sigma)/3`` (T41).

    With a dilation angle below the friction angle flow is non-associated (T49): its potential is
    the cone of that angle. In plane strain the stresses during flow are then smaller than the
    admissible ones, so that it does not match `MohrCoulomb` for any choice (T88).

    Attributes:
        cohesion: c, Pa, of the Mohr-Coulomb criterion to match; it may vary with place, as there.
        friction_angle: phi, degrees, of that criterion; both angles may vary with place, but not in
            plane stress, where the axes of cones depend on them.
        match: where both agree (T42): in ``plane_strain``, or for the strengths in triaxial
            ``compression`` or ``extension``.
        dilation_angle: psi, degrees, at most phi everywhere; None: phi, flow is associated.

    Raises:
        InputError: see `MohrCoulomb`; an unknown match; in plane stress too much friction for
            bounded stresses, or a dilation angle below the friction angle.

    Example:
        >>> sand = la.DruckerPrager(cohesion=5e3, friction_angle=30.0)  # Pa, degrees
    """

    cohesion: Given | Field
    friction_angle: Given | Field
    match: str = "plane_strain"
    dilation_angle: Given | Field | None = None

    def __post_init__(self) -> None:
        for name in ("cohesion", "friction_angle", "dilation_angle"):
            object.__setattr__(self, name, taken(f"DruckerPrager.{name}", getattr(self, name)))
        require_not_negative("DruckerPrager.cohesion", self._cohesion)
        require_angles("DruckerPrager", self._friction, self._dilation)
        require_known("DruckerPrager.match", self.match, MATCHES)
        numbers = not isinstance(self._friction, Field)
        if numbers and self._cohesion == self._friction == 0:
            raise InputError(
                "DruckerPrager.cohesion",
                self._cohesion,
                "without friction it is the only strength",
                "give a cohesion > 0 in Pa, or a friction_angle in degrees",
            )

    @property
    def slope(self) -> float:
        """Slope a of the cone; nan where it varies."""
        return nan if isinstance(self._friction, Field) else float(self._slope(self._friction))

    @property
    def flow(self) -> float | None:
        """Slope of the cone of the dilation angle; None for associated flow, NaN if it varies."""
        friction, dilation = self._friction, self._dilation
        if isinstance(friction, Field) or isinstance(dilation, Field):
            return None if dilation is None else nan
        if dilation is None or dilation >= friction:
            return None
        return float(self._slope(dilation))

    def _per_sine(self, angle: float | Floats) -> tuple[float | Floats, float | Floats]:
        """Return the slope of a cone for an angle, degrees, divided by its sine, and that sine."""
        sine = np.sin(np.radians(angle))
        if self.match == "plane_strain":
            return sqrt(3) / np.sqrt(3 + sine**2), sine
        sign = -1 if self.match == "compression" else 1
        return 6 / (sqrt(3) * (3 + sign * sine)), sine

    def _slope(self, angle: float | Floats) -> float | Floats:
        per, sine = self._per_sine(angle)
        return per * sine

    @property
    def _cohesion(self) -> Strength:
        return self.cohesion  # type: ignore[return-value]  # as `taken` leaves it

    @property
    def _friction(self) -> Strength:
        return self.friction_angle  # type: ignore[return-value]  # as `taken` leaves it

    @property
    def _dilation(self) -> Strength | None:
        return self.dilation_angle  # type: ignore[return-value]  # as `taken` leaves it

    @property
    def k(self) -> Strength:
        """Shear strength k at zero pressure, Pa; NaN if the angle varies."""
        if isinstance(self._friction, Field):
            return nan
        return self._k(self._friction, self._cohesion)  # type: ignore[return-value]  # no array

    def _k(self, angle: float | Floats, cohesion: Strengths) -> Strengths:
        per, _ = self._per_sine(angle)
        return cohesion * (per * np.cos(np.radians(angle)))

    @property
    def strength(self) -> float:
        """See `k`; NaN if it varies."""
        return nan if isinstance(self.k, Field) else float(self.k)

    @property
    def label(self) -> str:
        """``c = 5000 Pa, phi = 30°, matched in compression``."""
        told = [
            number_told(Symbol("c"), self._cohesion),
            *angles_told(self._friction, self._dilation),
        ]
        return join(", ", [*told, f"matched in {self.match.replace('_', ' ')}"])

    @property
    def law(self) -> None:
        """It does not harden."""
        return None

    def weakened(self, factor: float) -> DruckerPrager:
        """Return the criterion with cohesion and ``tan(phi)`` divided by a factor."""
        angle, dilation = flatter("DruckerPrager", self._friction, self._dilation, factor)
        return DruckerPrager(self._cohesion / factor, angle, self.match, dilation)

    def conic_form(self, kinematics: str) -> ConicForm:
        """Return the rows of von Mises, with the one plane of the cone (T41).

        Plane strain: ``theta^2/3`` of the norm moves to the other side. Plane stress: eps_zz is
        free, and ``m lam = ||(d, sqrt(3) theta/m)|| - 2 a theta/m`` with ``m^2 = 1 - 4 a^2/3``; the
        linear part is that of two planes. For non-associated flow in plane strain the whole norm is
        kept, as `sigma_zz` follows from the flow, and is smaller where nothing flows.
        """
        if isinstance(self._friction, Field) or isinstance(self._dilation, Field):
            raise ValueError("an angle that varies is one of elements: see `form_of`")
        return self._form(kinematics, self.slope, self.k, self.flow)

    def form_of(
        self, kinematics: str, angles: Floats, cohesion: Strengths, dilation: Floats | None
    ) -> ConicForm:
        """Return the form with angles, degrees, and cohesions of each element, (elements,).

        Raises:
            InputError: in plane stress, where the axes of cones depend on their angle.
        """
        if kinematics == "plane_stress":
            raise InputError(
                "DruckerPrager.friction_angle",
                None,
                "varies, and in plane stress the axes of cones turn with their angle",
                "take MohrCoulomb, or make regions of one friction angle each",
            )
        flow = None if dilation is None else self._slope(dilation)
        return self._form(kinematics, self._slope(angles), self._k(angles, cohesion), flow)

    def _form(
        self,
        kinematics: str,
        a: float | Floats,
        k: Strengths,
        flow: float | Floats | None,
    ) -> ConicForm:
        """Return the form for slope a, strength k, Pa, and slope of the flow.

        Each is a number, or one for each element.
        """
        require_known("Body.kinematics", kinematics, KINEMATICS)
        own = (Surface((a,), k, flow=None if flow is None else (flow,)),)
        if flow is not None and kinematics == "plane_stress":
            raise InputError(
                "DruckerPrager.dilation_angle",
                self.dilation_angle,
                "in plane stress its strength and its flow are cones around axes of their own, of"
                " which no pressure makes one from the other (T88)",
                "take MohrCoulomb, or leave the dilation angle out",
            )
        if flow is not None and kinematics == "plane_strain":
            third = 1 / sqrt(3)
            return ConicForm(
                rows=np.array([[1.0, -1.0, 0.0], [0.0, 0.0, 1.0], [third, third, 0.0]]),
                volumetric=np.array([[1.0, 1.0, 0.0]]),
                bound=k,
                surfaces=own,
                out_of_rows=(0.0, 0.0, -2 * third),
            )
        if kinematics == "plane_strain":
            root = np.sqrt(1 - a**2 / 3)
            return planes_form(kinematics, k / root, a / root, None, None)
        flat = VonMises(shear_strength=1.0).conic_form(kinematics)
        if kinematics in ("axisymmetric", SPACE):
            if not np.any(a):
                return replace(flat, bound=k)
            return replace(flat, bound=k, surfaces=own)
        assert isinstance(a, float)
        m = sqrt(max(1 - 4 * a**2 / 3, 0.0))
        if m < _LEAST_ROOT:
            raise InputError(
                "DruckerPrager.friction_angle",
                self.friction_angle,
                "so much friction that a sheet compressed in both directions has no bound",
                "give a smaller angle, or MohrCoulomb",
            )
        linear = 2 * a * k / (sqrt(3) * m)
        return ConicForm(
            rows=np.array([[1.0, -1.0, 0.0], [0.0, 0.0, 1.0], [sqrt(3) / m, sqrt(3) / m, 0.0]]),
            volumetric=np.array([[1.0, 1.0, 0.0]]),
            bound=k,
            surfaces=tuple(
                Surface((sign * m / sqrt(3),), k / m - sign * linear)  # type: ignore[operator]
                for sign in (1.0, -1.0)
            ),
            out_of_plane=0.0,
        )
