"""Corners of convex hulls of many polygons at once."""

import numpy as np
import shapely

from lacore.numerics.arrays import Floats, Geometries, Ints


def hull_corners(shared: Geometries, tolerance: float) -> tuple[Floats, Ints]:
    """Return the corners of convex hulls, (2, m), and the number of the hull of each, (m,).

    They are counterclockwise. Points on the line of their neighbours, to the tolerance (m), are not
    corners.
    """
    hull = shapely.convex_hull(shared)
    place, joint = shapely.get_coordinates(shapely.get_exterior_ring(hull), return_index=True)
    place, joint = _opened(place, joint)
    # Each ring begins where it is farthest from its middle, at a corner that simplifying keeps.
    count = np.bincount(joint, minlength=shared.size)
    begin = np.cumsum(count) - count
    middle = np.stack([np.bincount(joint, own, shared.size) for own in place.T], axis=1)
    far = np.linalg.norm(place - (middle / np.maximum(count, 1)[:, None])[joint], axis=1)
    farthest = np.lexsort((-far, joint))[begin] if joint.size else begin
    behind = np.arange(joint.size) - begin[joint]
    turned = begin[joint] + (behind + (farthest - begin)[joint]) % count[joint]
    rings = shapely.linearrings(place[turned], indices=joint)
    simple = shapely.simplify(shapely.polygons(rings), tolerance)
    simple = shapely.orient_polygons(simple)
    place, joint = shapely.get_coordinates(shapely.get_exterior_ring(simple), return_index=True)
    place, joint = _opened(place, joint)
    return place.T, joint


def _opened(place: Floats, ring: Ints) -> tuple[Floats, Ints]:
    """Return the points of rings without the last of each, which repeats the first."""
    kept = np.diff(ring, append=-1) == 0
    return place[kept], ring[kept]
