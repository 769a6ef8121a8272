"""Isoparametric meshes: curved edges and elements, quadratic in their parameters (T31)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from skfem import Mesh, MeshQuad, MeshTri
from skfem.mapping import MappingIsoparametric
from skfem.mesh import MeshQuad1, MeshQuad2, MeshTri1, MeshTri2

from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError, typed
from lacore.reporting.showing import Compact

_SHARES = np.linspace(0.0, 1.0, 4)
_DRAWN = 7  # number of points of a curved edge in pictures


def is_curved(mesh: Mesh) -> bool:
    """Return whether a mesh has midside nodes, which may lie off the middle of straight edges."""
    return isinstance(mesh, MeshTri2 | MeshQuad2)


@typed()
def isoparametric(
    mesh: MeshTri | MeshQuad, onto: Callable[[Floats], Floats] | None = None
) -> MeshTri2 | MeshQuad2:
    """Return the mesh with midside nodes, for curved boundaries; names are kept.

    A rectangle of radii and angles becomes a ring with round cells::

        isoparametric(rectangle((a, b), (0, pi / 2), 4, 8), lambda x: x[0] * [cos(x[1]), sin(x[1])])

    Args:
        mesh: straight triangles or quadrilaterals.
        onto: function from node coordinates (2, n) to their new places, shape (2, n); None: no
            change.

    Raises:
        InputError: another mesh, or a function that does not return one place per node.

    Example:
        >>> ring = la.meshes.quarter_ring(inner=1.0, outer=2.0, n_radial=2, n_angular=6)
        >>> type(la.meshes.isoparametric(ring)).__name__
        'MeshTri2'
    """
    kinds = {MeshTri1: MeshTri2, MeshQuad1: MeshQuad2}
    if type(mesh) not in kinds:
        raise InputError(
            "mesh",
            type(mesh).__name__,
            "not straight triangles or quadrilaterals",
            "give a skfem.MeshTri or MeshQuad",
        )
    curved = replace(kinds[type(mesh)].from_mesh(mesh), _boundaries=mesh.boundaries)
    if onto is None:
        return curved
    moved = np.asarray(onto(curved.p), dtype=np.float64)
    if moved.shape != curved.p.shape:
        raise InputError(
            "onto",
            moved.shape,
            f"not one place for each node, {curved.p.shape}",
            "return an array (2, n) for coordinates (2, n)",
        )
    return replace(curved, doflocs=np.ascontiguousarray(moved))


def vertices(mesh: Mesh) -> Floats:
    """Return the vertices of a mesh, without its midside nodes, shape (2, n)."""
    return np.asarray(mesh.p[:, : mesh.nvertices])


@dataclass(frozen=True, repr=False)
class EdgeCurves(Compact):
    """Quadratic curves by parameters 0 at `start`, 1/2 at `middle`, 1 at `end`, each (2, k)."""

    start: Floats
    middle: Floats
    end: Floats

    @property
    def bulge(self) -> Floats:
        """Vector from the middle of the chord to that of the curve, (2, k): 0 if straight."""
        return self.middle - (self.start + self.end) / 2

    def at(self, s: Floats | float) -> Floats:
        """Return the places at parameters of shape (k,), or one for all, shape (2, k)."""
        return np.asarray((1 - s) * self.start + s * self.end + 4 * s * (1 - s) * self.bulge)

    def tangent(self, s: Floats | float) -> Floats:
        """Return the derivatives of the places by the parameter, m, shape (2, k)."""
        return np.asarray(self.end - self.start + 4 * (1 - 2 * s) * self.bulge)

    def normal(self, s: Floats | float, side: Floats) -> Floats:
        """Return the unit normals, shape (2, k), on the side of vectors of that shape."""
        along = self.tangent(s)
        across = np.stack([along[1], -along[0]]) / np.linalg.norm(along, axis=0)
        return np.asarray(across * np.sign(np.sum(across * side, axis=0)))

    def parameter(self, points: Floats) -> Floats:
        """Return the parameters of the places across the chord from points (2, k), shape (k,)."""
        chord = self.end - self.start
        squared = np.sum(chord**2, axis=0)
        share = np.sum((points - self.start) * chord, axis=0) / squared
        a = -4 * np.sum(self.bulge * chord, axis=0) / squared
        # share = (1 - a) s + a s^2, which increases along an edge that is not folded.
        root = np.sqrt(np.maximum((1 - a) ** 2 + 4 * a * share, 0.0))
        return np.asarray(2 * share / (1 - a + root))

    def between(self, first: Floats, last: Floats) -> EdgeCurves:
        """Return the parts between two parameters, shape (k,) each."""
        return EdgeCurves(self.at(first), self.at((first + last) / 2), self.at(last))


def edge_lines(mesh: Mesh, facets: Ints) -> list[Floats]:
    """Return edges as polylines (points, 2), with two points if all edges are straight."""
    curves = edge_curves(mesh, facets)
    shares = np.linspace(0.0, 1.0, _DRAWN if is_curved(mesh) else 2)
    return list(np.stack([curves.at(s) for s in shares]).transpose(2, 0, 1))


def outlines(mesh: Mesh) -> Floats:
    """Return the polygons around elements, shape (elements, points, 2)."""
    corners = len(mesh.t)
    shares = np.linspace(0.0, 1.0, _DRAWN if is_curved(mesh) else 2)[:-1]
    sides = []
    # In order: the last edge of scikit-fem is from 0 to the last corner.
    for number in range(corners):
        start, end = mesh.t[number], mesh.t[(number + 1) % corners]
        curves = edge_curves(mesh, mesh.t2f[number].astype(np.int64))
        own = EdgeCurves(mesh.p[:, start], curves.middle, mesh.p[:, end])
        sides += [own.at(s) for s in shares]
    return np.stack(sides).transpose(2, 0, 1)


def edge_curves(mesh: Mesh, facets: Ints) -> EdgeCurves:
    """Return the edges of a mesh; straight ones have their middle at s = 1/2."""
    start, end = mesh.p[:, mesh.facets[0, facets]], mesh.p[:, mesh.facets[1, facets]]
    middle = mesh.p[:, mesh.nvertices + facets] if is_curved(mesh) else (start + end) / 2
    return EdgeCurves(start, middle, end)


def jacobians(mesh: Mesh) -> Floats:
    """Return Bernstein coefficients of det J of curved elements, (elements, coefficients), m^2.

    det J lies between their smallest and largest: an element with positive coefficients is not
    inverted anywhere (T31). The orientation of the larger part of elements is positive.
    """
    values = signed_jacobians(mesh)
    return np.asarray(values * np.sign(values.sum(axis=1, keepdims=True)))


def signed_jacobians(mesh: Mesh) -> Floats:
    """Return `jacobians` that are positive for anticlockwise elements."""
    # quadratic: vertices, and 2 m - (a+b)/2 from vertices a, b and the midside node m
    if len(mesh.t) == 3:
        places = np.array([[0, 1, 0, 0.5, 0.5, 0], [0, 0, 1, 0, 0.5, 0.5]])
        change = np.eye(6)
        for row, (a, b) in enumerate([(0, 1), (1, 2), (2, 0)], start=3):
            change[row, [a, b, row]] = -0.5, -0.5, 2.0
    else:  # cubic in either parameter
        places = np.stack([axis.ravel() for axis in np.meshgrid(_SHARES, _SHARES)])
        s = _SHARES[:, None]
        cubic = np.array([1, 3, 3, 1]) * s ** np.arange(4) * (1 - s) ** np.arange(3, -1, -1)
        change = np.kron(np.linalg.inv(cubic), np.linalg.inv(cubic))
    return np.asarray(np.asarray(mesh.mapping().detDF(places)) @ change.T)


def subdivided(mesh: Mesh) -> MeshTri:
    """Return straight triangles between vertices, midside nodes and centres of a curved mesh."""
    nodes = mesh.dofs.element_dofs
    if len(mesh.t) == 3:
        parts = [(0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)]
    else:
        ring = [0, 4, 1, 5, 2, 6, 3, 7]
        parts = [(8, a, b) for a, b in zip(ring, [*ring[1:], 0], strict=True)]
    return MeshTri(mesh.p, np.concatenate([nodes[list(part)] for part in parts], axis=1))


class OnFacets(MappingIsoparametric):  # type: ignore[misc]
    """Mapping of facets with known reference coordinates.

    scikit-fem would iterate for them, and find a wrong place or none in distorted elements.

    Args:
        mesh: mesh of triangles or quadrilaterals.
        facets: numbers, (f,).
        along: parameters along them, from the first vertex to the second, (1, q).
    """

    def __init__(self, mesh: Mesh, facets: Ints, along: Floats) -> None:
        super().__init__(mesh, mesh.elem(), mesh.bndelem)
        own = mesh.t[:, mesh.f2t[0, facets]]
        begin, end = (
            mesh.elem.refdom.p[:, np.argmax(own == vertex, axis=0), None]
            for vertex in mesh.facets[:, facets]
        )
        self._places: Floats = begin + (end - begin) * along

    def invF(self, x: Floats, tind: Ints | None = None) -> Floats:  # noqa: N802, their name
        """Return the reference coordinates of points of the facets, (2, f, q)."""
        return self._places
