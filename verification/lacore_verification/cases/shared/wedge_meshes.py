"""Hill's solution of a smooth wedge, and meshes of the right half of a body that it indents.

The mesh is one of quadrilaterals in columns below the surface: equal cells along the face of the
wedge, the lip and as deep as plastic flow, and growing ones outside.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import cos, pi, radians, sin

import numpy as np
import shapely
from scipy.optimize import brentq
from shapely.ops import substring
from skfem import Mesh, MeshQuad1, MeshQuad2

import lacore as la
from lacore.model.meshes.curved import edge_curves
from lacore.numerics.arrays import Floats

WIDTH, DEPTH = 6.0, 4.0  # of the half, in largest depths of the wedge
_GROWS = 1.3  # from cell to cell
_ON = 1e-5  # of the depth: what counts as on the face
SAMPLES = 8  # parts of a curved edge as a polyline
_SHARES = np.linspace(0.0, 1.0, SAMPLES + 1)[:-1]


@dataclass(frozen=True)
class Hill:
    """The solution of Hill, Lee & Tupper (1947), similar at every depth c of the tip.

    Attributes:
        half_angle: of the wedge, degrees.
    """

    half_angle: float

    @property
    def fan(self) -> float:
        """Angle theta of the centred fan, rad."""
        beta = radians(self.half_angle)
        return float(
            brentq(lambda t: cos(2 * beta - t) - cos(t) / (1 + sin(t)), 0.0, min(beta * 2, pi / 2))
        )

    @property
    def contact(self) -> float:
        """Return the length h of the contact, which is that of the lip, per depth."""
        beta = radians(self.half_angle)
        return 1 / (cos(beta) - sin(beta - self.fan))

    @property
    def force(self) -> float:
        """Return the force on the whole wedge per k and depth."""
        return 4 * (1 + self.fan) * self.contact * sin(radians(self.half_angle))

    def lip(self, depth: float) -> Floats:
        """Return the ends of the lip, on the face and on the undisturbed surface, shape (2, 2)."""
        beta, h = radians(self.half_angle), self.contact * depth
        start = np.array([h * sin(beta), h * cos(beta) - depth])
        along = np.array([cos(beta - self.fan), -sin(beta - self.fan)])
        return np.stack([start, start + h * along], axis=1)


@dataclass(frozen=True)
class Columns:
    """Meshes of a body, at the beginning and on the way.

    Attributes:
        half_angle: of the wedge, degrees.
        cells: along the face.
        least: smallest size of a cell, m, for the beginning.
    """

    half_angle: float
    cells: int
    least: float

    def first(self) -> Mesh:
        """Return the mesh of the body before it is touched."""
        edge = shapely.LineString([(0.0, 0.0), (WIDTH, 0.0)])
        reach = self.cells * self.least * sin(radians(self.half_angle))
        return self._mesh(substring(edge, 0, reach), substring(edge, reach, WIDTH), 0.0)

    def __call__(self, problem: "la.Problem") -> Mapping[str, Mesh]:
        """Return the new meshes, for `la.sequential(remesh=...)`."""
        body = problem.bodies["body"]
        assert isinstance(body, la.Body)
        points = surface(body.mesh)
        depth = -float(points[0, 1])
        beta = radians(self.half_angle)
        off = np.abs(points[:, 0] * cos(beta) - (points[:, 1] + depth) * sin(beta))
        end = max(int(np.argmax(off > _ON * max(depth, self.least))) - 1, len(_SHARES))
        face, lip = shapely.LineString(points[: end + 1]), shapely.LineString(points[end:])
        return {"body": self._mesh(face, lip, depth)}

    def _mesh(self, face: shapely.LineString, lip: shapely.LineString, depth: float) -> Mesh:
        length = max(Hill(self.half_angle).contact * depth, self.cells * self.least)
        size = length / self.cells
        on_face = np.linspace(0, face.length, max(1, round(face.length / size)) + 1)
        near = min(1.05 * length, 0.8 * lip.length)
        beside = np.linspace(0, near, max(2, round(near / size)) + 1)
        on_lip = np.concatenate([beside, near + _growing(size, lip.length - near)[1:]])
        below = np.linspace(0, length, self.cells + 1)
        rows = np.concatenate([below, length + _growing(size, DEPTH - depth - length)[1:]])
        top = np.concatenate([along(face, on_face)[:-1], along(lip, on_lip)])
        halves = np.concatenate([middles(face, on_face), middles(lip, on_lip)])
        return _columns(top, halves, rows / rows[-1])


def surface(mesh: Mesh) -> Floats:
    """Return the boundary "top" from the tip outwards as a line of points, shape (n, 2)."""
    facets = np.asarray(mesh.boundaries["top"])
    curves, ends = edge_curves(mesh, facets), mesh.facets[:, facets]
    corners = np.unique(ends)
    vertex = int(corners[np.argmin(mesh.p[0, corners] + 1e-3 * mesh.p[1, corners])])
    left, found = set(range(facets.size)), []
    while left:
        edge = next(own for own in left if vertex in ends[:, own])
        left.remove(edge)
        forward = ends[0, edge] == vertex
        for share in _SHARES:
            at = np.full(facets.size, share if forward else 1 - share)
            found.append(curves.at(at)[:, edge])
        vertex = int(ends[1, edge] if forward else ends[0, edge])
    return np.array([*found, mesh.p[:, vertex]])


def lip_error(path: "la.Path", half_angle: float) -> float:
    """Return the largest distance of the surface next to the wedge from Hill's, per depth."""
    snapshot = path.snapshots[-1]
    mesh = path.stage_of(snapshot).meshes_at(snapshot.configuration)["body"]
    points = surface(mesh)
    depth = -float(points[0, 1])
    start, end = Hill(half_angle).lip(depth).T
    tip = np.array([0.0, -depth])
    exact = shapely.LineString([tip, start, end, (WIDTH, 0.0)])
    return float(shapely.distance(shapely.points(points), exact).max()) / depth


