"""Meshes along the slip lines of a wedge that cuts into a body: the right half of both.

Velocities jump across the line from the tip to the foot of the lip, and turn in the fan around the
end of the contact. Rows of triangles follow that line, columns are rays from the end of the
contact. Below the tip the section of symmetry is cut over the distance that the wedge covers in a
step: the tip separates the material there, so that the vertex at the tip moves with the material.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import cos, log, pi, radians, sin

import numpy as np
import shapely
from scipy.optimize import brentq
from shapely.ops import substring
from skfem import Mesh
from skfem.mesh import MeshTri1, MeshTri2

import lacore as la
from lacore.model.meshes.curved import jacobians
from lacore.numerics.arrays import Floats, Ints
from lacore_verification.cases.shared.wedge_meshes import (
    DEPTH,
    SAMPLES,
    WIDTH,
    Hill,
    along,
    middles,
    surface,
)

_SHARES = np.array([0.1, 0.3, 0.6, 0.85, 0.95, 1.0])  # rows around the end of the contact
_GROWS = 1.8  # from row to row outside the slip lines
_BELOW = 0.6  # share of the columns that end on the bottom of the body, the others on its side
_ON = 1e-4  # of the depth: what counts as on the face, as exact as velocities with friction
_KEPT = 0.8  # share of the lip that stays as a step left it
_PARTS = 50  # of the lip as a polyline
_BULGE = 0.03  # largest height of an edge of the lip, per its length


@dataclass(frozen=True)
class Fan:
    """Meshes of a body, at the beginning and after each step.

    Attributes:
        half_angle: of the wedge, degrees.
        cells: along each straight part of the slip line.
        step: travel of the wedge in a step, m: length of the cut.
    """

    half_angle: float
    cells: int
    step: float

    def first(self, depth: float) -> Mesh:
        """Return the mesh of a body that the wedge has indented to a depth, with Hill's lip."""
        end, foot = Hill(self.half_angle).lip(depth).T
        lip = shapely.LineString([end, foot, (WIDTH, 0.0)])
        return self._mesh(np.array([0.0, -depth]), end, lip, WIDTH * DEPTH)

    def __call__(self, problem: la.Problem) -> Mapping[str, Mesh]:
        """Return the new meshes of the same area, for `la.Remeshing(mesher=...)`."""
        body, tool = problem.bodies["body"], problem.bodies["wedge"]
        assert isinstance(body, la.Body)
        assert isinstance(tool, la.BlockAssembly)
        points = surface(body.mesh)
        while points[SAMPLES, 0] <= _ON * WIDTH * self.step:
            points = points[SAMPLES:]  # of a cut that friction has kept closed
        points[0] = 0.0, tool.centroid[1, 0]  # the tip, not only as exact as solved
        end, lip = _contact_end(points, self.half_angle)
        return {"body": self._mesh(points[0], end, lip, _area(body.mesh))}

    def _mesh(self, tip: Floats, end: Floats, lip: shapely.LineString, area: float) -> Mesh:
        """Return a mesh of a given area: the edges of the lip compensate for its new vertices."""
        lip, foot = _with_foot(lip, Hill(self.half_angle).contact * -tip[1])
        length = lip.project(shapely.Point(foot))
        line, near_lip = _slip_line(tip, end, foot, self.cells)
        below = DEPTH + tip[1]
        outside = _growing(self.step, below)[1:] / below
        far = _far_ends(len(line))
        rows = [(1 - share) * end + share * line for share in _SHARES]
        rows += [(1 - share) * line + share * far for share in outside]
        places = np.stack(rows)  # rows, columns, 2
        at = np.concatenate([_SHARES * length, length + outside * (lip.length - length)])
        top = along(lip, at)
        top[-1] = WIDTH, 0.0
        places += near_lip[:, None] * (top - places[:, -1])[:, None]
        mesh = MeshTri2.from_mesh(_crossed(end, places))
        lip_edges = _edges(mesh, np.concatenate([[0], len(line) * np.arange(1, len(rows) + 1)]))
        return _named(_with_lip(mesh, lip_edges, lip, np.concatenate([[0.0], at]), area))


