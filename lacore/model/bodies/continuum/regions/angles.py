"""Friction angles that vary, as those of elements: cones within, and around, all of an element.

Where the angle varies in an element, and cohesion too, a cone is within all of those there if its
angle and its apex are no more than the least, around all if they are no less than the greatest:
the apex is where tension ends, and least cohesion with least angle may be beyond it (T87).
"""

from dataclasses import dataclass

import numpy as np
from skfem import Mesh

from lacore.model.bodies.continuum.regions.varying import Varying
from lacore.model.materials.angles import Angled
from lacore.model.materials.conic_form import ConicForm
from lacore.model.materials.criterion import Criterion
from lacore.model.materials.fields import Field, Strength, Strengths
from lacore.model.materials.planes import require_angle
from lacore.model.meshes.curved import vertices
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError

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
    known: Known,
    mesh: Mesh,
    elements: Ints,
    kinematics: str,
) -> Envelopes:
    """The forms of a criterion whose friction angle, or dilation angle, varies.

    Args:
        place: of the criterion, for messages.
        criterion: with these angles.
        known: what is known of all of its fields in the elements.
        mesh: of the body.
        elements: of the region, shape (e,).
        kinematics: of the body.

    Raises:
        InputError: angles that are none somewhere, or 0; dilation above friction.
    """
    assert isinstance(criterion, Angled)  # no other takes a field for an angle
    friction: Strength = criterion.friction_angle  # type: ignore[assignment]  # as it was taken
    low, high = _limits(friction, known, elements.size)
    _check(f"{place}.friction_angle", low, high, mesh, elements)
    dilation: Strength | None = criterion.dilation_angle  # type: ignore[assignment]  # as above
    flow = _flow(place, friction, dilation, known, mesh, elements)
    cohesion: Strengths = criterion.cohesion  # type: ignore[assignment]  # as it was taken

    def form(angles: Floats, cohesions: Strengths) -> ConicForm:
        psi = None if flow is None else _spread(np.minimum(flow, angles), mesh, elements)
        return criterion.form_of(kinematics, _spread(angles, mesh, elements), cohesions, psi)

    if np.all(high - low <= _SAME * high):
        both = form(high, cohesion)
        return Envelopes(both, both)
    least, greatest = _limits(cohesion, known, elements.size)
    ratio = np.tan(np.radians(low)) / np.tan(np.radians(high))
    above = form(high, _spread(greatest / ratio, mesh, elements))
    below = form(low, _spread(least * ratio, mesh, elements))
    return Envelopes(above, below)


def _limits(value: Strengths, known: Known, count: int) -> tuple[Floats, Floats]:
    """Least and greatest value in elements, shape (e,) each."""
    if isinstance(value, Field):
        low, high = (value.factor * limit for limit in _of(value, known).limits())
        return low, high
    return np.full(count, value), np.full(count, value)


def _flow(
    place: str,
    friction: Strength,
    dilation: Strength | None,
    known: Known,
    mesh: Mesh,
    elements: Ints,
) -> Floats | None:
    """Dilation angles of elements, degrees, where they vary there the mean; None: associated.

    No bound asks for more: there is none where flow is not associated.
    """
    if dilation is None:
        return None
    psi, phi = (
        own.factor * _of(own, known).vertex if isinstance(own, Field) else np.full((1, 1), own)
        for own in (dilation, friction)
    )
    shape = (elements.size, len(mesh.t))
    over = np.broadcast_to(psi - phi, shape).max(axis=1)
    worst = int(over.argmax())
    if over[worst] > _SAME * float(np.max(phi)):
        raise InputError(
            _at(f"{place}.dilation_angle", mesh, int(elements[worst])),
            float(np.broadcast_to(psi, shape)[worst].max()),
            f"more than the friction angle by {over[worst]:.4g} degrees: flow would create energy",
            "let it be at most the friction angle everywhere, or leave it out where flow is"
            " associated",
        )
    if np.all(psi >= phi):
        return None
    return np.asarray(np.broadcast_to(psi, shape).mean(axis=1))


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
    return f"{place} near {near(mesh, element)}"


def near(mesh: Mesh, element: int) -> str:
    """The centre of an element, for messages."""
    place = vertices(mesh)[:, mesh.t[:, element]].mean(axis=1)
    return f"({', '.join(f'{own:.4g}' for own in place)})"
