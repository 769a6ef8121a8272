"""Convex sets from inside and outside: hulls of points, and half-spaces (T82)."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, HalfspaceIntersection, KDTree, QhullError

from lacore.numerics.arrays import Floats

_FAR = 4.0  # size of a box around all points, by their extent, if half-spaces are unbounded
_SAME = 1e-9  # by the extent: distance of vertices that are equal


@dataclass(frozen=True)
class Hulls:
    """Hull of points, and the half-spaces that contain it.

    Attributes:
        inner: vertices of the hull, (i, k); of a polygon in order.
        outer: vertices of the intersection, (o, k); of a polygon in order.
        gauge: distance of each outer vertex from the centre, by that of the hull, (o,).
        bounded: whether half-spaces alone bound it; else a box is added.
    """

    inner: Floats
    outer: Floats
    gauge: Floats
    bounded: bool

    @property
    def width(self) -> float:
        """Largest distance between both, along rays from the centre, by that of the hull."""
        if not self.bounded:
            return np.inf
        return float(self.gauge.max() - 1)


def gauge(points: Floats, centre: Floats, places: Floats) -> Floats | None:
    """Return the distances of places from a centre, by that of the hull of points, (m,).

    They are at most 1 inside. None if points have no volume, or the centre lies on the boundary.

    Args:
        points: (p, k).
        centre: (k,).
        places: (m, k).
    """
    extent = np.ptp(points, axis=0)
    if not np.all(extent > 0):
        return None
    try:
        hull = ConvexHull((points - centre) / extent)
    except QhullError:
        return None
    faces, reach = hull.equations[:, :-1], -hull.equations[:, -1]
    if not np.all(reach > 0):
        return None
    return np.asarray(np.max((places - centre) / extent @ (faces / reach[:, None]).T, axis=1))


def parts_of_width(
    found: Hulls, planes: Floats, centre: Floats, ways: Floats
) -> tuple[float, float]:
    """Return the distance between both along directions, and the rest if they met in each.

    Args:
        found: both, bounded.
        planes: normals and offsets of the outer one, (h, k + 1).
        centre: point inside, (k,).
        ways: directions from there, (m, k).

    Returns:
        Both are divided by the distance of the inner one, or of the hull of the meeting points.
    """
    speed, room = ways @ planes[:, :-1].T, planes[:, -1] - planes[:, :-1] @ centre
    reach = np.divide(room, speed, out=np.full(speed.shape, np.inf), where=speed > 0).min(axis=1)
    border = centre + reach[:, None] * ways
    along = gauge(found.inner, centre, border)
    between = gauge(border, centre, found.outer)
    assert along is not None
    assert between is not None
    return float(along.max() - 1), float(between.max() - 1)


def hulls(points: Floats, normals: Floats, offsets: Floats, centre: Floats) -> Hulls | None:
    """Return the hull of points and the intersection of half-spaces; None without volume.

    Args:
        points: points inside, (p, k).
        normals, offsets: ``normals q <= offsets``, (h, k) and (h,).
        centre: point inside all of them, (k,).
    """
    if gauge(points, centre, points) is None:
        return None
    extent = np.ptp(points, axis=0)
    count = extent.size
    box = np.concatenate([np.eye(count), -np.eye(count)])
    every = np.concatenate([normals * extent, box])
    most = np.concatenate([offsets - normals @ centre, np.full(2 * count, _FAR)])
    length = np.linalg.norm(every, axis=1)
    crossed = HalfspaceIntersection(
        np.column_stack([every / length[:, None], -most / length]), np.zeros(count)
    )
    corners = _in_order(_distinct(crossed.intersections))
    at_box = np.any(np.abs(corners) >= _FAR * (1 - _SAME), axis=1)
    outer = corners * extent + centre
    far = gauge(points, centre, outer)
    assert far is not None
    return Hulls(
        inner=points[ConvexHull(points / extent).vertices],
        outer=outer,
        gauge=far,
        bounded=not at_box.any(),
    )


def _distinct(corners: Floats) -> Floats:
    """Return each corner once."""
    finite = corners[np.all(np.isfinite(corners), axis=1)]
    pairs = KDTree(finite).query_pairs(_SAME, p=np.inf, output_type="ndarray")
    return np.asarray(np.delete(finite, pairs[:, 1], axis=0))


def _in_order(corners: Floats) -> Floats:
    """Return the corners of a polygon in order around the origin."""
    if corners.shape[1] != 2:
        return corners
    return np.asarray(corners[np.argsort(np.arctan2(corners[:, 1], corners[:, 0]))])
