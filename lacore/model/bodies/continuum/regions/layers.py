"""Strength of a thin layer along an edge, for velocity jumps (T23)."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from skfem import Mesh

from lacore.model.bodies.continuum.regions.region import Region
from lacore.model.materials.conic_form import ConicForm
from lacore.model.materials.fields import Field
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.program.surfaces import Surfaces
from lacore.reporting.showing import Compact

_SAME = 1e-12  # relative difference of strengths on both sides of an edge that are equal

Ends = tuple[Floats, Floats]
"""Starts and ends of e edges, or of parts of them, shape (2, e) each, m."""


@dataclass(frozen=True, repr=False)
class Carried(Compact):
    """Strengths along e edges, with `copies` control values each.

    Attributes:
        bound: bounds, shape (m,), Pa.
        surfaces: surfaces at the control values; None without pressure dependence.
        ends: bounds at both ends of each edge, shape (2, e), Pa.
    """

    bound: Floats
    surfaces: Surfaces | None
    ends: Floats

    def within(self, other: "Carried") -> "Carried":
        """Return the strengths within those of both sides of the same edges, with friction."""
        assert self.surfaces is not None
        assert other.surfaces is not None
        pairs = (self.surfaces, other.surfaces)
        surfaces = Surfaces(
            slope=np.concatenate([own.slope for own in pairs], axis=1),
            strength=np.concatenate([own.strength for own in pairs], axis=1),
            normed=np.concatenate([own.normed for own in pairs]),
        )
        ends = np.minimum(self.ends, other.ends)
        return Carried(np.minimum(self.bound, other.bound), surfaces, ends)


def alike(one: Carried, other: Carried) -> Bools:
    """Return where control values are equal on both sides, or one side has no friction, (m,)."""
    if one.surfaces is None or other.surfaces is None:
        return np.ones(one.bound.size, dtype=bool)
    (a, b), (k, m) = (
        (one.surfaces.slope, other.surfaces.slope),
        (one.surfaces.strength, other.surfaces.strength),
    )
    same = np.abs(a - b).max(axis=(1, 2)) <= _SAME * np.abs(a).max(initial=0.0)
    return np.asarray(same & (np.abs(k - m).max(axis=1) <= _SAME * np.abs(k).max(initial=0.0)))


@dataclass(frozen=True, repr=False)
class Layer(Compact):
    """Strength of a region in thin layers.

    Attributes:
        region: the region.
        form: form of its dissipation there, see `ConicForm.across`.
    """

    region: Region
    form: ConicForm

    @classmethod
    def of(cls, region: Region) -> "Layer":
        """Return the layers of a region.

        Raises:
            InputError: see `ConicForm.across`.
        """
        return cls(region, region.form.across())

    def along(self, mesh: Mesh, edges: Ends, elements: Ints, copies: int) -> Carried:
        """Return the strengths along edges of elements of the region.

        For strengths that are linear along an edge, they make the sum at least the integral of a
        Bernstein polynomial times the strength, divided by that of the polynomial.
        """
        shares, at = shares_of_controls(copies)[:, 1], np.repeat(elements, copies)
        ends = np.stack([self._bounds(mesh, place, elements) for place in edges])
        if not self.form.varies:
            return Carried(self.form.bounds(at), self.form.surfaces_of(at), ends)

        def values(own: Field) -> Floats:
            first, last = (self._of(own, mesh, place, elements) for place in edges)
            return np.asarray((first[:, None] + (last - first)[:, None] * shares).ravel())

        form, points = self.form.at_points(at, values), np.arange(at.size)
        return Carried(form.bounds(points), form.surfaces_of(points), ends)

    def _bounds(self, mesh: Mesh, places: Floats, elements: Ints) -> Floats:
        if not self.form.varies:
            return self.form.bounds(elements)

        def values(own: Field) -> Floats:
            return self._of(own, mesh, places, elements)

        return self.form.at_points(elements, values).bounds(np.arange(elements.size))

    def _of(self, own: Field, mesh: Mesh, places: Floats, elements: Ints) -> Floats:
        """Return a field at places (2, e) of elements, (e,), as upper values along edges."""
        at = np.searchsorted(self.region.elements, elements)
        known = self.region.of(own).above_if_known()[at]
        if len(mesh.t) != 3:  # tetrahedra, and quadrilaterals, whose values are not bounds
            return np.asarray(known.max(axis=1))
        a, b, c = mesh.p[:, mesh.t[:, elements]].swapaxes(0, 1)
        to_a, to_b, to_c = a - places, b - places, c - places
        shares = np.stack([_cross(to_b, to_c), _cross(to_c, to_a), _cross(to_a, to_b)])
        return np.asarray(np.sum(known.T * shares, axis=0) / _cross(b - a, c - a))


def shares_of_controls(copies: int) -> Floats:
    """Return the weights of both ends in the strength of each control value, (copies, 2)."""
    last = np.arange(1, copies + 1)
    return np.stack([last[::-1], last], axis=1) / (copies + 1)


def costs(
    layers: Mapping[int, Layer], mesh: Mesh, edges: Ends, elements: Ints
) -> tuple[Floats, Ints]:
    """Return the strength of elements along edges at zero pressure, Pa, and their regions, (e,).

    Args:
        layers: layers of regions, by number.
        mesh: mesh of the body.
        edges: edges of the elements.
        elements: shape (e,).
    """
    start, end = edges
    cost, owner = np.zeros(elements.size), np.zeros(elements.size, dtype=np.int64)
    for number, layer in layers.items():
        mine = np.flatnonzero(np.isin(elements, layer.region.elements))
        own = layer.along(mesh, (start[:, mine], end[:, mine]), elements[mine], 1)
        cost[mine], owner[mine] = own.ends.mean(axis=0), number
    return cost, owner


@dataclass(frozen=True, repr=False)
class Beside(Compact):
    """One side of e edges.

    Attributes:
        mesh: mesh of the body there.
        layers: layers of its regions, by number.
        elements: elements at the edges, shape (e,).
        owner: numbers of their regions, shape (e,).
    """

    mesh: Mesh
    layers: Mapping[int, Layer]
    elements: Ints
    owner: Ints

    def along(self, edges: Ends, number: int, mine: Ints, copies: int) -> Carried:
        """Return the strength of a region along some edges, with numbers (m,)."""
        start, end = edges
        ends = (start[:, mine], end[:, mine])
        return self.layers[number].along(self.mesh, ends, self.elements[mine], copies)


def within_both(
    weak: Beside, strong: Beside, number: int, mine: Ints, edges: Ends, copies: int
) -> Iterator[tuple[int | None, Ints, Carried]]:
    """Yield the strength of edges on which a region is the weaker side, in parts.

    Where both sides have different friction, it is the strength within both (T87).

    Args:
        weak, strong: both sides of all edges.
        number: number of the region.
        mine: edges on which it is the weaker side, shape (m,).
        edges: all edges.
        copies: number of control values of an edge.

    Returns:
        The region on the other side if it matters, else None, edges, and their strength; None comes
        last.
    """
    apart = np.zeros(mine.size, dtype=bool)
    for beyond in strong.layers if weak.layers[number].form.surfaces else ():
        there = np.flatnonzero(strong.owner[mine] == beyond)
        one = weak.along(edges, number, mine[there], copies)
        other = strong.along(edges, beyond, mine[there], copies)
        apart[there] = ~alike(one, other).reshape(-1, copies).all(axis=1)
        differing = mine[there[apart[there]]]
        if differing.size:
            one = weak.along(edges, number, differing, copies)
            yield beyond, differing, one.within(strong.along(edges, beyond, differing, copies))
    rest = mine[~apart]
    yield None, rest, weak.along(edges, number, rest, copies)


def _cross(u: Floats, v: Floats) -> Floats:
    return np.asarray(u[0] * v[1] - u[1] * v[0])
