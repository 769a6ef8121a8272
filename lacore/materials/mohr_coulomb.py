"""Criteria whose strength depends on pressure: Mohr-Coulomb, Tresca, Rankine, no tension (T38-T40).

All are planes ``q <= b - a P`` in the mean stress P and the deviator q of the plane, with the
third principal stress where it is not free.
"""

from dataclasses import dataclass
from math import cos, degrees, inf, pi, radians, sin, tan

import numpy as np

from lacore.errors import InputError, is_number, require_known, require_positive, require_range
from lacore.materials.conic_form import KINEMATICS, ConicForm, Surface
from lacore.materials.von_mises import VonMises
from lacore.showing import Compact

_LEAST_ANGLE, _LARGEST_ANGLE = 0.1, 89.0  # degrees: beside them a plane is level, or upright
_LEAST_WHOLE, _WHOLE = 6, 2e-3  # degrees: what is within this of a whole angle, in radians


@dataclass(frozen=True, repr=False)
class MohrCoulomb(Compact):
    """Soil, rock, concrete: ``tau <= c - sigma tan(phi)`` on every plane, associated flow (T38).

    Attributes:
        cohesion: c, Pa, >= 0.
        friction_angle: phi, degrees: 0, or from 0.1 to 89.
        tension_cutoff: largest principal stress T, Pa, at most ``c cot(phi)``; None: none.
        crushing: largest compression of a principal stress, Pa; None: none.

    Raises:
        InputError: an angle outside of [0, 89] degrees, or one that looks like radians; neither
            cohesion nor friction; a cut-off beyond the apex.
    """

    cohesion: float
    friction_angle: float
    tension_cutoff: float | None = None
    crushing: float | None = None

    def __post_init__(self) -> None:
        _require_not_negative("MohrCoulomb.cohesion", self.cohesion)
        _require_angle("MohrCoulomb.friction_angle", self.friction_angle)
        if self.cohesion == 0 and self.friction_angle == 0:
            raise InputError(
                "MohrCoulomb.cohesion",
                self.cohesion,
                "without friction it is the only strength",
                "give a cohesion > 0 in Pa, or a friction_angle in degrees",
            )
        _require_cutoffs(
            ("MohrCoulomb.tension_cutoff", self.tension_cutoff),
            ("MohrCoulomb.crushing", self.crushing),
        )
        if self.tension_cutoff is not None and self.tension_cutoff > self.apex:
            raise InputError(
                "MohrCoulomb.tension_cutoff",
                self.tension_cutoff,
                f"beyond the apex c cot(phi) = {self.apex:.6g} Pa, which no stress exceeds",
                f"give at most {self.apex:.6g}, or none",
            )

    @property
    def angle(self) -> float:
        """Friction angle in radians."""
        return radians(self.friction_angle)

    @property
    def apex(self) -> float:
        """Largest mean stress ``c cot(phi)``, Pa; inf without friction."""
        return self.cohesion / tan(self.angle) if self.friction_angle else inf

    @property
    def strength(self) -> float:
        """Shear stress that it carries without pressure, ``c cos(phi)``, Pa."""
        return self.cohesion * cos(self.angle)

    @property
    def label(self) -> str:
        """``c = 5000 Pa, phi = 30°``."""
        told = [f"c = {self.cohesion:.4g} Pa", f"φ = {self.friction_angle:.4g}°"]
        return ", ".join([*told, *_told(self.tension_cutoff, self.crushing)])

    @property
    def law(self) -> None:
        """It does not harden: paths are not followed with it."""
        return None

    def conic_form(self, kinematics: str) -> ConicForm:
        """Planes of T39 in plane strain and plane stress, of T40 in axisymmetry."""
        return _planes(
            kinematics,
            self.cohesion * cos(self.angle),
            sin(self.angle),
            self.tension_cutoff,
            self.crushing,
        )


@dataclass(frozen=True, repr=False)
class Rankine(Compact):
    """Principal stresses between two limits: masonry, plain concrete (T39).

    Attributes:
        tensile_strength: largest principal stress, Pa, >= 0.
        compressive_strength: largest compression of a principal stress, Pa; None: none.

    Raises:
        InputError: a strength that is no number, negative, or beyond what can be computed with.
    """

    tensile_strength: float
    compressive_strength: float | None = None

    def __post_init__(self) -> None:
        _require_cutoffs(
            ("Rankine.tensile_strength", self.tensile_strength),
            ("Rankine.compressive_strength", self.compressive_strength),
        )

    @property
    def strength(self) -> float:
        """Shear stress that it carries without pressure, Pa."""
        limits = (self.tensile_strength, self.compressive_strength)
        return float(min(limit for limit in limits if limit is not None))

    @property
    def label(self) -> str:
        """``tension ≤ 1 Pa, compression ≤ 20 Pa``."""
        return ", ".join(_told(self.tensile_strength, self.compressive_strength))

    @property
    def law(self) -> None:
        """It does not harden: paths are not followed with it."""
        return None

    def conic_form(self, kinematics: str) -> ConicForm:
        """Planes of T39."""
        return _planes(kinematics, None, 0.0, self.tensile_strength, self.compressive_strength)


