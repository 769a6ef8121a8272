"""Angles of friction and of dilation: numbers, or varying with place."""

from collections.abc import Callable
from math import atan, degrees, radians, tan
from typing import Protocol, runtime_checkable

import numpy as np

from lacore.model.materials.conic_form import ConicForm
from lacore.model.materials.fields import Field, Given, Strength, Strengths, number_told
from lacore.model.materials.planes import require_angle, require_dilation
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError
from lacore.reporting.text import Symbol


@runtime_checkable
class Angled(Protocol):
    """Criterion whose angles may vary with place.

    Attributes:
        cohesion: Pa.
        friction_angle, dilation_angle: degrees; None: flow is associated.
    """

    cohesion: Given | Field
    friction_angle: Given | Field
    dilation_angle: Given | Field | None

    def form_of(
        self, kinematics: str, angles: Floats, cohesion: Strengths, dilation: Floats | None
    ) -> ConicForm:
        """Return its form with angles, degrees, and cohesions of each element, (elements,).

        Raises:
            InputError: kinematics without such a form.
        """


@runtime_checkable
class CutOff(Protocol):
    """A criterion whose cut-off may have no effect."""

    def beyond_apex(self, at: Callable[[Strength], Floats]) -> Floats | None:
        """Return how far it is beyond the apex, by strengths at places, Pa.

        None without a cut-off.
        """


def require_angles(kind: str, friction: Strength, dilation: Strength | None) -> None:
    """Raise `InputError` unless numbers are valid angles; fields are checked on a mesh."""
    if not isinstance(friction, Field):
        require_angle(f"{kind}.friction_angle", friction)
    if isinstance(dilation, Field):
        return
    if isinstance(friction, Field):
        if dilation is not None:
            require_angle(f"{kind}.dilation_angle", dilation)
        return
    require_dilation(kind, dilation, friction)


def angles_told(friction: Strength, dilation: Strength | None) -> list[str]:
    """Return texts such as ``φ = 30°``, ``ψ = 10°``."""
    return [
        number_told(Symbol(name), own, "°")
        for name, own in (("φ", friction), ("ψ", dilation))
        if own is not None
    ]


def flatter(
    kind: str, friction: Strength, dilation: Strength | None, factor: float
) -> tuple[Strength, Strength | None]:
    """Return friction angles with tangents divided by a factor, and limited dilation angles.

    Raises:
        InputError: angles that are functions of place.
    """
    less: Strength
    if isinstance(friction, Field):
        tangent = np.tan(np.radians(_listed(f"{kind}.friction_angle", friction)))
        less = Field(np.degrees(np.arctan(tangent / factor)))
    else:
        less = degrees(atan(tan(radians(friction)) / factor))
    if dilation is None:
        return less, None
    if isinstance(less, Field) or isinstance(dilation, Field):
        most = _listed(f"{kind}.friction_angle", less)
        return less, Field(np.minimum(_listed(f"{kind}.dilation_angle", dilation), most))
    return less, min(dilation, less)


def _listed(field: str, angle: Strength) -> Floats:
    """Return the angles of elements, or of all, degrees."""
    if not isinstance(angle, Field):
        return np.asarray(angle)
    if callable(angle.values):
        raise InputError(
            field,
            angle,
            "a function of place, whose tangents divided by a factor are no multiple of it",
            "give a value for each element, or regions of one angle each",
        )
    return np.asarray(angle.factor * np.asarray(angle.values))