def _with_lip(mesh: Mesh, edges: Ints, lip: shapely.LineString, at: Floats, area: float) -> Mesh:
    """Return the mesh with curved edges of the lip, and with the given area.

    Args:
        mesh: with straight edges.
        edges: of the surface from the end of the contact on.
        lip: that surface.
        at: distances of the vertices along it.
        area: of the body, m^2: edges up to the foot of the lip make up for what is missing.
    """
    ends = mesh.p[:, mesh.facets[:, edges]]
    chords = (ends[:, 1] - ends[:, 0]).T
    lengths = np.linalg.norm(chords, axis=1)
    bulges = middles(lip, at) - ends.mean(axis=1).T
    heights = np.linalg.norm(bulges, axis=1).clip(1e-300)
    bulges *= np.minimum(1.0, _BULGE * lengths / heights)[:, None]
    mesh = _bulged(mesh, edges, bulges)
    beside = slice(len(_SHARES) + 2)
    lift = 1.5 * (area - _area(mesh)) / lengths[beside].sum()
    outwards = np.stack([-chords[:, 1], chords[:, 0]], axis=1) / lengths[:, None]
    return _bulged(mesh, edges[beside], lift * outwards[beside])


def _contact_end(points: Floats, half_angle: float) -> tuple[Floats, shapely.LineString]:
    """Return where a `surface` leaves the face of the wedge, and the surface from there on.

    The edge that leaves the face is divided into a part on the face and a straight one, which
    enclose the same area.
    """
    beta = radians(half_angle)
    face = np.array([sin(beta), cos(beta)])
    away = np.abs((points - points[0]) @ np.array([cos(beta), -sin(beta)]))
    off = away[SAMPLES:] > -_ON * points[0, 1]  # friction may keep the edge at the tip off the face
    last = SAMPLES + int(np.argmax(off)) - 1
    begin = last // SAMPLES * SAMPLES
    edge = points[begin : begin + SAMPLES + 1] - points[begin]
    x, y = edge.T
    # A polygon of n parts in a parabola lacks 1/n^2 of its area.
    area = float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])) / 2 / (1 - 1 / SAMPLES**2)
    length = 2 * area / (face[0] * y[-1] - face[1] * x[-1])
    end = points[begin] + max(length, 0.0) * face
    return end, shapely.LineString([end, *points[begin + SAMPLES :]])


def _with_foot(lip: shapely.LineString, length: float) -> tuple[shapely.LineString, Floats]:
    """Return the surface with a straight end of the lip of the same area, and its foot.

    Velocities jump across the foot: a step leaves a wall there, and the next ones would be drawn to
    it. The straight end continues the chord of the lip to the undisturbed surface.

    Args:
        lip: the surface from the end of the contact on.
        length: of the lip, about. A share of it is kept but for a parabola that makes up for the
            area.
    """
    kept = shapely.get_coordinates(substring(lip, 0.0, _KEPT * length))
    (x0, y0), (x1, y1) = kept[0], kept[-1]
    foot = np.array([x1 + y1 * (x1 - x0) / (y0 - y1), 0.0])
    if not x1 < foot[0] < WIDTH:
        raise la.InputError("lip", foot[0], "it does not fall to the surface", "take smaller steps")
    straight = shapely.LineString([*kept, foot]).segmentize(length / _PARTS)
    points = shapely.get_coordinates(straight)
    lack = _area_under(shapely.get_coordinates(lip)) - _area_under(points)
    share = (points[:, 0] - x0) / (foot[0] - x0)
    points[:, 1] += 6 * share * (1 - share) * lack / (foot[0] - x0)
    return shapely.LineString([*points, (WIDTH, 0.0)]), foot


def _area_under(points: Floats) -> float:
    x, y = points.T
    return float(np.sum(np.diff(x) * (y[1:] + y[:-1]))) / 2


