"""Criteria made of planes in stress space: Mohr-Coulomb, Tresca, Rankine, no tension (T38-T40).

All are planes ``q <= b - a P`` in the mean stress P and the deviator q of the plane, and the third
principal stress if it is not free.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, inf, nan, radians, sin, tan
from typing import Any

import numpy as np

from lacore.model.materials.angles import angles_told, flatter, require_angles
from lacore.model.materials.conic_form import ConicForm
from lacore.model.materials.fields import Field, Given, Strength, Strengths, number_told, taken
from lacore.model.materials.planes import (
    limits_told,
    planes_form,
    require_cutoffs,
    require_not_negative,
)
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError, require_positive
from lacore.reporting.showing import Compact, rounded_down
from lacore.reporting.text import Quantity, Symbol, join, text


@dataclass(frozen=True, repr=False)
class MohrCoulomb(Compact):
    """Soil, rock, concrete: ``tau <= c - sigma tan(phi)`` on every plane (T38).

    With a dilation angle below the friction angle flow is non-associated (T49): bound theorems do
    not hold, and load factors may not be unique. Flow at cut-offs remains associated (T88).
    Cohesion, angles and cut-offs may vary with place: a `lacore.Field`, a function of coordinates
    of shape (2, n), or a value for each element. Within an element in which the friction angle
    varies, bounds use a cone within, or around, all of those there (T87).

    Attributes:
        cohesion: c, Pa, >= 0.
        friction_angle: phi, degrees: 0, or from 0.1 to 89 everywhere.
        tension_cutoff: largest principal stress T, Pa, at most ``c cot(phi)``; None: no cut-off. If
            one of them varies, the cut-off has no effect where it is larger: the body states where,
            and rejects one that has no effect anywhere.
        crushing: largest compression of a principal stress, Pa; None: unlimited.
        dilation_angle: psi, degrees, at most phi everywhere; None: phi, flow is associated.

    Raises:
        InputError: an angle outside of [0, 89] degrees, or one that looks like radians; neither
            cohesion nor friction; a cut-off beyond the apex; a dilation angle above the friction
            angle.

    Example:
        >>> sand = la.MohrCoulomb(cohesion=5e3, friction_angle=30.0)  # Pa, degrees
        >>> cracked = la.MohrCoulomb(cohesion=5e3, friction_angle=30.0, tension_cutoff=0.0)
    """

    cohesion: Given | Field
    friction_angle: Given | Field
    tension_cutoff: Given | Field | None = None
    crushing: Given | Field | None = None
    dilation_angle: Given | Field | None = None

    def __post_init__(self) -> None:
        _take(self, "cohesion", "friction_angle", "tension_cutoff", "crushing", "dilation_angle")
        require_not_negative("MohrCoulomb.cohesion", self._cohesion)
        require_angles("MohrCoulomb", self._friction, self._dilation)
        if not isinstance(self._friction, Field) and self._cohesion == self._friction == 0:
            raise InputError(
                "MohrCoulomb.cohesion",
                self._cohesion,
                "without friction it is the only strength",
                "give a cohesion > 0 in Pa, or a friction_angle in degrees",
            )
        most, crushing = self._cutoffs
        require_cutoffs(("MohrCoulomb.tension_cutoff", most), ("MohrCoulomb.crushing", crushing))
        numbers = not any(isinstance(one, Field) for one in (most, self.cohesion, self._friction))
        if numbers and most is not None and most > self.apex:  # type: ignore[operator]
            raise InputError(
                "MohrCoulomb.tension_cutoff",
                most,
                text(
                    "beyond the apex c cot(phi) = {}, which no stress exceeds",
                    Quantity(self.apex, "Pa", ".6g"),
                ),
                text("give at most {}, or none", Quantity(rounded_down(self.apex), "Pa")),
            )

    @property
    def _cohesion(self) -> Strength:
        return self.cohesion  # type: ignore[return-value]  # as `_take` leaves it

    @property
    def _cutoffs(self) -> tuple[Strength | None, Strength | None]:
        return self.tension_cutoff, self.crushing  # type: ignore[return-value]

    @property
    def _friction(self) -> Strength:
        return self.friction_angle  # type: ignore[return-value]  # as `_take` leaves it

    @property
    def _dilation(self) -> Strength | None:
        return self.dilation_angle  # type: ignore[return-value]  # as `_take` leaves it

    @property
    def angle(self) -> float:
        """Friction angle in radians; nan where it varies."""
        return nan if isinstance(self._friction, Field) else radians(self._friction)

    @property
    def apex(self) -> float:
        """Largest mean stress ``c cot(phi)``, Pa; inf without friction, nan where it varies."""
        if isinstance(self._cohesion, Field):
            return nan
        return self._cohesion / tan(self.angle) if self.angle else inf

    @property
    def strength(self) -> float:
        """Shear strength at zero pressure, Pa; NaN if it varies.

        It is ``c cos(phi)``, or a smaller cut-off.
        """
        if isinstance(self._friction, Field):
            return nan
        return _known(self._cohesion * cos(self.angle), *self._cutoffs)

    @property
    def label(self) -> str:
        """``c = 5000 Pa, phi = 30°``."""
        told = [
            number_told(Symbol("c"), self._cohesion),
            *angles_told(self._friction, self._dilation),
        ]
        return join(", ", [*told, *limits_told(*self._cutoffs)])

    @property
    def law(self) -> None:
        """It does not harden."""
        return None

    def beyond_apex(self, at: Callable[[Strength], Floats]) -> Floats | None:
        """Return how far its cut-off is beyond the apex, times ``tan(phi)``, Pa; None without one.

        Args:
            at: function for the values of one of its strengths at places, of compatible shapes.
        """
        most, _ = self._cutoffs
        if most is None:
            return None
        tangent = np.tan(np.radians(at(self._friction)))
        return np.asarray(at(most) * tangent - at(self._cohesion))

    def weakened(self, factor: float) -> MohrCoulomb:
        """Return the criterion with cohesion, ``tan(phi)`` and cut-offs divided by a factor.

        The apex is kept. A dilation angle is kept, too, but limited to the friction angle.

        Raises:
            InputError: the resulting angle is below 0.1 degrees.
        """
        tension, crushing = self._cutoffs
        angle, dilation = flatter("MohrCoulomb", self._friction, self._dilation, factor)
        return MohrCoulomb(
            self._cohesion / factor,
            angle,
            None if tension is None else tension / factor,
            None if crushing is None else crushing / factor,
            dilation,
        )

    def conic_form(self, kinematics: str) -> ConicForm:
        """Return the planes of T39 in plane strain and plane stress, of T40 in axisymmetry."""
        psi = self._dilation
        if isinstance(self._friction, Field) or isinstance(psi, Field):
            raise ValueError("an angle that varies is one of elements: see `form_of`")
        return planes_form(
            kinematics,
            self._cohesion * cos(self.angle),
            sin(self.angle),
            *self._cutoffs,
            None if psi is None or psi >= self._friction else sin(radians(psi)),
        )

    def form_of(
        self, kinematics: str, angles: Floats, cohesion: Strengths, dilation: Floats | None
    ) -> ConicForm:
        """Return the form with angles, degrees, and cohesions of each element, (elements,)."""
        phi = np.radians(angles)
        psi = None if dilation is None else np.sin(np.radians(dilation))
        return planes_form(kinematics, cohesion * np.cos(phi), np.sin(phi), *self._cutoffs, psi)


def _take(criterion: Any, *names: str) -> None:
    """Store strengths as numbers or fields."""
    for name in names:
        field = f"{type(criterion).__name__}.{name}"
        object.__setattr__(criterion, name, taken(field, getattr(criterion, name)))


def _known(*limits: Strength | None) -> float:
    """Return the smallest limit, Pa; NaN if one varies."""
    numbers = [limit for limit in limits if limit is not None and not isinstance(limit, Field)]
    varies = any(isinstance(limit, Field) for limit in limits)
    return nan if varies else float(min(numbers))


@dataclass(frozen=True, repr=False)
class Rankine(Compact):
    """Principal stresses between two limits: masonry, plain concrete (T39).

    Attributes:
        tensile_strength: largest principal stress, Pa, >= 0; both may vary with place as those of
            `MohrCoulomb`.
        compressive_strength: largest compression of a principal stress, Pa; None: unlimited.

    Raises:
        InputError: a strength that is invalid, negative, or too large for computation.

    Example:
        >>> concrete = la.Rankine(tensile_strength=2e6, compressive_strength=30e6)  # Pa
    """

    tensile_strength: Given | Field
    compressive_strength: Given | Field | None = None

    def __post_init__(self) -> None:
        _take(self, "tensile_strength", "compressive_strength")
        tensile, compressive = self._limits
        require_cutoffs(
            ("Rankine.tensile_strength", tensile),
            ("Rankine.compressive_strength", compressive),
        )

    @property
    def _limits(self) -> tuple[Strength, Strength | None]:
        return self.tensile_strength, self.compressive_strength  # type: ignore[return-value]

    @property
    def strength(self) -> float:
        """Shear strength at zero pressure, Pa; NaN if it varies."""
        return _known(*self._limits)

    @property
    def label(self) -> str:
        """``tension ≤ 1 Pa, compression ≤ 20 Pa``."""
        return join(", ", limits_told(*self._limits))

    @property
    def law(self) -> None:
        """It does not harden."""
        return None

    def weakened(self, factor: float) -> Rankine:
        """Return the criterion with both strengths divided by a factor."""
        tensile, crushing = self._limits
        return Rankine(tensile / factor, None if crushing is None else crushing / factor)

    def conic_form(self, kinematics: str) -> ConicForm:
        """Return the planes of T39."""
        return planes_form(kinematics, None, 0.0, *self._limits)


@dataclass(frozen=True, repr=False)
class NoTension(Compact):
    """Masonry as a continuum: no principal stress is tensile; `Rankine` with a strength of 0.

    Attributes:
        compressive_strength: largest compression of a principal stress, Pa; None: unlimited, so
            that compression from all sides locks.

    Raises:
        InputError: a strength that is not positive.

    Example:
        >>> rubble = la.NoTension(compressive_strength=5e6)  # Pa
    """

    compressive_strength: Given | Field | None = None

    def __post_init__(self) -> None:
        _take(self, "compressive_strength")
        require_cutoffs(("", None), ("NoTension.compressive_strength", self._crushing))

    @property
    def _crushing(self) -> Strength | None:
        return self.compressive_strength  # type: ignore[return-value]  # as `_take` leaves it

    @property
    def strength(self) -> float:
        """Shear strength at zero pressure: zero."""
        return 0.0

    @property
    def label(self) -> str:
        """``no tension``."""
        return join(", ", ["no tension", *limits_told(None, self._crushing)])

    @property
    def law(self) -> None:
        """It does not harden."""
        return None

    def weakened(self, factor: float) -> NoTension:
        """Return the criterion with its strength in compression divided by a factor."""
        crushing = self._crushing
        return NoTension(None if crushing is None else crushing / factor)

    def conic_form(self, kinematics: str) -> ConicForm:
        """Return the planes of T39."""
        return planes_form(kinematics, None, 0.0, 0.0, self._crushing)


@dataclass(frozen=True, repr=False)
class MaximumShear(Compact):
    """Tresca's criterion: a limit of the shear stress on any plane (T40).

    In plane strain it equals von Mises with the same shear strength, but not in plane stress and
    axisymmetry. `lacore.Tresca` is the friction law of that name.

    Attributes:
        shear_strength: Pa; it may vary with place as that of `VonMises`.

    Raises:
        InputError: a strength that is not positive.

    Example:
        >>> clay = la.MaximumShear(shear_strength=20e3)  # Pa
    """

    shear_strength: Given | Field

    def __post_init__(self) -> None:
        _take(self, "shear_strength")
        if not isinstance(self._shear, Field):
            require_positive("MaximumShear.shear_strength", self._shear)

    @property
    def _shear(self) -> Strength:
        return self.shear_strength  # type: ignore[return-value]  # as `_take` leaves it

    @property
    def strength(self) -> float:
        """See `shear_strength`; NaN if it varies."""
        return nan if isinstance(self._shear, Field) else self._shear

    @property
    def label(self) -> str:
        """Text on its shear strength."""
        if isinstance(self._shear, Field):
            return number_told("largest shear", self._shear)
        return text("largest shear {}", Quantity(self._shear, "Pa", ".4g"))

    @property
    def law(self) -> None:
        """It does not harden."""
        return None

    def weakened(self, factor: float) -> MaximumShear:
        """Return the criterion with its strength divided by a factor."""
        return MaximumShear(self._shear / factor)

    def conic_form(self, kinematics: str) -> ConicForm:
        """Return the cone of von Mises in plane strain, else planes of T39 and T40."""
        return planes_form(kinematics, self._shear, 0.0, None, None)
