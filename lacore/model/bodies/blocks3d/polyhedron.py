"""Polyhedron with plane faces, a three-dimensional rigid block."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from lacore.model.bodies.blocks3d.pieces import Piece, convex_pieces, hull_of
from lacore.model.bodies.blocks3d.surface import (
    HalfEdges,
    area_vectors,
    closed_again,
    closed_surface,
    in_one_plane,
    outlines,
    require_polygons,
)
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError, require_positive, require_range
from lacore.reporting.showing import Compact

_TOLERANCE = 1e-6  # by the size of the block
_DIGITS = 16 * np.finfo(float).eps  # by the coordinates: accuracy of their sums and products
_FLAT = 1e-10  # volume, by the cube of the size, below which a block is degenerate


@dataclass(frozen=True, eq=False, repr=False)
class Polyhedron(Compact):
    """A polyhedron with plane faces, convex or not (T70).

    Its faces may be divided into polygons, such as triangles: neighbours in one plane count as one
    plane face.

    Attributes:
        vertices: (n, 3), m.
        faces: vertex numbers of polygons, each in order around it. They are stored counterclockwise
            as seen from outside, for any given orientation.
        tolerance: m: how far a vertex may be off the plane of its face; if None 1e-6 of the
            diagonal of the bounding box.
        plane: number of the plane face to which each polygon belongs, (p,).
        rings: vertex numbers around the plane faces, counterclockwise as seen from outside, and
            clockwise around holes in them; `ring_face`: their plane faces, (r,).
        normal: unit normals of the plane faces, outward, (3, f).
        area: areas of the plane faces, (f,), m^2. `face_centroid`: their centroids, (3, f), m.
        offset: ``normal.x`` on each plane face, (f,), m.
        volume: volume, m^3. `centroid`: centroid of the volume, (3,), m.
        radius: largest distance of a vertex from the centroid, m.
        pieces: convex pieces, as half-spaces; one if no vertex lies outside the plane of a face by
            more than `tolerance`.

    Raises:
        InputError: vertices that are not finite or not on a face; faces that are warped, without
            area, crossed; a surface that is open, has one side only or several parts, meets or
            crosses itself; no volume.

    Example:
        >>> corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
        >>> stone = la.Polyhedron(corners, faces=[(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
        >>> round(stone.volume, 3)
        0.167
    """

    vertices: Floats
    faces: Sequence[Sequence[int]]
    tolerance: float | None = None
    plane: Ints = field(init=False, repr=False)
    rings: tuple[Ints, ...] = field(init=False, repr=False)
    ring_face: Ints = field(init=False, repr=False)
    normal: Floats = field(init=False, repr=False)
    area: Floats = field(init=False, repr=False)
    face_centroid: Floats = field(init=False, repr=False)
    offset: Floats = field(init=False, repr=False)
    volume: float = field(init=False)
    centroid: Floats = field(init=False, repr=False)
    radius: float = field(init=False, repr=False)
    pieces: tuple[Piece, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        points = _points(self.vertices)
        size = float(np.linalg.norm(np.ptp(points, axis=0)))
        tolerance = self.tolerance
        if tolerance is None:
            tolerance = max(_TOLERANCE * size, _DIGITS * float(np.abs(points).max()))
        else:
            require_positive("Polyhedron.tolerance", tolerance)
        edges = closed_surface(points, self.faces, "Polyhedron.faces")
        unused = np.setdiff1d(np.arange(len(points)), edges.start)
        if unused.size:
            raise InputError(
                "Polyhedron.vertices", None, f"no face has vertex {unused[0]}", "remove it"
            )
        require_polygons(points, edges, tolerance, "Polyhedron.faces")
        volume, centroid = _volume(points, edges)
        if not abs(volume) > _FLAT * size**3:
            raise InputError("Polyhedron", None, "a block without volume", "fix its vertices")
        if volume < 0:  # All faces are oriented inwards.
            reverse = _reversed(edges)
            edges = closed_again(reverse, edges.counts, len(points))
        plane = in_one_plane(points, edges, tolerance)
        rings, ring_face = outlines(edges, plane)
        normal, area, middle = _plane_faces(points, edges, plane)
        offset = np.sum(normal * middle, axis=0)
        ends = np.append(edges.first[1:], edges.start.size)
        triangles = points[
            np.stack([edges.start[edges.first][edges.face], edges.start, edges.end], 1)
        ]
        outline = np.concatenate(rings), np.repeat(ring_face, [len(ring) for ring in rings])
        computed = {
            "vertices": points,
            "faces": tuple(
                tuple(edges.start[a:b].tolist()) for a, b in zip(edges.first, ends, strict=True)
            ),
            "tolerance": float(tolerance),
            "plane": plane,
            "rings": rings,
            "ring_face": ring_face,
            "normal": normal,
            "area": area,
            "face_centroid": middle,
            "offset": offset,
            "volume": abs(volume),
            "centroid": centroid,
            "radius": float(np.linalg.norm(points - centroid, axis=1).max()),
            "pieces": convex_pieces(
                normal, offset, points, outline, triangles, tolerance, "Polyhedron.faces"
            ),
        }
        for name, value in computed.items():
            object.__setattr__(self, name, value)

    @property
    def convex(self) -> bool:
        """Whether it is convex."""
        return len(self.pieces) == 1

    @property
    def hull(self) -> Piece:
        """Its vertices, and the planes of faces that no vertex is outside of."""
        assert self.tolerance is not None  # set in the constructor
        return hull_of(self.normal, self.offset, self.vertices, self.tolerance)

    @cached_property
    def edges(self) -> Ints:
        """Vertex numbers of the ends of the edges between plane faces, (2, e)."""
        start = np.concatenate(self.rings)
        end = np.concatenate([np.roll(ring, -1) for ring in self.rings])
        return np.stack([start, end])[:, start < end]  # each is traversed twice

    @property
    def box(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of its bounding box, m, (3,) each."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)


def _points(vertices: npt.ArrayLike) -> Floats:
    try:
        points = np.array(vertices, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        points = np.zeros(0)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 4:
        raise InputError(
            "Polyhedron.vertices",
            None,
            "not the vertices of a polyhedron",
            "give at least four (x, y, z), shape (n, 3)",
        )
    if not np.all(np.isfinite(points)):
        first = np.flatnonzero(~np.isfinite(points).all(axis=1))[0]
        raise InputError(
            f"Polyhedron.vertices[{first}]",
            points[first].tolist(),
            "not finite",
            "fix the coordinates",
        )
    require_range("Polyhedron.vertices", points)
    return points


def _reversed(edges: HalfEdges) -> Ints:
    """Return the vertex numbers of all polygons in reverse order."""
    last = edges.first + edges.counts - 1
    mirror = (edges.first + last)[edges.face] - np.arange(edges.start.size)
    return edges.start[mirror]


def _volume(points: Floats, edges: HalfEdges) -> tuple[float, Floats]:
    """Return volume (negative: faces inwards) and centroid, by tetrahedra over triangles (T70)."""
    origin = points.mean(axis=0)  # a close origin, so that no digits are lost far from (0, 0, 0)
    triangle, middle = area_vectors(points - origin, edges)
    parts = np.sum(triangle * middle, axis=1) / 3
    volume = float(parts.sum())
    with np.errstate(divide="ignore", invalid="ignore"):  # The caller reports a zero volume.
        centroid = origin + 0.75 * (parts @ middle) / volume
    return volume, centroid


def _plane_faces(points: Floats, edges: HalfEdges, plane: Ints) -> tuple[Floats, Floats, Floats]:
    """Return the normals (3, f), areas and centroids (3, f) of plane faces."""
    origin = points.mean(axis=0)
    triangle, middle = area_vectors(points - origin, edges)
    face = plane[edges.face]
    vector = np.stack([np.bincount(face, own) for own in triangle.T])
    area = np.linalg.norm(vector, axis=0)
    normal = vector / area
    signed = np.sum(triangle.T * normal[:, face], axis=0)
    centroid = np.stack([np.bincount(face, signed * own) for own in middle.T]) / area
    low, high = np.full_like(centroid, np.inf), np.full_like(centroid, -np.inf)
    np.minimum.at(low.T, face, points[edges.start])
    np.maximum.at(high.T, face, points[edges.start])
    # The centroid is clipped to its box, so that `x[2] == 0.7` holds for a face at 0.7.
    return normal, area, np.clip(centroid + origin[:, None], low, high)
