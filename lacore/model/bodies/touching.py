"""Search for touching edges: joints of rigid blocks, and interfaces of two bodies.

Every shared segment lies in exactly one edge of either side, so fields that are polynomials on the
edges are polynomials on the segment: the segments are the common refinement (T28).
"""

from dataclasses import dataclass

import numpy as np
import shapely

from lacore.numerics.arrays import Bools, Floats, Geometries, Ints
from lacore.reporting.showing import Compact

FACING = np.cos(np.radians(15.0))  # Edges at larger angles meet only at a corner.
TOUCH = 1e-9  # by the size of the body: coordinates in double precision agree to this
NEAR = 0.01  # by the shorter edge: a smaller gap is more likely a mistake than intended


@dataclass(frozen=True)
class Touched:
    """Part of a body that an interface touches.

    Attributes:
        field, name: field and name of the interface, for messages.
        edges: edges of the body.
        by_obstacle: whether it touches an obstacle.
    """

    field: str
    name: str
    edges: Ints
    by_obstacle: bool


@dataclass(frozen=True, eq=False, repr=False)
class Edges(Compact):
    """Straight edges of outlines: `start`, `end`, unit outward `normal`, each (2, n), in m."""

    start: Floats
    end: Floats
    normal: Floats

    @property
    def length(self) -> Floats:
        """Lengths (n,), m."""
        return np.asarray(np.linalg.norm(self.end - self.start, axis=0))

    @property
    def lines(self) -> Geometries:
        """The edges as geometries (n,)."""
        return np.asarray(shapely.linestrings(np.stack([self.start.T, self.end.T], axis=1)))


@dataclass(frozen=True, eq=False, repr=False)
class Shared(Compact):
    """Segments that two families of edges share, sorted along the edges of the first.

    Attributes:
        first, second: edge numbers in either family, (k,).
        start, end: the segment, on the edge of the first family and in its direction, (2, k).
        gap: largest distance across the segment, (k,), m; below 0 where the edges overlap.
    """

    first: Ints
    second: Ints
    start: Floats
    end: Floats
    gap: Floats

    @property
    def length(self) -> Floats:
        """Lengths (k,), m."""
        return np.asarray(np.linalg.norm(self.end - self.start, axis=0))

    def take(self, which: Bools | Ints) -> "Shared":
        """Return some of the segments."""
        return Shared(
            self.first[which],
            self.second[which],
            self.start[:, which],
            self.end[:, which],
            self.gap[which],
        )


def touching(first: Edges, second: Edges, tolerance: float) -> Shared:
    """Return the segments where edges of `first` and `second` touch.

    Two edges touch if they face each other (outward normals opposite within 15 degrees), overlap
    along more than `tolerance`, and are at most `tolerance` (m) apart all along the overlap. A
    corner on an edge is not an overlap. The result does not depend on which family is called first,
    up to the gap by which the segments move across.
    """
    shared = _facing(first, second, np.full(first.start.shape[1], tolerance), tolerance)
    return shared.take(np.abs(shared.gap) <= tolerance)


def near_misses(first: Edges, second: Edges, tolerance: float, share: float = NEAR) -> Shared:
    """Return the segments with a gap between facing edges that is small, but not closed.

    The gap lies above `tolerance` (m) and below `share` of the shorter edge, and is shorter than
    the overlap.
    """
    shared = _facing(first, second, share * first.length, tolerance)
    shortest = np.minimum(first.length[shared.first], second.length[shared.second])
    near = (shared.gap > tolerance) & (shared.gap <= share * shortest)
    return shared.take(near & (shared.length > shared.gap))


def _facing(first: Edges, second: Edges, reach: Floats, least: float) -> Shared:
    """Return the overlaps longer than `least` of facing edges within `reach`, (n,)."""
    tree = shapely.STRtree(second.lines)
    i, j = tree.query(first.lines, predicate="dwithin", distance=reach)
    opposite = np.sum(first.normal[:, i] * second.normal[:, j], axis=0) < -FACING
    i, j = i[opposite], j[opposite]

    origin, normal, length = first.start[:, i], first.normal[:, i], first.length[i]
    along = (first.end[:, i] - origin) / length

    def coordinates(points: Floats) -> tuple[Floats, Floats]:
        """Return coordinates along the first edge and out of it."""
        away = points - origin
        return np.sum(away * along, axis=0), np.sum(away * normal, axis=0)

    (s0, h0), (s1, h1) = coordinates(second.start[:, j]), coordinates(second.end[:, j])
    low = np.maximum(0.0, np.minimum(s0, s1))
    high = np.minimum(length, np.maximum(s0, s1))
    slope = (h1 - h0) / (s1 - s0)
    ends = np.stack([h0 + slope * (low - s0), h0 + slope * (high - s0)])
    gap = np.take_along_axis(ends, np.abs(ends).argmax(axis=0)[None], axis=0)[0]
    shared = Shared(i, j, origin + along * low, origin + along * high, gap)
    order = np.lexsort((low, i))
    return shared.take(order[(high - low > least)[order]])
