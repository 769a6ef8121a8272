"""Corners of blocks that meet at a place, and the motions that make them overlap.

At a place where corners of two blocks meet, each block fills a sector. A relative velocity v of the
first against the second makes the sectors overlap unless it lies in half-planes ``n.v >= 0``, where
n are the normals of edges there, from the second block into the first:

- both sectors convex: one half-plane is sufficient, of any edge with the other block entirely on
  its far side (a line that separates the two). Where the blocks share a face, that of the face is
  the only one, and the joint enforces it. Where they touch at the corner alone there are two, and
  no normal: the admissible motions are not convex, and no contact law is defined.
- one sector reentrant (above 180 degrees), the other block's corner in it: both of its edges.

Contact at corners is therefore not modelled. The mechanism is checked instead: a velocity that
makes no corners overlap is also admissible with such contact, with zero reactions at corners; one
that does is not a mechanism.
"""

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from lacore.model.bodies.blocks.joints import Joints
from lacore.model.bodies.blocks.polygons import BlockEdges
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.showing import Compact

_NEAR = 3.0  # in tolerances: corners may be off a joint by its gap and by the least overlap


@dataclass(frozen=True, eq=False, repr=False)
class Meetings(Compact):
    """Corners of two blocks each that meet, where joints alone do not keep them apart.

    Attributes:
        place: m, (2, k).
        first, second: block numbers, (k,).
        normal: normals of the edges at the two corners, from the second block into the first, (2,
            4, k).
        counted: which of them count, (4, k): those that separate the two, or both of a reentrant
            corner.
        reentrant: whether all that count are required, and not one of them, (k,).
        linked: whether a chain of joints that end there links the two blocks, (k,).
    """

    place: Floats
    first: Ints
    second: Ints
    normal: Floats
    counted: Bools
    reentrant: Bools
    linked: Bools

    @property
    def count(self) -> int:
        """Number of meetings."""
        return self.first.size

    def opening(self, relative: Floats) -> Floats:
        """Return the opening speeds of the corners, (k,), m/s; below 0 they overlap.

        Args:
            relative: velocities of the first block against the second there, (2, k).
        """
        along = np.einsum("aek,ak->ek", self.normal, relative)
        every = np.where(self.counted, along, np.inf).min(axis=0)
        one = np.where(self.counted, along, -np.inf).max(axis=0)
        return np.asarray(np.where(self.reentrant, every, one))


def meetings(edges: BlockEdges, joints: Joints, tolerance: float) -> Meetings:
    """Return where corners of two blocks meet that joints alone do not keep apart.

    Args:
        edges: edges of all outlines, each block's in order around it; their starts are the corners.
        joints: joints of all blocks.
        tolerance: m.
    """
    before = _before(edges)
    points = shapely.points(edges.start.T)
    i, j = shapely.STRtree(points).query(points, predicate="dwithin", distance=2 * tolerance)
    pair = edges.block[i] < edges.block[j]
    i, j = i[pair], j[pair]
    place = (edges.start[:, i] + edges.start[:, j]) / 2

    turn = _cross(edges.normal[:, before], edges.normal)
    flat = _NEAR * tolerance
    counted, normal = [], []
    for own, other, sign in ((i, j, -1.0), (j, i, 1.0)):
        neighbours = edges.start[:, before[other]], edges.end[:, other]
        for edge in (before[own], own):
            away = [
                np.sum((point - edges.start[:, own]) * edges.normal[:, edge], axis=0)
                for point in neighbours
            ]
            counted.append(np.minimum(*away) >= -flat)
            normal.append(sign * edges.normal[:, edge])
    hollow = np.stack([turn[i] < 0, turn[j] < 0])  # clockwise: more than 180 degrees
    reentrant = np.asarray(hollow.any(axis=0))
    own = np.repeat(hollow, 2, axis=0)
    linked, jointed = _links(edges, joints, place, i, j, tolerance)
    kept = reentrant | ~jointed
    return Meetings(
        place=place[:, kept],
        first=edges.block[i][kept],
        second=edges.block[j][kept],
        normal=np.stack(normal, axis=1)[:, :, kept],
        counted=np.where(reentrant, own, np.stack(counted))[:, kept],
        reentrant=reentrant[kept],
        linked=linked[kept],
    )


def _before(edges: BlockEdges) -> Ints:
    """Return the edge of the same block that ends where each edge starts, (n,)."""
    number = np.arange(edges.block.size)
    before = number - 1
    first = np.flatnonzero(np.diff(edges.block, prepend=-1))
    before[first] = np.append(first[1:], number.size) - 1
    return before


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[0] * b[1] - a[1] * b[0])


def _links(
    edges: BlockEdges, joints: Joints, place: Floats, i: Ints, j: Ints, tolerance: float
) -> tuple[Bools, Bools]:
    """Return whether joints at the place link the two blocks in a chain, and if one joint does."""
    lines = shapely.linestrings(np.stack([joints.start.T, joints.end.T], axis=1))
    meeting, joint = shapely.STRtree(lines).query(
        shapely.points(place.T), predicate="dwithin", distance=_NEAR * tolerance
    )
    first, second = edges.block[i], edges.block[j]
    slave, master = joints.slave[joint], joints.master[joint]  # The slave comes last.
    count = int(edges.block.max(initial=0)) + 1
    met = (np.arange(i.size) * count + first) * count + second
    jointed = np.isin(met, (meeting * count + master) * count + slave)
    return linked_by_joints(meeting, slave, master, first, second), jointed


def linked_by_joints(meeting: Ints, slave: Ints, master: Ints, first: Ints, second: Ints) -> Bools:
    """Return whether a chain of joints around each meeting links its two blocks.

    Args:
        meeting: The meeting that each joint is at, (q,); a joint may be at several.
        slave: Block numbers of these joints, (q,).
        master: Block numbers of these joints, (q,).
        first: Block numbers of the meetings, (k,).
        second: Block numbers of the meetings, (k,).
    """
    count = max(int(own.max(initial=0)) for own in (slave, master, first, second)) + 1
    number = np.arange(first.size)
    ends = ((meeting, slave), (meeting, master), (number, first), (number, second))
    keys = np.concatenate([where * count + block for where, block in ends])
    nodes, label = np.unique(keys, return_inverse=True)
    slave, master, one, other = np.split(label, np.cumsum([slave.size, master.size, first.size]))
    graph = coo_matrix((np.ones(slave.size), (slave, master)), shape=(nodes.size, nodes.size))
    part = connected_components(graph, directed=False)[1] if nodes.size else label
    return np.asarray(part[one] == part[other])
