"""Corners that rest on edges without a shared segment, which are not modelled as contact."""

import numpy as np
import shapely

from lacore.model.bodies.blocks.joints import Joints
from lacore.model.bodies.blocks.polygons import BlockEdges
from lacore.model.bodies.touching import Edges, Shared
from lacore.numerics.arrays import Floats, Ints

_NEAR = 3  # in tolerances: a segment may be off a corner by its gap and by the least overlap


def resting_corners(
    edges: BlockEdges, joints: Joints, tolerance: float
) -> tuple[Floats, Ints, Ints]:
    """Return the corners inside an edge of another block, away from the joints of the two.

    A corner at an end of the edge, where corners meet, is not included: see
    `lacore.model.bodies.blocks.meeting_corners`.

    Args:
        edges: edges of all outlines; their starts are the corners.
        joints: joints of all blocks.
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
    near, joint = shapely.STRtree(lines).query(
        points[corner], predicate="dwithin", distance=_NEAR * tolerance
    )
    pair = np.sort(np.stack([joints.slave, joints.master]), axis=0)[:, joint]
    own = np.sort(np.stack([here, there]), axis=0)[:, near]
    jointed = near[pair[0] * blocks + pair[1] == own[0] * blocks + own[1]]
    loose = np.setdiff1d(np.arange(corner.size), jointed)
    return edges.start[:, corner[loose]], here[loose], there[loose]


def loose_corners(first: Edges, second: Edges, shared: Shared, tolerance: float) -> Floats:
    """Return the ends of edges of one side of an interface that rest on the other side.

    Those on its segments are left out.

    Args:
        first, second: edges of both sides.
        shared: the segments that they share.
        tolerance: m.

    Returns:
        places (2, k).
    """
    lines = shapely.linestrings(np.stack([shared.start.T, shared.end.T], axis=1))
    loose = [np.zeros((2, 0))]
    for own, other in ((first, second), (second, first)):
        places = np.unique(np.concatenate([own.start, own.end], axis=1), axis=1)
        on, near = (
            shapely.STRtree(geometry).query(
                shapely.points(places.T), predicate="dwithin", distance=reach
            )[0]
            for geometry, reach in ((other.lines, tolerance), (lines, _NEAR * tolerance))
        )
        loose.append(places[:, np.setdiff1d(on, near)])
    return np.concatenate(loose, axis=1)