@dataclass(frozen=True, repr=False)
class NoTension(Compact):
    """Masonry as a continuum: no principal stress is tensile; `Rankine` with a strength of 0.

    Attributes:
        compressive_strength: largest compression of a principal stress, Pa; None: none, and what is
            compressed from all sides is locked.

    Raises:
        InputError: a strength that is not positive.
    """

    compressive_strength: float | None = None

    def __post_init__(self) -> None:
        if self.compressive_strength is not None:
            require_positive("NoTension.compressive_strength", self.compressive_strength)

    @property
    def strength(self) -> float:
        """Shear stress that it carries without pressure: none."""
        return 0.0

    @property
    def label(self) -> str:
        """``no tension``."""
        return ", ".join(["no tension", *_told(None, self.compressive_strength)])

    @property
    def law(self) -> None:
        """It does not harden: paths are not followed with it."""
        return None

    def conic_form(self, kinematics: str) -> ConicForm:
        """Planes of T39."""
        return _planes(kinematics, None, 0.0, 0.0, self.compressive_strength)


@dataclass(frozen=True, repr=False)
class MaximumShear(Compact):
    """Tresca's criterion: no plane carries more than a shear stress (T40).

    In plane strain that of von Mises with the same shear strength; not so in plane stress and in
    axisymmetry. `lacore.Tresca` is the friction law of that name.

    Attributes:
        shear_strength: Pa.

    Raises:
        InputError: a strength that is not positive.
    """

    shear_strength: float

    def __post_init__(self) -> None:
        require_positive("MaximumShear.shear_strength", self.shear_strength)

    @property
    def strength(self) -> float:
        """As `shear_strength`."""
        return self.shear_strength

    @property
    def label(self) -> str:
        """Its strength in shear, Pa."""
        return f"largest shear {self.shear_strength:.4g} Pa"

    @property
    def law(self) -> None:
        """It does not harden: paths are not followed with it."""
        return None

    def conic_form(self, kinematics: str) -> ConicForm:
        """In plane strain the cone of von Mises; planes of T39 and T40 else."""
        return _planes(kinematics, self.shear_strength, 0.0, None, None)


def _planes(
    kinematics: str,
    shear: float | None,
    slope: float,
    tension: float | None,
    crushing: float | None,
) -> ConicForm:
    """Form of ``q <= shear - slope P``, ``sigma_1 <= tension``, ``sigma_3 >= -crushing``.

    Args:
        kinematics: one of `lacore.materials.conic_form.KINEMATICS`.
        shear: ``c cos(phi)``, Pa; None: no such plane.
        slope: ``sin(phi)``.
        tension, crushing: Pa; None: none.
    """
    require_known("Body.kinematics", kinematics, KINEMATICS)
    cut = tension is not None or crushing is not None
    if shear is not None and slope == 0 and not cut and kinematics == "plane_strain":
        return VonMises(shear_strength=shear).conic_form(kinematics)
    planes: list[Surface] = []
    around = kinematics == "axisymmetric"

    def add(pressure: float, strength: float, third: float = 0.0, normed: bool = True) -> None:
        # Stresses (P, t - P) of (theta, eps_tt): without friction no plane feels the first (T40).
        own = (pressure + third, third) if around else (pressure,)
        planes.append(Surface(own, strength, normed))

    if shear is not None:
        add(slope, shear)
        below, above = 2 * shear / (1 + slope), 2 * shear / (1 - slope)
        if around:
            add(1.0, below, -(1 - slope) / (1 + slope))
            add(-1.0, above, (1 + slope) / (1 - slope))
        elif kinematics == "plane_stress":
            add(1.0, below)
            add(-1.0, above)
    for limit, sign in ((tension, 1.0), (crushing, -1.0)):
        if limit is not None:
            add(sign, limit)
            if around:
                add(0.0, limit, sign, normed=False)
    rows, volumes = np.array([[1.0, -1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([[1.0, 1.0, 0.0]])
    if around:
        rows = np.array([[1.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
        volumes = np.array([[1.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 0.0]])
    limits = [limit for limit in (shear, tension, crushing) if limit is not None]
    return ConicForm(
        rows=rows,
        volumetric=volumes,
        bound=min(limits, default=0.0),
        volumetric_factor=0.0,
        surfaces=tuple(planes),
        out_of_plane=0.0 if kinematics == "plane_stress" else 1.0,
    )


def _told(tension: float | None, crushing: float | None) -> list[str]:
    return [
        f"{text} ≤ {limit:.4g} Pa"
        for text, limit in (("tension", tension), ("compression", crushing))
        if limit is not None
    ]


def _require_not_negative(field: str, value: float) -> None:
    if not (is_number(value) and value >= 0):
        raise InputError(field, value, "not a number >= 0", "give a strength >= 0 in Pa")
    require_range(field, value)


def _require_cutoffs(tension: tuple[str, float | None], crushing: tuple[str, float | None]) -> None:
    (tensile, most), (compressive, least) = tension, crushing
    if most is not None:
        _require_not_negative(tensile, most)
    if least is not None:
        require_positive(compressive, least)


def _require_angle(field: str, value: float) -> None:
    if not (is_number(value) and 0 <= value <= _LARGEST_ANGLE):
        raise InputError(
            field, value, "not an angle from 0 to 89 degrees", "give degrees, such as 30"
        )
    if 0 < value < _LEAST_ANGLE:
        raise InputError(
            field, value, "a plane that is all but level, which no solver tells from one", "take 0"
        )
    whole = round(degrees(value))
    if value < pi / 2 and whole >= _LEAST_WHOLE and abs(degrees(value) - whole) < _WHOLE:
        raise InputError(
            field,
            value,
            f"{whole} degrees in radians, by its looks",
            f"give degrees: {whole}; if {value:.4g} degrees are meant, round them",
        )