def _slip_line(tip: Floats, end: Floats, foot: Floats, cells: int) -> tuple[Floats, Floats]:
    """Return the line from the tip to the foot of the lip, shape (n, 2), and shares.

    Rectangular triangles of equal legs on the face and under the lip, and an arc between them.
    """
    start, last = (float(np.arctan2(*(own - end)[::-1])) for own in (tip, foot))
    fan = (last - start) % (2 * pi) - pi / 2
    one, two = (float(np.linalg.norm(own - end)) / 2**0.5 for own in (tip, foot))
    parts = np.linspace(0.0, 1.0, cells + 1)
    leg = np.arctan(parts)
    turns = np.linspace(0.0, 1.0, max(1, round(fan * cells)) + 1)
    angle = np.concatenate([pi / 4 - leg[:0:-1], pi / 4 + fan * turns, pi / 4 + fan + leg[1:]])
    radius = np.concatenate(
        [one / np.cos(leg[:0:-1]), one + (two - one) * turns, two / np.cos(leg[1:])]
    )
    turned = start + angle
    line = end + radius[:, None] * np.stack([np.cos(turned), np.sin(turned)], axis=1)
    line[0], line[-1] = tip, foot
    return line, np.clip((angle - pi / 4 - fan) / (pi / 4), 0.0, 1.0)


def _far_ends(columns: int) -> Floats:
    """Return the ends of columns on the bottom and the side of the body, shape (columns, 2)."""
    corner = round(_BELOW * (columns - 1))
    places = np.full((columns, 2), [WIDTH, -DEPTH])
    places[: corner + 1, 0] = np.linspace(0.0, WIDTH, corner + 1)
    places[corner:, 1] = np.linspace(-DEPTH, 0.0, columns - corner)
    return places


def _growing(first: float, length: float) -> Floats:
    """Return the places from 0 to a length, of cells that grow from a first one."""
    count = max(2, round(log(1 + length * (_GROWS - 1) / first) / log(_GROWS)))
    powers = np.arange(count)
    ratio = brentq(lambda r: first * np.sum(r**powers) - length, 1.0, 2 * _GROWS)
    return np.concatenate([[0.0], np.cumsum(first * ratio ** powers[:-1]), [length]])


def _crossed(end: Floats, places: Floats) -> MeshTri1:
    """Return triangles around the end of the contact, and four in each cell outside."""
    rows, columns = places.shape[:2]
    number = 1 + np.arange(rows * columns).reshape(rows, columns)
    ring = np.stack([np.zeros(columns - 1, dtype=int), number[0, :-1], number[0, 1:]])
    corners = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]])
    corners = corners.reshape(4, -1)
    points = np.concatenate([[end], places.reshape(-1, 2)])
    centres = points[corners].mean(axis=0)
    middle = len(points) + np.arange(len(centres))
    parts = [np.stack([corners[a], corners[(a + 1) % 4], middle]) for a in range(4)]
    return MeshTri1(
        np.ascontiguousarray(np.concatenate([points, centres]).T),
        np.ascontiguousarray(np.concatenate([ring, *parts], axis=1)),
    )


def _edges(mesh: Mesh, chain: Ints) -> Ints:
    """Return the facets between successive vertices."""
    known = {ends: facet for facet, ends in enumerate(map(tuple, mesh.facets.T.tolist()))}
    return np.array([known[one, two] for one, two in pairwise(chain.tolist())])


def _bulged(mesh: Mesh, edges: Ints, by: Floats) -> Mesh:
    """Return the mesh after shifts of the midside nodes of edges, m, shape (edges, 2)."""
    nodes = mesh.doflocs.copy()
    nodes[:, mesh.nvertices + edges] += by.T
    return MeshTri2(nodes, mesh.t)


def _area(mesh: Mesh) -> float:
    return float(jacobians(mesh).mean(axis=1).sum()) / 2


def _named(mesh: Mesh) -> Mesh:
    """Return the mesh with the boundaries of the body; the cut is also a part of its top."""
    facets = mesh.boundary_facets()
    x, y = mesh.p[:, mesh.facets[:, facets]]
    left, right = (x == 0).all(axis=0), (x == WIDTH).all(axis=0)
    bottom = (y == -DEPTH).all(axis=0)
    cut = left & (y.max(axis=0) == y[:, left].max())
    return mesh.with_boundaries(
        {
            "left": facets[left & ~cut],
            "right": facets[right],
            "bottom": facets[bottom],
            "cut": facets[cut],
            "top": facets[cut | ~(left | right | bottom)],
        }
    )
