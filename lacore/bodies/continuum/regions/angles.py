"""Friction angles that vary, as those of elements: cones within, and around, all of an element.

Where the angle varies in an element, and cohesion too, a cone is within all of those there if its
angle and its apex are no more than the least, around all if they are no less than the greatest:
the apex is where tension ends, and least cohesion with least angle may be beyond it (T87).
"""

from dataclasses import dataclass

import numpy as np
from skfem import Mesh

from lacore.arrays import Floats, Ints
from lacore.bodies.continuum.regions.varying import Varying
from lacore.errors import InputError
from lacore.materials.conic_form import ConicForm
from lacore.materials.criterion import Criterion
from lacore.materials.fields import Field, Strengths
from lacore.materials.mohr_coulomb import MohrCoulomb
from lacore.materials.planes import require_angle
from lacore.meshes.curved import vertices

_SAME = 1e-12  # of the angle: uniform in an element, up to round-off
Known = tuple[tuple[Field, Varying], ...]


@dataclass(frozen=True)
class Envelopes:
    """Forms of a region in whose elements the angle varies: around, and within, all."""

    above: ConicForm
    below: ConicForm


def envelopes(
    place: str,
    criterion: Criterion,
    angle: Field,
    known: Known,
    mesh: Mesh,
    elements: Ints,
    kinematics: str,
) -> Envelopes:
    """The forms of a criterion whose friction angle varies.

    Args:
        place: of the criterion, for messages.
        criterion: with that angle.
        angle: its angle, degrees.
        known: what is known of all of its fields in the elements.
        mesh: of the body.
        elements: of the region, shape (e,).
        kinematics: of the body.

    Raises:
        InputError: angles that are none somewhere, or 0.
    """
    assert isinstance(criterion, MohrCoulomb)  # no other takes a field for its angle
    own = _of(angle, known)
    low, high = (angle.factor * limit for limit in own.limits())
    _check(f"{place}.friction_angle", low, high, mesh, elements)
    cohesion: Strengths = criterion.cohesion  # type: ignore[assignment]  # as it was taken
    if np.all(high - low <= _SAME * high):
        form = criterion.form_of(kinematics, _spread(high, mesh, elements), cohesion)
        return Envelopes(form, form)
    least, greatest = _limits(cohesion, known, elements.size)
    ratio = np.tan(np.radians(low)) / np.tan(np.radians(high))
    above, below = (
        criterion.form_of(
            kinematics, _spread(angles, mesh, elements), _spread(cohesions, mesh, elements)
        )
        for angles, cohesions in ((high, greatest / ratio), (low, least * ratio))
    )
    return Envelopes(above, below)


def _limits(cohesion: Strengths, known: Known, count: int) -> tuple[Floats, Floats]:
    """Least and greatest cohesion of elements, Pa, shape (e,) each."""
    if isinstance(cohesion, Field):
        low, high = (cohesion.factor * limit for limit in _of(cohesion, known).limits())
        return low, high
    return np.full(count, cohesion), np.full(count, cohesion)


def _of(field: Field, known: Known) -> Varying:
    return next(own for given, own in known if given.values is field.values)


def _spread(values: Floats, mesh: Mesh, elements: Ints) -> Floats:
    """Values of elements as those of all of a mesh: any where there are none."""
    whole = np.full(mesh.nelements, values[0])
    whole[elements] = values
    return whole


def _check(place: str, low: Floats, high: Floats, mesh: Mesh, elements: Ints) -> None:
    for values in (low, high):
        for worst in (int(values.argmin()), int(values.argmax())):
            require_angle(_at(place, mesh, elements[worst]), float(values[worst]))
    if low.min() == 0:
        raise InputError(
            _at(place, mesh, int(elements[np.argmin(low)])),
            0.0,
            "without friction strength feels no pressure: it does in all of a region or nowhere",
            "make a region of what has none, friction_angle=0; or let the least be 0.1 degrees",
        )


def _at(place: str, mesh: Mesh, element: int) -> str:
    return f"{place} near {_near(mesh, element)}"


def _near(mesh: Mesh, element: int) -> str:
    x, y = vertices(mesh)[:, mesh.t[:, element]].mean(axis=1)
    return f"({x:.4g}, {y:.4g})"
