"""Varying strengths in the elements of a region, evaluated within each.

They are given at the vertices of each element: exact if they are linear there, else limited from
below and above by their largest slope.
"""

from dataclasses import dataclass

import numpy as np
from skfem import Mesh
from skfem.mesh import MeshTet1, MeshTri1

from lacore.model.bodies.continuum.regions.looking import looked_at
from lacore.model.materials.fields import Bending, Field
from lacore.model.meshes.curved import vertices
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact, placed
from lacore.reporting.text import Quantity, text

_STEEPER = 1e-9  # relative round-off of a slope


def vertex_rule(vertices: int) -> Floats:
    """Return the matrix from strengths at vertices to those of the vertex rule (T85), square."""
    return np.asarray((np.eye(vertices) + 1) / (vertices + 1))


@dataclass(frozen=True, repr=False, eq=False)
class Varying(Compact):
    """`Field` in the elements of a region, without its factor.

    Attributes:
        vertex: values at the vertices of each element, from within it, shape (elements, a), Pa.
        least, greatest: limits in each element, shape (elements,), Pa; None: unknown.
        linear: whether it is linear in each element.
    """

    vertex: Floats
    least: Floats | None
    greatest: Floats | None
    linear: bool

    def below(self) -> Floats:
        """Return values at vertices such that the field is nowhere smaller, (elements, a), Pa."""
        return self._bounding(self.least)

    def above(self) -> Floats:
        """Return values at vertices such that the field is nowhere larger, (elements, a), Pa."""
        return self._bounding(self.greatest)

    def limits(self) -> tuple[Floats, Floats]:
        """Return the limits in each element, (elements,); those at its vertices if unknown."""
        if self.linear or self.least is None or self.greatest is None:
            return self.vertex.min(axis=1), self.vertex.max(axis=1)
        return self.least, self.greatest

    def above_if_known(self) -> Floats:
        """Return `above`; without a known slope the values at vertices, which prove nothing."""
        known = self.linear or self.greatest is not None
        return self.above() if known else self.vertex

    def _bounding(self, limit: Floats | None) -> Floats:
        if self.linear:
            return self.vertex
        if limit is None:
            raise ValueError("what varies without a known slope bounds nothing")
        return np.broadcast_to(limit[:, None], self.vertex.shape)


def in_elements(place: str, own: Field, mesh: Mesh, elements: Ints, positive: bool) -> Varying:
    """Return a field in elements of a mesh, checked."""
    if callable(own.values):
        found = _function(place, own, mesh, elements)
    else:
        found = _listed(place, own.values, mesh, elements)
    if positive and not found.vertex.min() > 0:
        element, corner = np.unravel_index(int(found.vertex.argmin()), found.vertex.shape)
        place_of = placed(vertices(mesh)[:, mesh.t[corner, elements[element]]])
        raise InputError(
            place,
            float(found.vertex[element, corner]),
            f"no strength at {place_of}, and no friction either",
            "let it be positive in all of the region",
        )
    return found


def _listed(place: str, values: Floats, mesh: Mesh, elements: Ints) -> Varying:
    if len(values) != mesh.nelements:
        raise InputError(
            place,
            f"{len(values)} values",
            f"the mesh has {mesh.nelements} elements",
            "give one for each element of the mesh, whatever its region",
        )
    own = values[elements].reshape(elements.size, -1)
    low, high = own.min(axis=1), own.max(axis=1)
    mean = np.repeat(own.mean(axis=1)[:, None], len(mesh.t), axis=1)
    return Varying(mean, low, high, linear=own.shape[1] == 1)


def _function(place: str, own: Field, mesh: Mesh, elements: Ints) -> Varying:
    def at(places: Floats, _: Ints) -> Floats:
        return own.at(places, place)

    values, vertex, linear = looked_at(at, mesh, elements)
    if not isinstance(mesh, MeshTri1 | MeshTet1):
        return Varying(vertex, None, None, linear)
    vertex = np.maximum(vertex, 0.0)  # Negative values are rejected above.
    corner = vertices(mesh)[:, mesh.t[:, elements]]  # shape (d, a, e)
    if own.steepest is None or (linear and _straight(own.values, corner)):
        return Varying(vertex, None, None, linear)
    centre = corner.mean(axis=1)
    radius = np.linalg.norm(corner - centre[:, None], axis=0).max(axis=0)
    at_centre = own.at(centre, place)
    room = own.steepest * radius
    most = np.maximum(at_centre + room, values.max(axis=1))
    steep = np.abs(values - at_centre[:, None]) > (1 + _STEEPER) * room[:, None]
    if steep.any():
        element = int(np.flatnonzero(steep.any(axis=1))[0])
        raise InputError(
            f"{place}.steepest",
            own.steepest,
            text(
                "the function is steeper near {}", Quantity(tuple(centre[:, element]), "m", ".6g")
            ),
            "give its largest slope; where it jumps let edges of the mesh follow",
        )
    # The field may vary by that slope between the places, and is never assumed to be linear.
    return Varying(vertex, np.maximum(at_centre - room, 0.0), most, linear=False)


def _straight(function: object, corner: Floats) -> bool:
    """Return whether a function declares itself linear in each element, by corners (d, a, e)."""
    if not isinstance(function, Bending):
        return False
    return not function.bends(corner.min(axis=1), corner.max(axis=1)).any()
