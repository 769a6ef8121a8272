"""Rows of walls: positions of the head joints and openings of each course, in blocks.

A row is one course from left to right: widths, with the width of an opening negative.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from numbers import Integral

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.reporting.errors import (
    InputError,
    is_number,
    require_count,
    require_known,
    require_whole,
)

FIRST = ("full", "halves")
ROUND_OFF = 1e-9  # by the width of a row: sums of decimal widths agree to this
_JAMB = 0.25  # blocks: shortest block next to an opening or an end of a random wall


@dataclass(frozen=True)
class Opening:
    """A rectangular hole in a wall.

    Attributes:
        left, width: position of its left side and width, in blocks.
        sill, height: courses below it, and its height in courses.

    Example:
        >>> door = la.masonry.Opening(left=2, width=2, sill=0, height=3)
        >>> la.masonry.regular_bond(wide=6, courses=4, openings=[door])[0]
        [1.0, 1.0, -2.0, 1.0, 1.0]
    """

    left: float
    width: float
    sill: int
    height: int


def regular_bond(
    wide: int, courses: int, openings: Sequence[Opening] = (), first: str = "full"
) -> list[list[float]]:
    """Return the rows of a wall of whole blocks, shifted by half a block from course to course.

    Blocks at an opening are cut.

    Args:
        wide: width in blocks. `courses`: number of courses.
        openings: see `Opening`, `windows`.
        first: the lowest course: ``full`` blocks only, or ``halves`` at both ends.

    Raises:
        InputError: openings that leave the wall or overlap.

    Example:
        >>> la.masonry.regular_bond(wide=3, courses=2)
        [[1.0, 1.0, 1.0], [0.5, 1.0, 1.0, 0.5]]
    """
    require_count("regular_bond.wide", wide)
    require_count("regular_bond.courses", courses)
    require_known("regular_bond.first", first, FIRST)
    _require_holes("regular_bond.openings", openings, wide, courses)
    joints = {"full": np.arange(1.0, wide), "halves": np.arange(0.5, wide)}
    turn = FIRST.index(first)
    return [
        _row(joints[FIRST[(course + turn) % 2]], wide, _holes(openings, course), ROUND_OFF)
        for course in range(courses)
    ]


def windows(wide: int, courses: int, every: int) -> list[Opening]:
    """Return openings of one block by five courses, one in `every` blocks and twelve courses.

    They are placed like the opening of wall 3 of the literature, so below full courses of a
    `regular_bond` whose first course is full: two blocks corbel over each.

    Example:
        >>> openings = la.masonry.windows(wide=12, courses=12, every=6)
        >>> len(openings), openings[0]
        (2, Opening(left=2.5, width=1.0, sill=3, height=5))
    """
    require_count("windows.wide", wide)
    require_count("windows.courses", courses)
    require_count("windows.every", every)
    lefts = np.arange(every // 2 - 0.5, wide - 2, every)
    return [
        Opening(left, 1.0, sill, 5) for sill in range(3, courses - 6, 12) for left in lefts.tolist()
    ]


def random_bond(
    seed: int | np.random.Generator, wide: int, courses: int, openings: int = 0
) -> list[list[float]]:
    """Return the rows of a wall of random blocks with random openings.

    Every block rests on one below (or the base) and overlaps its head joints by at least 0.1
    blocks; a single lintel spans each opening and bears 0.25 blocks on either side. Doors reach
    down to the base.

    Args:
        seed: seed of the random numbers, or their generator.
        wide: width in blocks. `courses`: number of courses.
        openings: number of openings; each has a separate bay of at least 2.5 blocks, in a wall of
            at least three courses.

    Raises:
        InputError: a wall too small for its openings.

    Example:
        >>> rows = la.masonry.random_bond(seed=1, wide=4, courses=3)
        >>> [sum(row) for row in rows]
        [4.0, 4.0, 4.0]
    """
    if not isinstance(seed, np.random.Generator):
        require_whole("random_bond.seed", seed)
    require_count("random_bond.wide", wide)
    require_count("random_bond.courses", courses)
    if openings:
        require_count("random_bond.openings", openings)
    if openings and (wide < 2.5 * openings or courses < 3):
        raise InputError(
            "random_bond.openings",
            openings,
            f"they do not fit into {wide} blocks by {courses} courses",
            "give 2.5 blocks of width each, and 3 courses",
        )
    draw = np.random.default_rng(seed)
    holes = [
        _random_opening(draw, n * wide / openings, wide / openings, courses)
        for n in range(openings)
    ]
    rows, shift = [], draw.uniform()
    for course in range(courses):
        shift = (shift + draw.uniform(0.4, 0.6)) % 1.0
        joints = np.arange(-1.0, wide + 1.0) + shift
        joints += draw.uniform(-0.15, 0.15, joints.size)
        joints = joints[(joints > _JAMB) & (joints < wide - _JAMB)]
        for left, right in _holes(holes, course - 1):
            if (left, right) not in _holes(holes, course):
                joints = joints[(joints < left - _JAMB) | (joints > right + _JAMB)]
        rows.append(_row(joints, wide, _holes(holes, course), _JAMB))
    return rows


def _random_opening(draw: np.random.Generator, start: float, bay: float, courses: int) -> Opening:
    """Return an opening with piers of 0.75 blocks in the bay, and a course above it."""
    width = draw.uniform(0.8, min(2.0, bay - 1.5))
    sill = int(draw.integers(0, courses - 2, endpoint=True))
    height = int(draw.integers(1, courses - 1 - sill, endpoint=True))
    return Opening(draw.uniform(start + 0.75, start + bay - 0.75 - width), width, sill, height)


def _holes(openings: Sequence[Opening], course: int) -> list[tuple[float, float]]:
    """Return the left and right ends of the holes in a course."""
    return sorted(
        (hole.left, hole.left + hole.width)
        for hole in openings
        if hole.sill <= course < hole.sill + hole.height
    )


def _row(joints: Floats, wide: float, holes: list[tuple[float, float]], jamb: float) -> list[float]:
    """Return the widths of a course with given head joints, except those close to a hole.

    Joints closer than `jamb` to a hole are left out.
    """
    for left, right in holes:
        joints = joints[(joints < left - jamb) | (joints > right + jamb)]
    ends = np.unique(np.concatenate([[0.0, wide], joints, np.ravel(holes)]))
    middle = (ends[1:] + ends[:-1]) / 2
    sign = np.ones(middle.size)
    for left, right in holes:
        sign[(left < middle) & (middle < right)] = -1.0
    widths: list[float] = (sign * np.diff(ends)).tolist()
    return widths


def _require_holes(field: str, openings: Sequence[Opening], wide: int, courses: int) -> None:
    for hole in openings:
        if not isinstance(hole, Opening):
            raise InputError(field, hole, "not an opening", "give lacore.masonry.Opening")
        if not (is_number(hole.left) and is_number(hole.width)):
            raise InputError(
                field, hole, "its left and width are no numbers", "give both in blocks"
            )
        within = hole.left >= 0 and hole.left + hole.width <= wide and hole.width > 0
        whole = isinstance(hole.sill, Integral) and isinstance(hole.height, Integral)
        if not whole:
            raise InputError(field, hole, "it takes parts of courses", "give whole numbers")
        if not (within and hole.sill >= 0 and 0 < hole.height <= courses - hole.sill):
            raise InputError(
                field, hole, f"it leaves the wall of {wide} blocks by {courses} courses", "move it"
            )
    for course in range(courses):
        holes = _holes(openings, course)
        if any(right > left for (_, right), (left, _) in pairwise(holes)):
            raise InputError(
                field, holes, f"openings overlap in course {course + 1}", "move them apart"
            )
