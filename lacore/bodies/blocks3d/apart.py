"""Blocks in space that lie in each other, or touch: found by their convex pieces."""

from collections.abc import Mapping, Sequence

import numpy as np

from lacore.arrays import Floats, Ints
from lacore.bodies.blocks3d.faces import boxes_that_meet
from lacore.bodies.blocks3d.pieces import kept_apart, largest_balls
from lacore.bodies.blocks3d.polyhedron import Polyhedron
from lacore.bodies.blocks3d.ranges import spread
from lacore.errors import InputError
from lacore.showing import placed


def require_apart(polyhedra: Mapping[str, Polyhedron], tolerance: float, field: str) -> None:
    """Raise `InputError` where blocks lie in each other by more than `tolerance` (m).

    How deep is the diameter of the largest ball that convex pieces of both contain: of a layer its
    thickness.
    """
    first, second, radius, centre = _common_balls(list(polyhedra.values()), tolerance)
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
    first, second, radius, centre = _common_balls(polyhedra, -tolerance)
    near = np.flatnonzero(2 * radius >= -tolerance)
    own = np.concatenate([first[near], second[near]])
    other, ball = np.concatenate([second[near], first[near]]), np.concatenate([near, near])
    order = np.lexsort((other, own))
    order = order[np.isin(own[order], which)]
    _, once = np.unique(own[order], return_index=True)
    return own[order][once], other[order][once], centre[:, ball[order][once]]


def _common_balls(blocks: Sequence[Polyhedron], depth: float) -> tuple[Ints, Ints, Floats, Floats]:
    """Pairs of blocks that may be deeper in each other than `depth` (m; below 0: or that near).

    Returns:
        numbers of both, (k,) each, sorted; radii (k,) and centres (3, k), m, of the largest balls
        in convex pieces of both.
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
    return first[pair[best]], second[pair[best]], radius[best], centre[:, best]
