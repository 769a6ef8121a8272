"""Joints that crush: limited pressure in cells, in place of points at corners.

A cell is a part of the joint under uniform pressure and friction. Its point is its centroid, where
both have their resultant without a moment. Pressures on the joint can carry what such cells carry,
so a load that they balance is a lower bound. With its strength at its corners instead, a cell
carries more than any pressure does (T95).
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from lacore.model.bodies.blocks3d.hulls import hull_corners
from lacore.numerics.arrays import Floats, Geometries, Ints
from lacore.reporting.errors import InputError, require_count, require_known, require_positive
from lacore.reporting.showing import Compact

# limit of divisions: rows at the edge are then 1/2048 of the width, and there are thousands of
# cells
_MOST = 32
_SAME = 1e-10  # by the extent: corners of neighbours that are one point
_CONVEX = 1e-9  # by the area of the hull: area that a convex piece may lack by round-off


@dataclass(frozen=True, eq=False, repr=False)
class Cells(Compact):
    """Convex parts of joints.

    Attributes:
        corners: corners of one cell after the other, in order around it, (3, k), m.
        cell: number of the cell of each corner, (k,), ascending.
        joint: joint of each cell, (c,), ascending.
    """

    corners: Floats
    cell: Ints
    joint: Ints

    @cached_property
    def _triangles(self) -> tuple[Ints, Ints, Ints, Floats]:
        """Corners of triangles from the first of each cell on, and areas, (t,) each."""
        first = np.searchsorted(self.cell, self.cell)
        second = np.arange(self.cell.size)
        inside = (second > first) & (np.diff(self.cell, append=-1) == 0)
        first, second = first[inside], second[inside]
        a, b, c = (self.corners[:, own] for own in (first, second, second + 1))
        area = np.linalg.norm(np.cross(b - a, c - a, axis=0), axis=0) / 2
        return first, second, second + 1, area

    @property
    def area(self) -> Floats:
        """Areas, (c,), m^2."""
        first, *_, area = self._triangles
        return np.bincount(self.cell[first], area, self.joint.size).astype(np.float64)

    @property
    def centroid(self) -> Floats:
        """Centroids, (3, c), m."""
        *corners, area = self._triangles
        middle = np.mean([self.corners[:, own] for own in corners], axis=0)
        cell = self.cell[corners[0]]
        first = np.stack([np.bincount(cell, area * own, self.joint.size) for own in middle])
        return np.asarray(first / self.area)

    @property
    def corner_area(self) -> Floats:
        """Area of each corner, a third of its triangles, (k,), m^2."""
        *corners, area = self._triangles
        shares = np.bincount(np.concatenate(corners), np.tile(area / 3, 3), self.cell.size)
        return shares.astype(np.float64)


@dataclass(frozen=True, repr=False)
class Crushing(Compact):
    """Finite strength of joints in compression (T95).

    Attributes:
        strength: largest pressure of a joint, Pa, > 0.
        divisions: number n of divisions of an edge of a joint from each of its corners to the
            middle, 1 to 32. A joint with k corners has ``k n^2`` cells, thin at the rim and wide
            inside. More cells carry more, up to the limit for any pressure below the strength.
        side: ``below``: uniform pressure in cells, which carries at most as much as the joint;
            ``above``: the strength of cells at their corners, which carries at least as much.
        cells: cells instead of those by divisions, as used by `lacore.crushing_bracket`.

    Raises:
        InputError: an invalid strength, number of divisions, or side.

    Example:
        >>> weak = la.Crushing(5e6, divisions=4)  # Pa
        >>> la.masonry3d.wall([[1, 1]], friction=0.6, crushing=weak).joints.weight.size
        192
    """

    strength: float
    divisions: int = 3
    side: str = "below"
    cells: Cells | None = None

    def __post_init__(self) -> None:
        require_positive("Crushing.strength", self.strength)
        require_count("Crushing.divisions", self.divisions)
        require_known("Crushing.side", self.side, ("below", "above"))
        if self.divisions > _MOST:
            why = f"{self.divisions**2} cells at each corner of each joint"
            raise InputError("Crushing.divisions", self.divisions, why, f"give at most {_MOST}")


def crushing_of(given: "float | Crushing | None") -> Crushing | None:
    """Return a strength in Pa as `Crushing`."""
    return given if given is None or isinstance(given, Crushing) else Crushing(given)


def cells(shared: Geometries, divisions: int, tolerance: float) -> tuple[Floats, Ints]:
    """Return the cells of plane joints.

    A convex piece is cut at its centroid and at the middles of its edges into one quadrangle per
    corner, and each of these by lines that are dense at the edges of the joint. Others are
    triangulated first.

    Args:
        shared: polygons of the joints, (J,), m. `divisions`: see `Crushing`. `tolerance`: m.

    Returns:
        corners, (2, c, 4), m, counterclockwise; the number of the polygon of each, (c,), ascending.
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
    ends = slice(None, -1), slice(1, None)
    around = ((0, 0), (1, 0), (1, 1), (0, 1))
    corners = np.stack([nodes[:, :, ends[i], ends[j]] for i, j in around], axis=-1)
    return corners.reshape(2, -1, 4), np.repeat(owner[piece], divisions**2)


def points_of(own: Cells, side: str) -> tuple[Floats, Ints, Floats]:
    """Return the contact points of cells: places, (3, m), m, the joint of each, (m,), and its area.

    The shape is (m,).
    """
    if side == "below":
        return own.centroid, own.joint, own.area
    joint = own.joint[own.cell]
    size = float(np.ptp(own.corners, axis=1).max(initial=0.0))
    key = np.column_stack([joint, np.round(own.corners.T / (_SAME * size))])
    _, first, point = np.unique(key, axis=0, return_index=True, return_inverse=True)
    area = np.bincount(point.ravel(), own.corner_area).astype(np.float64)
    return own.corners[:, first], joint[first], area
