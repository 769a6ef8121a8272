"""Joints that crush: pressure in cells, none above a strength, that replaces points at corners.

A cell is a part of the joint under uniform pressure and friction. Its point is its centroid, where
both have their resultant without a moment: what such cells carry, pressures on the joint carry, and
a load that is in balance by them is a bound from below (T95).
"""

from dataclasses import dataclass

import numpy as np
import shapely

from lacore.arrays import Floats, Geometries, Ints
from lacore.bodies.blocks3d.hulls import hull_corners
from lacore.errors import InputError, require_count, require_positive
from lacore.showing import Compact

_MOST = 32  # divisions: rows at the edge are 1/2048 of the width by then, and cells thousands
_CONVEX = 1e-9  # of the area of the hull: what a convex piece may lack by round-off


@dataclass(frozen=True, repr=False)
class Crushing(Compact):
    """Finite strength of joints in compression (T95).

    Attributes:
        strength: largest pressure of a joint, Pa, > 0.
        divisions: 1 <= n <= 32: of an edge of a joint from each of its corners to the middle. Of k
            corners there are ``k n^2`` cells, which are thin at the rim and wide inside. More of
            them carry more, up to what any pressure below the strength carries.

    Raises:
        InputError: a strength that is none, no such number of divisions.

    Example:
        >>> weak = la.Crushing(5e6, divisions=4)  # Pa
        >>> la.masonry3d.wall([[1, 1]], friction=0.6, crushing=weak).joints.weight.size
        192
    """

    strength: float
    divisions: int = 3

    def __post_init__(self) -> None:
        require_positive("Crushing.strength", self.strength)
        require_count("Crushing.divisions", self.divisions)
        if self.divisions > _MOST:
            why = f"{self.divisions**2} cells at each corner of each joint"
            raise InputError("Crushing.divisions", self.divisions, why, f"give at most {_MOST}")


def crushing_of(given: "float | Crushing | None") -> Crushing | None:
    """A strength in Pa as `Crushing`."""
    return given if given is None or isinstance(given, Crushing) else Crushing(given)


def cells(shared: Geometries, divisions: int, tolerance: float) -> tuple[Floats, Ints, Floats]:
    """Cells of plane joints.

    A convex piece is cut at its centroid and at the middles of its edges into one quadrangle a
    corner, and each of these by lines that are dense at the edges of the joint. Others are
    triangulated first.

    Args:
        shared: polygons, (J,), m. `divisions`: see `Crushing`. `tolerance`: m.

    Returns:
        centroids, (2, c), m; the number of the polygon of each, (c,), ascending; areas, (c,), m^2.
    """
    hull = shapely.convex_hull(shared)
    whole = shapely.area(shared) >= (1 - _CONVEX) * shapely.area(hull)
    triangles, of = shapely.get_parts(
        shapely.constrained_delaunay_triangles(shared[~whole]), return_index=True
    )
    pieces = np.concatenate([shared[whole], triangles])
    owner = np.concatenate([np.flatnonzero(whole), np.flatnonzero(~whole)[of]])
    order = np.argsort(owner, kind="stable")
    pieces, owner = pieces[order], owner[order]
    place, piece = hull_corners(pieces, tolerance)
    count = np.bincount(piece, minlength=pieces.size)
    begin = (np.cumsum(count) - count)[piece]
    behind = np.arange(piece.size) - begin
    after = begin + (behind + 1) % count[piece]
    before = begin + (behind - 1) % count[piece]
    middle = shapely.get_coordinates(shapely.centroid(pieces)).T[:, piece]
    kites = np.stack([place, (place + place[:, after]) / 2, middle, (place + place[:, before]) / 2])
    grid = (np.arange(divisions + 1) / divisions) ** 2  # dense at the edges
    s, t = np.meshgrid(grid, grid, indexing="ij")
    shape = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t])
    nodes = np.einsum("kxm,kij->xmij", kites, shape)
    a, b, c, d = (
        nodes[:, :, rows, columns]
        for rows, columns in (
            (slice(None, -1), slice(None, -1)),
            (slice(1, None), slice(None, -1)),
            (slice(1, None), slice(1, None)),
            (slice(None, -1), slice(1, None)),
        )
    )
    one, other = _twice(a, b, c), _twice(a, c, d)
    area = (one + other) / 2
    centre = (one * (a + b + c) + other * (a + c + d)) / (6 * area)
    number = np.repeat(owner[piece], divisions**2)
    return centre.reshape(2, -1), number, area.ravel()


def _twice(a: Floats, b: Floats, c: Floats) -> Floats:
    """Twice the areas of triangles."""
    u, v = b - a, c - a
    return np.asarray(u[0] * v[1] - u[1] * v[0])
