"""Corners of blocks that rest on edges of others where no joint is: contacts nobody models."""

import numpy as np
import shapely

from lacore.arrays import Floats, Ints
from lacore.joints import Joints
from lacore.polygons import BlockEdges


def resting_corners(
    edges: BlockEdges, joints: Joints, tolerance: float
) -> tuple[Floats, Ints, Ints]:
    """Corners inside an edge of another block, away from the joints of the two.

    A corner at an end of the edge, where blocks meet in a cross, is none.

    Args:
        edges: of all outlines; their starts are the corners.
        joints: of all blocks.
        tolerance: m.

    Returns:
        places (2, k), the blocks of the corners (k,), and the blocks that they rest on (k,).
    """
    points = shapely.points(edges.start.T)
    corner, edge = shapely.STRtree(edges.lines).query(
        points, predicate="dwithin", distance=tolerance
    )
    ends = np.minimum(
        np.linalg.norm(edges.start[:, corner] - edges.start[:, edge], axis=0),
        np.linalg.norm(edges.start[:, corner] - edges.end[:, edge], axis=0),
    )
    inside = (edges.block[corner] != edges.block[edge]) & (ends > 2 * tolerance)
    corner, edge = corner[inside], edge[inside]
    here, there = edges.block[corner], edges.block[edge]

    blocks = int(edges.block.max(initial=0)) + 1
    lines = shapely.linestrings(np.stack([joints.start.T, joints.end.T], axis=1))
    # A joint lies on its slave, and may be off the corner by the gap and by the least overlap.
    near, joint = shapely.STRtree(lines).query(
        points[corner], predicate="dwithin", distance=3 * tolerance
    )
    pair = np.sort(np.stack([joints.slave, joints.master]), axis=0)[:, joint]
    own = np.sort(np.stack([here, there]), axis=0)[:, near]
    jointed = near[pair[0] * blocks + pair[1] == own[0] * blocks + own[1]]
    loose = np.setdiff1d(np.arange(corner.size), jointed)
    return edges.start[:, corner[loose]], here[loose], there[loose]
