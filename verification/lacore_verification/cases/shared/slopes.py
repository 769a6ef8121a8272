"""A slope of height 1 with its toe at the origin: mesh and supports of the cases that have one."""

from math import radians, tan

import numpy as np
from skfem import MeshTri

import lacore as la

MESHES = {
    "coarse": {"nx": 4, "ny": 3, "ratio": 3.0},
    "medium": {"nx": 16, "ny": 12, "ratio": 6.0},
    "fine": {"nx": 45, "ny": 34, "ratio": 12.0},
}
"""Levels of both cases."""
BEFORE, BELOW, BEHIND = 0.6, 0.5, 1.8  # of the soil: in front of the toe, below it, and to its end


def mesh_of_slope(nx: int, ny: int, ratio: float, slope: float, level: float = 0.0) -> MeshTri:
    """Triangles, graded towards the toe; boundaries `left`, `right`, `bottom`, and `ground`.

    Args:
        nx, ny: cells of the rectangle that it is made of.
        ratio: of cells far from the toe to those at it.
        slope: angle of the face, degrees.
        level: height at which there are vertices all along, for water.
    """
    block = la.meshes.rectangle(
        x=(-BEFORE, BEHIND),
        y=(-BELOW, 1),
        nx=nx,
        ny=ny,
        grade_x=(0.0, ratio),
        grade_y=(0.0, ratio),
    )
    x, y = block.p[:, block.t].mean(axis=1)
    cut = block.remove_elements(np.flatnonzero((x < 0) & (y > 0)))
    x, y = cut.p
    rows = np.unique(y[cut.facets[:, cut.boundaries["right"]]])
    y = np.where(y == rows[np.argmin(np.abs(rows - level))], level, y)
    # The face is inclined, and the soil behind it less and less towards the far end.
    leant = x + np.maximum(y, 0.0) / tan(radians(slope)) * np.maximum(1 - x / BEHIND, 0.0)
    sides = ("left", "right", "bottom")
    names = {name: np.asarray(cut.boundaries[name]) for name in sides}
    names["ground"] = np.setdiff1d(cut.boundary_facets(), np.concatenate(list(names.values())))
    return MeshTri(np.stack([leant, y]), cut.t).with_boundaries(names)


def held() -> "list[la.Fix]":
    """Return supports without motion, far from the mechanism."""
    return [la.Fix("soil", side) for side in ("bottom", "left", "right")]
