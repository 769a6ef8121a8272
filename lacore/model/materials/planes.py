"""Planes in stress space that form criteria, and checks of their numbers (T39, T40)."""

from collections.abc import Callable
from math import degrees, pi, radians

import numpy as np

from lacore.model.materials.conic_form import KINEMATICS, SPACE, ConicForm, Surface
from lacore.model.materials.fields import Field, Strength, Strengths, number_told
from lacore.model.materials.von_mises import VonMises
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import (
    InputError,
    is_number,
    require_known,
    require_positive,
    require_range,
)
from lacore.reporting.showing import rounded_down
from lacore.reporting.text import Quantity, text

Slope = float | Floats
"""Slope for all elements, or for each."""
# degrees: outside these limits a plane is almost level, or upright
_LEAST_ANGLE, _LARGEST_ANGLE = 0.1, 89.0
_WHOLE = 2e-3  # degrees: distance from a whole angle that looks like radians


def planes_form(
    kinematics: str,
    shear: Strengths | None,
    slope: float | Floats,
    tension: Strength | None,
    crushing: Strength | None,
    dilation: Slope | None = None,
) -> ConicForm:
    """Return the form of planes of friction and of limits.

    The planes are ``q <= shear - slope P``, ``sigma_1 <= tension`` and ``sigma_3 >= -crushing``.

    Args:
        kinematics: one of `lacore.model.materials.conic_form.KINEMATICS`.
        shear: ``c cos(phi)``, Pa; None: no such plane.
        slope: ``sin(phi)``, for all elements or for each; 0 for all or for none.
        tension, crushing: Pa; None: unlimited.
        dilation: ``sin(psi)`` of flow on the planes of friction; None: it is associated. Flow on
            the others always is (T88).
    """
    require_known("Body.kinematics", kinematics, KINEMATICS)
    if kinematics == SPACE:
        raise InputError(
            "Body.criterion",
            "planes of friction, or of the largest shear stress",
            "in three dimensions these depend on all three principal stresses, which no cone of"
            " lacore states",
            "take VonMises, or DruckerPrager",
        )
    cut = tension is not None or crushing is not None
    if shear is not None and not np.any(slope) and not cut and kinematics == "plane_strain":
        return VonMises(shear_strength=shear).conic_form(kinematics)  # type: ignore[arg-type]  # no array: of angles of elements there is none of 0
    around = kinematics == "axisymmetric"
    friction = [] if shear is None else _friction_planes(kinematics, shear, slope, dilation)
    surfaces = (*friction, *_limit_planes(around, tension, crushing))
    rows, volumes = np.array([[1.0, -1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([[1.0, 1.0, 0.0]])
    if around:
        rows = np.array([[1.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
        volumes = np.array([[1.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 0.0]])
    limits: list[Strengths] = [own for own in (shear, tension, crushing) if own is not None]
    return ConicForm(
        rows=rows,
        volumetric=volumes,
        bound=_least(limits),
        surfaces=surfaces,
        out_of_plane=0.0 if kinematics == "plane_stress" else 1.0,
    )


def _slopes(around: bool, pressure: Slope, third: Slope) -> tuple[Slope, ...]:
    """Return the slopes of a surface along (P, t - P) in axial symmetry, else along P.

    These are the stresses of (theta, eps_tt): without friction no plane depends on the first (T40).
    """
    return (pressure + third, third) if around else (pressure,)


def _friction_planes(
    kinematics: str, shear: Strengths, slope: Slope, dilation: Slope | None
) -> list[Surface]:
    """Return the planes of friction for each pair of principal stresses, see `planes_form`."""
    around = kinematics == "axisymmetric"

    def plane(strength: Strengths, slopes: Callable[[Slope], tuple[Slope, Slope]]) -> Surface:
        flow = None if dilation is None else _slopes(around, *slopes(dilation))
        return Surface(_slopes(around, *slopes(slope)), strength, flow=flow)

    in_plane = plane(shear, lambda sine: (sine, 0.0))
    below, above = 2 * shear / (1 + slope), 2 * shear / (1 - slope)
    if around:
        return [
            in_plane,
            plane(below, lambda sine: (1.0, -(1 - sine) / (1 + sine))),
            plane(above, lambda sine: (-1.0, (1 + sine) / (1 - sine))),
        ]
    if kinematics == "plane_stress":
        return [in_plane, Surface((1.0,), below), Surface((-1.0,), above)]
    return [in_plane]


def _limit_planes(
    around: bool, tension: Strength | None, crushing: Strength | None
) -> list[Surface]:
    """Return the planes that limit the principal stresses in tension and in compression."""
    surfaces: list[Surface] = []
    for limit, sign in ((tension, 1.0), (crushing, -1.0)):
        if limit is None:
            continue
        surfaces.append(Surface(_slopes(around, sign, 0.0), limit))
        if around:
            surfaces.append(Surface(_slopes(around, 0.0, sign), limit, normed=False))
    return surfaces


def _least(limits: list[Strengths]) -> Strengths:
    """Return the scale of strength at zero pressure: a varying one if there is any."""
    numbers: list[float | Floats] = []
    for limit in limits:
        if isinstance(limit, Field):
            return limit
        numbers.append(limit)
    if any(np.ndim(limit) for limit in numbers):
        return np.asarray(np.min(np.broadcast_arrays(*numbers), axis=0))
    return min(map(float, numbers), default=0.0)


def limits_told(tension: Strength | None, crushing: Strength | None) -> list[str]:
    """Return texts on the limits of principal stresses that exist."""
    return [
        number_told(name, limit)
        if isinstance(limit, Field)
        else text("{} ≤ {}", name, Quantity(limit, "Pa", ".4g"))
        for name, limit in (("tension", tension), ("compression", crushing))
        if limit is not None
    ]


def require_not_negative(field: str, value: Strength) -> None:
    """Raise `InputError` unless a strength is a number >= 0; fields are checked on a mesh."""
    if isinstance(value, Field):
        return
    if not (is_number(value) and value >= 0):
        raise InputError(field, value, "not a number >= 0", "give a strength >= 0 in Pa")
    require_range(field, value)


def require_cutoffs(
    tension: tuple[str, Strength | None], crushing: tuple[str, Strength | None]
) -> None:
    """Raise `InputError` unless a tension is >= 0 and a crushing strength > 0, named by fields."""
    (tensile, most), (compressive, least) = tension, crushing
    if most is not None:
        require_not_negative(tensile, most)
    if least is not None and not isinstance(least, Field):
        require_positive(compressive, least)


def require_angle(field: str, value: float) -> None:
    """Raise `InputError` unless an angle is 0, or from 0.1 to 89 degrees, and not in radians."""
    if not (is_number(value) and 0 <= value <= _LARGEST_ANGLE):
        raise InputError(
            field, value, "not an angle from 0 to 89 degrees", "give degrees, such as 30"
        )
    if 0 < value < _LEAST_ANGLE:
        raise InputError(
            field, value, "a plane that is all but level, which no solver tells from one", "take 0"
        )
    whole = round(degrees(value))
    if 0 < value < pi / 2 and _is_in_radians(value, whole):
        raise InputError(
            field,
            value,
            f"{whole} degrees in radians, by its looks",
            f"give degrees: {whole}; if {value:.4g} degrees are meant, round them",
        )


def _is_in_radians(value: float, whole: int) -> bool:
    """Return whether a number is a whole angle in radians, exact or rounded to three digits."""
    rounded = value == round(radians(whole), 3) != round(value, 2)
    return rounded or abs(degrees(value) - whole) < _WHOLE


def require_dilation(kind: str, dilation: float | None, friction: float) -> None:
    """Raise `InputError` unless a dilation angle is one from 0 to the friction angle, degrees.

    Args:
        kind: kind of the criterion, for messages.
        dilation: psi; None: flow is associated.
        friction: phi.
    """
    if dilation is None:
        return
    field = f"{kind}.dilation_angle"
    require_angle(field, dilation)
    if dilation > friction:
        raise InputError(
            field,
            dilation,
            f"more than the friction angle {friction:.6g}: flow would create energy",
            f"give at most {rounded_down(friction):g}, or none for flow that is associated",
        )
