"""Varying friction angles, as cones within and around all of an element.

Where the angle varies in an element, and cohesion too, a cone is within all of those there if its
angle and its apex are at most the smallest, and around all if they are at least the largest. The
apex limits tension, and that of the smallest cohesion and angle may be beyond it (T87).
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

_SAME = 1e-12  # relative difference of angles that are uniform in an element
Known = tuple[tuple[Field, Varying], ...]


@dataclass(frozen=True)
class Envelopes:
    """Forms of a region with varying angles: around, and within, all of each element."""

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
    """Return the forms of a criterion whose friction angle, or dilation angle, varies.

    Args:
        place: name of the criterion, for messages.
        criterion: criterion with these angles.
        known: values of all of its fields in the elements.
        mesh: mesh of the body.
        elements: elements of the region, shape (e,).
        kinematics: kinematics of the body.

    Raises:
        InputError: invalid angles somewhere, or 0; dilation above friction.
    """
    assert isinstance(criterion, Angled)  # Only this criterion may have a field as angle.
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
    """Return the smallest and largest value in elements, shape (e,) each."""
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
    """Return the dilation angles of elements, degrees, as means; None: associated.

    No bound needs more, because there are none for non-associated flow.
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
    """Return values of elements as those of all of a mesh, arbitrary elsewhere."""
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
    """Return the centre of an element, for messages."""
    place = vertices(mesh)[:, mesh.t[:, element]].mean(axis=1)
    return f"({', '.join(f'{own:.4g}' for own in place)})"
