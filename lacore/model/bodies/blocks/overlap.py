"""Depth of the overlap of two outlines, as text."""

import numpy as np
import shapely

from lacore.reporting.showing import placed


def depth_of(common: shapely.Geometry) -> float:
    """Return the smallest width of the largest part of an overlap, m."""
    parts = shapely.get_parts(common)
    hull = shapely.convex_hull(parts[np.argmax(shapely.area(parts))])
    corners = shapely.get_coordinates(hull)
    along = np.diff(corners, axis=0)
    long = np.hypot(*along.T)
    along = along[long > 0] / long[long > 0, None]
    across = corners @ np.stack([along[:, 1], -along[:, 0]])
    return float(np.ptp(across, axis=0).min(initial=np.inf)) if len(along) else 0.0


def overlap_told(one: shapely.Geometry, other: shapely.Geometry) -> str:
    """Return a text such as ``overlap at (1.2, 0.5) m, 0.02 m deep, over 0.004 m^2``."""
    common = shapely.intersection(one, other)
    middle = shapely.get_coordinates(shapely.point_on_surface(common))[0]
    said = f"{depth_of(common):.3g} m deep, over {common.area:.3g} m^2"
    return f"overlap at {placed(middle)} m, {said}"
