"""Blocks in space that lie in each other: found, and refused."""

from collections.abc import Mapping, Sequence

import numpy as np

from lacore.arrays import Bools, Floats, Ints
from lacore.bodies.blocks3d.faces import boxes_that_meet, spread
from lacore.bodies.blocks3d.pieces import largest_balls
from lacore.bodies.blocks3d.polyhedron import Polyhedron
from lacore.errors import InputError
from lacore.showing import placed


def require_apart(polyhedra: Mapping[str, Polyhedron], tolerance: float, field: str) -> None:
    """Raise `InputError` where blocks lie in each other by more than `tolerance` (m).

    How deep is the diameter of the largest ball that convex pieces of both contain: of a layer its
    thickness.
    """
    blocks = list(polyhedra.values())
    first, second = _unseparated(blocks, tolerance)
    radius, centre = _shared_balls(blocks, first, second)
    deep = np.flatnonzero(2 * radius > tolerance)
    if deep.size:
        names, worst = list(polyhedra), deep[0]
        raise InputError(
            field,
            (names[first[worst]], names[second[worst]]),
            f"these blocks overlap at {placed(centre[:, worst])} m, {2 * radius[worst]:.3g} m deep"
            f" (overlapping pairs: {deep.size})",
            "move them apart",
        )


def touched_by(
    polyhedra: Sequence[Polyhedron], which: Ints, tolerance: float
) -> tuple[Ints, Ints, Floats]:
    """What blocks touch, if only with a corner or an edge.

    Args:
        polyhedra: all blocks.
        which: numbers of those that are asked for.
        tolerance: m.

    Returns:
        the number of each that touches another, (k,), ascending, that of the other, and the place,
        (3, k), m.
    """
    low, high = _boxes(polyhedra)
    first, second = boxes_that_meet(low, high, tolerance)
    first, second = np.concatenate([first, second]), np.concatenate([second, first])
    order = np.lexsort((second, first))
    order = order[np.isin(first[order], which)]
    first, second = first[order], second[order]
    radius, centre = _shared_balls(polyhedra, first, second)
    near = np.flatnonzero(2 * radius >= -tolerance)
    _, once = np.unique(first[near], return_index=True)
    return first[near[once]], second[near[once]], centre[:, near[once]]


def _shared_balls(blocks: Sequence[Polyhedron], first: Ints, second: Ints) -> tuple[Floats, Floats]:
    """Radii (k,) and centres (3, k), m, of largest balls in convex pieces of both of a pair.

    Of two that are apart the radius is minus half the distance.
    """
    both = [
        (one.and_of(other), pair)
        for pair, (i, j) in enumerate(zip(first.tolist(), second.tolist(), strict=True))
        for one in blocks[i].pieces
        for other in blocks[j].pieces
    ]
    owner = np.array([pair for _, pair in both], dtype=np.int64)
    reach = np.array([own.radius for own in blocks])
    size = np.minimum(reach[first], reach[second])[owner]
    near = np.array([own.centroid for own in blocks]).T[:, first[owner]]
    radius, centre = largest_balls([common for common, _ in both], near, size)
    order = np.lexsort((-radius, owner))
    best = order[np.flatnonzero(np.diff(owner[order], prepend=-1))]
    return radius[best], centre[:, best]


def _boxes(blocks: Sequence[Polyhedron]) -> tuple[Floats, Floats]:
    """Lowest and highest corners of bounding boxes, (3, B) each, m."""
    corners = [own.box for own in blocks]
    return np.stack([low for low, _ in corners], 1), np.stack([high for _, high in corners], 1)


def _unseparated(blocks: Sequence[Polyhedron], tolerance: float) -> tuple[Ints, Ints]:
    """Pairs of blocks that the plane of no face of either keeps apart, to the tolerance."""
    low, high = _boxes(blocks)
    first, second = boxes_that_meet(low, high, -tolerance)
    order = np.lexsort((second, first))
    first, second = first[order], second[order]
    apart = _kept_apart(blocks, first, second, tolerance)
    apart |= _kept_apart(blocks, second, first, tolerance)
    return first[~apart], second[~apart]


def _kept_apart(blocks: Sequence[Polyhedron], own: Ints, other: Ints, tolerance: float) -> Bools:
    """Whether the plane of a face of the one has it on its inner and the other on its outer side.

    Returns:
        for each pair, (k,).
    """
    faces = np.repeat(np.arange(len(blocks)), [b.offset.size for b in blocks])
    corners = np.repeat(np.arange(len(blocks)), [len(b.vertices) for b in blocks])
    normal = np.concatenate([b.normal for b in blocks], axis=1)
    origin = np.mean([b.centroid for b in blocks], axis=0)
    points = np.concatenate([b.vertices for b in blocks]).T - origin[:, None]
    offset = np.concatenate([b.offset for b in blocks]) - origin @ normal

    def heights(face: Ints, block: Ints) -> tuple[Floats, Ints]:
        vertex, row = spread(corners, block, len(blocks))
        above = np.sum(normal[:, face[row]] * points[:, vertex], axis=0) - offset[face[row]]
        return above, np.flatnonzero(np.diff(row, prepend=-1))

    above, begin = heights(np.arange(faces.size), faces)
    outer = np.maximum.reduceat(above, begin) <= tolerance
    face, pair = spread(faces, own, len(blocks))
    face, pair = face[outer[face]], pair[outer[face]]
    apart = np.zeros(own.size, dtype=bool)
    if face.size:
        above, begin = heights(face, other[pair])
        np.logical_or.at(apart, pair, np.minimum.reduceat(above, begin) >= -tolerance)
    return apart
