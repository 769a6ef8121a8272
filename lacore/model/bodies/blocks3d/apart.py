"""Search for three-dimensional blocks that overlap or touch, by their convex pieces."""

from collections.abc import Mapping, Sequence

import numpy as np
import shapely

from lacore.model.bodies.blocks.meeting_corners import linked_by_joints
from lacore.model.bodies.blocks3d.faces import boxes_that_meet
from lacore.model.bodies.blocks3d.joints import Joints3D
from lacore.model.bodies.blocks3d.pieces import kept_apart, largest_balls, shared_middles
from lacore.model.bodies.blocks3d.polyhedron import Polyhedron
from lacore.model.bodies.blocks3d.ranges import spread
from lacore.model.bodies.blocks3d.surface import axes_of
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError
from lacore.reporting.text import Quantity, text

_NEAR = 3.0  # in tolerances: places may be off a joint by its gap and by the least overlap


def require_apart(polyhedra: Mapping[str, Polyhedron], tolerance: float, field: str) -> None:
    """Raise `InputError` if blocks overlap by more than `tolerance` (m).

    The depth is the diameter of the largest ball within convex pieces of both; for a layer it is
    the thickness.
    """
    first, second, radius, centre = _common_balls(list(polyhedra.values()), tolerance)[:4]
    deep = np.flatnonzero(2 * radius > tolerance)
    if deep.size:
        names, worst = list(polyhedra), deep[0]
        raise InputError(
            field,
            (names[first[worst]], names[second[worst]]),
            text(
                "these blocks overlap at {}, {} deep (overlapping pairs: {})",
                Quantity(tuple(centre[:, worst]), "m", ".6g"),
                Quantity(2 * radius[worst], "m", ".3g"),
                deep.size,
            ),
            text(
                "move them apart; a slight overlap is within a tolerance above {}",
                Quantity(2 * radius.max(), "m", ".3g"),
            ),
        )


def meeting_alone(
    polyhedra: Sequence[Polyhedron], joints: Joints3D, tolerance: float
) -> tuple[Ints, Ints, Floats]:
    """Return the pairs of blocks that meet with an edge or a corner without other contact.

    They touch, have no joint, and no chain of joints around the place leads from one to the other.
    Neighbours across an edge of a wall have one: the blocks between them keep them apart.

    Args:
        polyhedra: all blocks.
        joints: their joints, with contact points at corners.
        tolerance: m.

    Returns:
        numbers of both blocks, (k,) each, and the middle of their contact, (3, k), m.
    """
    first, second, radius, centre, both = _common_balls(polyhedra, -tolerance)
    count = len(polyhedra)
    jointed = np.minimum(joints.slave, joints.master) * count
    jointed += np.maximum(joints.slave, joints.master)
    met = (2 * radius >= -tolerance) & ~np.isin(first * count + second, jointed)
    first, second = first[met], second[met]
    if not first.size:
        return first, second, centre[:, met]
    pieces = [piece for own in polyhedra for piece in own.pieces]
    place = shared_middles(pieces, both[0, met], both[1, met], tolerance, centre[:, met])
    meeting, joint = _joints_at(joints, place, _NEAR * tolerance)
    slave, master = joints.slave[joint], joints.master[joint]
    alone = np.flatnonzero(~linked_by_joints(meeting, slave, master, first, second))
    return first[alone], second[alone], place[:, alone]


def _joints_at(joints: Joints3D, place: Floats, reach: float) -> tuple[Ints, Ints]:
    """Return the numbers of places (3, k) and of joints within `reach` (m), pair by pair."""
    begin = np.flatnonzero(np.diff(joints.joint, prepend=-1))
    ends = [np.zeros((3, 0))] * 2
    if begin.size:
        ends = [f.reduceat(joints.points, begin, axis=1) for f in (np.minimum, np.maximum)]
    low, high = (np.concatenate([own, place], axis=1) for own in ends)
    joint, meeting = boxes_that_meet(low, high, reach)
    across = (joint < joints.count) & (meeting >= joints.count)
    joint, meeting = joint[across], meeting[across] - joints.count
    one, two = axes_of(joints.normal)
    flat = [np.sum(axis[:, joints.joint] * joints.points, axis=0) for axis in (one, two)]
    rings = shapely.linearrings(np.stack(flat, axis=1), indices=joints.joint)
    own = place[:, meeting]
    beside = shapely.distance(
        shapely.polygons(rings)[joint],
        shapely.points(np.sum(one[:, joint] * own, axis=0), np.sum(two[:, joint] * own, axis=0)),
    )
    arm = own - joints.points[:, begin[joint]]
    height = np.abs(np.sum(joints.normal[:, joint] * arm, axis=0))
    near = np.maximum(beside, height) <= reach
    return meeting[near], joint[near]


def _common_balls(
    blocks: Sequence[Polyhedron], depth: float
) -> tuple[Ints, Ints, Floats, Floats, Ints]:
    """Return the pairs of blocks that may overlap by more than `depth` (m; < 0: a distance).

    Returns:
        numbers of both, (k,) each, sorted; radii (k,) and centres (3, k), m, of the largest balls
        in convex pieces of both; the numbers of these pieces among all, (2, k).
    """
    corners = [own.box for own in blocks]
    low, high = (np.stack([box[end] for box in corners], axis=1) for end in (0, 1))
    first, second = boxes_that_meet(low, high, -depth)
    left = ~kept_apart([own.hull for own in blocks], first, second, depth)
    first, second = first[left], second[left]
    order = np.lexsort((second, first))
    first, second = first[order], second[order]

    pieces = [piece for own in blocks for piece in own.pieces]
    owner = np.repeat(np.arange(len(blocks)), [len(own.pieces) for own in blocks])
    one, row = spread(owner, first, len(blocks))
    other, again = spread(owner, second[row], len(blocks))
    one, pair = one[again], row[again]
    left = ~kept_apart(pieces, one, other, depth)
    one, other, pair = one[left], other[left], pair[left]
    both = [(pieces[i], pieces[j]) for i, j in zip(one.tolist(), other.tolist(), strict=True)]
    radius, centre = largest_balls(both)
    order = np.lexsort((-radius, pair))
    best = order[np.flatnonzero(np.diff(pair[order], prepend=-1))]
    pair = pair[best]
    return first[pair], second[pair], radius[best], centre[:, best], np.stack([one, other])[:, best]
