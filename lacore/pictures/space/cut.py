"""Tetrahedra cut by a plane: polygons in it, and their velocities."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from skfem import ElementTetP1, ElementTetP2, MeshTet

from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError, is_vector
from lacore.reporting.showing import Compact

_SAME = 1e-9  # by the size of a mesh: distance of vertices that lie in the plane
_NOTHING = 1e-12  # by the square of that size: area of edges and vertices in the plane
# Edges that the plane crosses, around the polygon, for vertices sorted by height: one, two, three
# of them below it. A triangle repeats its last corner.
_FROM = np.array([(0, 0, 0, 0), (0, 0, 1, 1), (0, 1, 2, 2)])
_TO = np.array([(1, 2, 3, 3), (2, 3, 3, 2), (3, 3, 3, 3)])


@dataclass(frozen=True, eq=False, repr=False)
class Plane(Compact):
    """Plane with axes in it.

    Attributes:
        point: point on it, (3,), m.
        normal: unit vector, (3,).
        axes: two orthogonal unit vectors in it, (2, 3): for planes across a coordinate axis the two
            others, else the second one has the steepest slope of the plane.
    """

    point: Floats
    normal: Floats
    axes: Floats

    @property
    def names(self) -> list[str]:
        """Names of its axes: x, y, z, or the direction."""
        return [_name(own) for own in self.axes]


def _name(axis: Floats) -> str:
    along = np.flatnonzero(np.abs(axis) > _SAME)
    if along.size == 1:
        return "xyz"[along[0]]
    return f"along ({', '.join(f'{round(own, 2) + 0.0:g}' for own in axis.tolist())})"


def plane_of(point: Sequence[float], normal: Sequence[float]) -> Plane:
    """Return the plane through a point, m, across a vector of any length and sense.

    Raises:
        InputError: one of them is not three finite numbers, or the normal is zero.
    """
    for field, given in (("point", point), ("normal", normal)):
        if not is_vector(given) or len(given) != 3:
            raise InputError(field, given, "not three finite numbers", "give x, y and z")
    vector = np.array(normal, dtype=np.float64)
    largest = np.abs(vector).max()
    if largest == 0:
        raise InputError("normal", normal, "it has no direction", "(0, 1, 0) cuts across y")
    vector = vector / largest
    vector[np.abs(vector) < _SAME] = 0.0
    vector = vector / np.linalg.norm(vector)
    rise = np.array([0.0, 0.0, 1.0]) if vector[:2].any() else np.array([0.0, 1.0, 0.0])
    up = rise - vector * (vector @ rise)
    up = up / np.linalg.norm(up)
    across = np.cross(up, vector)
    across = across * np.sign(across[np.flatnonzero(np.abs(across) > _SAME)[0]])
    return Plane(np.array(point, dtype=np.float64), vector, np.stack([across, up]) + 0.0)


@dataclass(frozen=True, eq=False, repr=False)
class Cut(Compact):
    """Polygons of tetrahedra cut by a plane.

    Attributes:
        element: element of each, (k,).
        corners: in the axes of the plane, in order around it, (2, 4, k), m; a triangle repeats its
            last corner.
        area: areas, (k,), m^2.
        share: barycentric coordinates of the centroid in the element, (4, k).
    """

    element: Ints
    corners: Floats
    area: Floats
    share: Floats

    def centroid(self, mesh: MeshTet) -> Floats:
        """Return the centroids, (3, k), m."""
        return np.asarray(np.einsum("xvk,vk->xk", mesh.p[:, mesh.t[:, self.element]], self.share))


def cut_by(plane: Plane, mesh: MeshTet) -> Cut:
    """Return the section of a mesh with a plane, each place once.

    A face in the plane belongs to the element below it, at the boundary to its only one.
    """
    size = float(np.linalg.norm(np.ptp(mesh.p, axis=1)))
    height = plane.normal @ (mesh.p - plane.point[:, None])
    height[np.abs(height) <= _SAME * size] = 0.0
    of_vertices = height[mesh.t]
    below = np.sum(of_vertices < 0, axis=0)
    crossed = np.flatnonzero((below > 0) & (below < 4))
    rank = np.argsort(of_vertices[:, crossed], axis=0)
    start = np.take_along_axis(rank, _FROM[below[crossed] - 1].T, axis=0)
    end = np.take_along_axis(rank, _TO[below[crossed] - 1].T, axis=0)
    low = np.take_along_axis(of_vertices[:, crossed], start, axis=0)
    high = np.take_along_axis(of_vertices[:, crossed], end, axis=0)
    part = low / (low - high)
    vertex = np.arange(4)[:, None, None]
    share = (1 - part) * (vertex == start) + part * (vertex == end)
    floor = mesh.boundary_facets()
    floor = floor[np.all(height[mesh.facets[:, floor]] == 0, axis=0)]
    floor = floor[below[mesh.f2t[0, floor]] == 0]
    lowest = mesh.f2t[0, floor].astype(np.int64)
    own = mesh.facets[[0, 1, 2, 2]][:, floor]
    element = np.concatenate([crossed, lowest])
    share = np.concatenate([share, mesh.t[:, None, lowest] == own], axis=2)
    return _measured(plane, mesh, element, share, _NOTHING * size**2)


def _measured(plane: Plane, mesh: MeshTet, element: Ints, share: Floats, least: float) -> Cut:
    """Return the polygons larger than `least`, by shares of vertices in corners, (4, 4, k)."""
    places = plane.axes @ mesh.p
    corners = np.einsum("xvk,vck->xck", places[:, mesh.t[:, element]], share)
    one, two, three = (corners[:, end] - corners[:, 0] for end in (1, 2, 3))
    halves = np.abs([one[0] * two[1] - one[1] * two[0], two[0] * three[1] - two[1] * three[0]]) / 2
    area = halves.sum(axis=0)
    kept = area > least
    halves, share = halves[:, kept] / area[kept], share[:, :, kept]
    thirds = [share[:, corner].sum(axis=1) / 3 for corner in ([0, 1, 2], [0, 2, 3])]
    centre = halves[0] * thirds[0] + halves[1] * thirds[1]
    return Cut(element[kept], corners[:, :, kept], area[kept], centre)


def velocity_in(plane: Plane, cut: Cut, dofs: BodyDofs, velocity: Floats) -> Floats:
    """Return the velocity in the plane at the centroids of a cut, (2, k), m/s.

    Args:
        plane: plane with its axes.
        cut: cut of the mesh of the body.
        dofs: unknowns of the body.
        velocity: velocity at its nodes, (3, nodes), m/s.
    """
    element = ElementTetP2() if dofs.degree == 2 else ElementTetP1()
    nodes = dofs.element_nodes[:, cut.element]
    shape = np.stack([element.lbasis(cut.share[1:], i)[0] for i in range(len(nodes))])
    return np.asarray(plane.axes @ np.einsum("xik,ik->xk", velocity[:, nodes], shape))
