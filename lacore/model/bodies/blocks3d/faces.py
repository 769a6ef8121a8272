"""Plane faces of many polyhedra in one table, and a search for faces that may meet."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from lacore.model.bodies.blocks3d.polyhedron import Polyhedron
from lacore.model.bodies.blocks3d.ranges import spread
from lacore.numerics.arrays import Floats, Geometries, Ints
from lacore.reporting.showing import Compact

_TURN = 4.0  # in tolerances: distance of the far sides of two faces, if each vertex is off by one
_TILT = 0.1  # rad; faces at larger angles are not the two sides of a joint


@dataclass(frozen=True, eq=False, repr=False)
class Faces(Compact):
    """Plane faces of blocks, one block after the other.

    Attributes:
        origin: origin of all places, (3,), m, so that none loses digits far from zero.
        block: number, (F,). `rank`: of the block, by its place and not by its number, (F,).
        normal: outward, (3, F). `offset`: ``normal.x``, m, (F,). `area`: m^2, (F,).
        low, high: bounding boxes, (3, F), m.
        width: area over twice the distance of its farthest corner from its centroid, (F,), m.
        points: vertices of all rings, (3, p), m, and the number of the ring, `ring`, (p,).
        ring_face: face of each ring, (r,), ascending.
    """

    origin: Floats
    block: Ints
    rank: Ints
    normal: Floats
    offset: Floats
    area: Floats
    low: Floats
    high: Floats
    width: Floats
    points: Floats
    ring: Ints
    ring_face: Ints

    @property
    def count(self) -> int:
        """Number of faces."""
        return self.block.size


def faces_of(polyhedra: Sequence[Polyhedron]) -> Faces:
    """Return the plane faces of all blocks."""
    counts = np.array([own.area.size for own in polyhedra])
    block = np.repeat(np.arange(counts.size), counts)
    centroids = np.stack([own.centroid for own in polyhedra])
    ordered = np.lexsort(centroids.T[::-1])
    origin = centroids[ordered].mean(axis=0)  # independent of the order of the blocks
    rank = np.empty_like(ordered)
    rank[ordered] = np.arange(ordered.size)

    rings = [ring for own in polyhedra for ring in own.rings]
    first = np.cumsum(counts) - counts
    ring_face = np.concatenate(
        [own.ring_face + begin for own, begin in zip(polyhedra, first, strict=True)]
    )
    shift = np.cumsum([0, *(len(own.vertices) for own in polyhedra)])[:-1]
    moved = np.repeat(shift, [len(own.rings) for own in polyhedra])
    vertices = np.concatenate([own.vertices for own in polyhedra])
    ring = np.repeat(np.arange(len(rings)), [len(own) for own in rings])
    points = vertices[np.concatenate(rings) + moved[ring]] - origin

    order = np.argsort(ring_face, kind="stable")  # Holes come after the outline of their face.
    turned = np.empty_like(order)
    turned[order] = np.arange(order.size)
    place = np.argsort(turned[ring], kind="stable")
    points, ring, ring_face = points[place], turned[ring][place], ring_face[order]

    starts = np.flatnonzero(np.diff(ring_face[ring], prepend=-1))
    low = np.minimum.reduceat(points, starts).T
    high = np.maximum.reduceat(points, starts).T
    normal = np.concatenate([own.normal for own in polyhedra], axis=1)
    middle = np.concatenate([own.face_centroid for own in polyhedra], axis=1) - origin[:, None]
    area = np.concatenate([own.area for own in polyhedra])
    far = np.linalg.norm(points - middle.T[ring_face[ring]], axis=1)
    return Faces(
        origin,
        block,
        rank[block],
        normal,
        np.sum(normal * middle, axis=0),
        area,
        low,
        high,
        area / (2 * np.maximum.reduceat(far, starts)),
        points.T,
        ring,
        ring_face,
    )


def facing(faces: Faces, reach: float, tilt: float = _TURN) -> tuple[Ints, Ints]:
    """Return the pairs of facing faces of two blocks whose boxes meet.

    The first of a pair belongs to the block that lies lower (see `Faces.rank`): its number does not
    depend on the order of the blocks.

    Args:
        faces: faces of all blocks.
        reach: distance up to which boxes meet, m.
        tilt: how many times `reach` the narrower of the two may rise over its width.
    """
    first, second = boxes_that_meet(faces.low, faces.high, reach)
    first, second = _swapped(first, second, faces.rank)
    first, second = (own[faces.rank[first] < faces.rank[second]] for own in (first, second))
    one, other = faces.normal[:, first], faces.normal[:, second]
    allowed = np.minimum(_TILT, tilt * reach / np.minimum(faces.width[first], faces.width[second]))
    kept = np.linalg.norm(one + other, axis=0) <= allowed
    first, second = first[kept], second[kept]
    order = np.lexsort((second, first))
    return first[order], second[order]


def boxes_that_meet(low: Floats, high: Floats, reach: float) -> tuple[Ints, Ints]:
    """Return the pairs ``first < second`` of boxes within `reach` (m) along each axis.

    They are found in the plane of the two longest axes of all, where most differ.
    """
    long = np.argsort(low.min(axis=1) - high.max(axis=1), kind="stable")
    (x, y), z = long[:2], long[2]
    boxes = shapely.box(low[x] - reach, low[y] - reach, high[x] + reach, high[y] + reach)
    tree = shapely.STRtree(shapely.box(low[x], low[y], high[x], high[y]))
    first, second = tree.query(boxes)
    near = (first < second) & (low[z, first] <= high[z, second] + reach)
    near &= low[z, second] <= high[z, first] + reach
    return first[near], second[near]


def _swapped(first: Ints, second: Ints, rank: Ints) -> tuple[Ints, Ints]:
    turned = rank[first] > rank[second]
    return np.where(turned, second, first), np.where(turned, first, second)


def flat_polygons(faces: Faces, which: Ints, one: Floats, two: Floats) -> Geometries:
    """Return faces as polygons in planes through the origin.

    Args:
        faces: faces of all blocks. `which`: numbers of the wanted ones, (k,), repeated or not.
        one, two: axes of the plane of each, (3, k).
    """
    # Ranges of rings of the wanted faces, and of points of these rings, joined.
    rings, wanted = spread(faces.ring_face, which, faces.count)
    points, ring = spread(faces.ring, rings, faces.ring_face.size)
    place = faces.points[:, points]
    own = wanted[ring]
    flat = np.stack([np.sum(place * axis[:, own], axis=0) for axis in (one, two)], axis=1)
    loops = shapely.linearrings(flat, indices=ring)
    outer = np.flatnonzero(np.diff(wanted, prepend=-1))
    if outer.size == wanted.size:
        return np.asarray(shapely.polygons(loops))
    return np.asarray(shapely.build_area(shapely.multilinestrings(loops, indices=wanted)))