def along(line: shapely.LineString, at: Floats) -> Floats:
    """Return the points at distances along a line, shape (n, 2)."""
    return np.asarray(shapely.get_coordinates(shapely.line_interpolate_point(line, at)))


def middles(line: shapely.LineString, at: Floats) -> Floats:
    """Return the middles of curved edges between places of a line, with the same area below."""
    found = []
    for low, high in pairwise(at):
        part = shapely.get_coordinates(substring(line, low, high))
        chord = part[-1] - part[0]
        x, y = part.T
        area = float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2
        normal = np.array([chord[1], -chord[0]])
        found.append((part[0] + part[-1]) / 2 + 1.5 * area / (chord @ chord) * normal)
    return np.array(found)


def _growing(size: float, length: float) -> Floats:
    """Return the places from 0 to a length, of cells that grow from a size."""
    cells = [size * _GROWS]
    while sum(cells) < length:
        cells.append(cells[-1] * _GROWS)
    places = np.concatenate([[0.0], np.cumsum(cells)])
    return np.asarray(places / places[-1] * length)


def _columns(top: Floats, middles: Floats, shares: Floats) -> Mesh:
    """Return the cells below a surface, whose edges have the given middles.

    Rows at shares of the depth.
    """
    below = np.stack([top[:, 0], np.full(len(top), -DEPTH)], axis=1)
    places = (1 - shares)[:, None, None] * top + shares[:, None, None] * below
    rows, columns = places.shape[:2]
    number = np.arange(rows * columns).reshape(rows, columns)
    cells = np.stack([number[1:, :-1], number[1:, 1:], number[:-1, 1:], number[:-1, :-1]])
    straight = MeshQuad1(
        np.ascontiguousarray(places.reshape(-1, 2).T), np.ascontiguousarray(cells.reshape(4, -1))
    )
    facets = straight.boundary_facets()
    row, column = np.divmod(straight.facets[:, facets], columns)
    sides = {
        "top": facets[(row == 0).all(axis=0)],
        "bottom": facets[(row == rows - 1).all(axis=0)],
        "left": facets[(column == 0).all(axis=0)],
        "right": facets[(column == columns - 1).all(axis=0)],
    }
    curved = MeshQuad2.from_mesh(straight)
    nodes = curved.doflocs.copy()
    upper = straight.facets[:, sides["top"]].min(axis=0)  # columns, since they are in the first row
    nodes[:, curved.nvertices + sides["top"]] = middles[upper].T
    return MeshQuad2(nodes, curved.t).with_boundaries(sides)
