"""Builders of block assemblies: walls in running bond, stacks, arches, drawings."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np

from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks.bonds import ROUND_OFF, Opening, random_bond, regular_bond, windows
from lacore.model.bodies.blocks.drawings.drawn import DrawnBlocks, Layer
from lacore.model.bodies.blocks.drawings.reading import read
from lacore.model.bodies.blocks.fill import fill
from lacore.model.bodies.blocks.joints import JointFriction
from lacore.model.materials.friction import Friction
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import (
    InputError,
    is_number,
    is_plane_vector,
    require_count,
    require_positive,
    require_range,
)

__all__ = [
    "DrawnBlocks",
    "Layer",
    "Opening",
    "arch",
    "fill",
    "random_bond",
    "read",
    "rectangle",
    "regular_bond",
    "running_bond",
    "stack",
    "windows",
]
Rows = Sequence[Sequence[float]]


def rectangle(left: float, right: float, bottom: float, top: float) -> Floats:
    """Return the vertices (4, 2) of an upright rectangle, counterclockwise.

    Example:
        >>> la.masonry.rectangle(left=0, right=2, bottom=0, top=1).tolist()
        [[0, 0], [2, 0], [2, 1], [0, 1]]
    """
    return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])


def running_bond(
    rows: Rows,
    friction: float | Friction,
    block: tuple[float, float] = (0.4, 0.175),
    base: bool = True,
    joint_friction: JointFriction | None = None,
) -> BlockAssembly:
    """Return a wall from its courses, with its lower left corner at the origin.

    Blocks are named ``c1b1`` (course from the bottom, place from the left, openings not counted).

    Args:
        rows: courses, bottom first, each from left to right: widths in blocks, negative for
            openings: ``[1, .5, -1, .5, 1]``; see `regular_bond` and `random_bond`.
        friction: law of all joints; `joint_friction` for single pairs.
        block: width and height of a block, m.
        base: whether a block ``base`` of full width, one block high, lies below ``y = 0``.

    Raises:
        InputError: courses that differ in width, an empty course, a width of 0; anything that
            `BlockAssembly` rejects.

    Example:
        >>> wall = la.masonry.running_bond([[1, 1], [0.5, 1, 0.5], [1, 1]], friction=0.6)
        >>> len(wall.names)  # seven, and their base
        8
    """
    if not is_plane_vector(block) or min(block) <= 0:
        raise InputError("running_bond.block", block, "not a block", "give (width, height) in m")
    require_range("running_bond.block", *block)
    ends = _joints_of_courses(rows)
    wide, high = block
    bodies = {}
    if base:
        bodies["base"] = rectangle(0.0, ends[0][-1] * wide, -high, 0.0)
    for course, (row, x) in enumerate(zip(rows, ends, strict=True)):
        solid = [n for n, width in enumerate(row) if width > 0]
        for place, n in enumerate(solid, start=1):
            bodies[f"c{course + 1}b{place}"] = rectangle(
                x[n] * wide, x[n + 1] * wide, course * high, (course + 1) * high
            )
    return BlockAssembly(bodies, friction, joint_friction)


def _joints_of_courses(rows: Rows) -> list[Floats]:
    """Return the ends of all entries of each course, from 0 on, in blocks."""
    if not isinstance(rows, Sequence | np.ndarray) or not len(rows):
        raise InputError("running_bond.rows", rows, "there is no course", "give at least one")
    ends = []
    for course, row in enumerate(rows):
        where = f"running_bond.rows[{course}]"
        listed = isinstance(row, Sequence | np.ndarray) and len(row) > 0
        if not listed or not all(is_number(width) and abs(width) > 0 for width in row):
            raise InputError(where, row, "not widths", "give numbers != 0, openings below 0")
        require_range(where, row)
        ends.append(np.concatenate([[0.0], np.cumsum(np.abs(row))]))
        if abs(ends[-1][-1] - ends[0][-1]) > ROUND_OFF * ends[0][-1]:
            raise InputError(
                where,
                list(row),
                f"it is {ends[-1][-1]:g} blocks wide, the first course {ends[0][-1]:g}",
                "make all courses equally wide",
            )
    return ends


def stack(
    sizes: Sequence[tuple[float, float]],
    friction: float | Friction,
    joint_friction: JointFriction | None = None,
) -> BlockAssembly:
    """Return blocks "1", "2", ... on top of each other, centred over x = 0, on a block "base".

    Args:
        sizes: width and height of each block, m, bottom first; the base is as wide as the widest.
        friction: law of all joints; `joint_friction` for single pairs.

    Example:
        >>> la.masonry.stack([(1.0, 0.5), (0.8, 0.5)], friction=0.5).names
        ('base', '1', '2')
    """
    listed = isinstance(sizes, Sequence | np.ndarray) and len(sizes) > 0
    if not listed or not all(is_plane_vector(size) and min(size) > 0 for size in sizes):
        raise InputError("stack.sizes", sizes, "not blocks", "give [(width, height), ...] in m")
    half = np.array([width for width, _ in sizes]) / 2
    level = np.concatenate([[0.0], np.cumsum([height for _, height in sizes])])
    bodies = {"base": rectangle(-half.max(), half.max(), -level[1], 0.0)}
    for n in range(len(sizes)):
        bodies[str(n + 1)] = rectangle(-half[n], half[n], level[n], level[n + 1])
    return BlockAssembly(bodies, friction, joint_friction)


def arch(
    voussoirs: int,
    inner_radius: float,
    thickness: float,
    friction: float | Friction,
    embrace: float = pi,
    joint_friction: JointFriction | None = None,
) -> BlockAssembly:
    """Return a circular arch of equal voussoirs between springings "left" and "right".

    The voussoirs are named "1", "2", ... from left to right. The centre of the circles is the
    origin, and the arch is symmetric about x = 0. Joints are radial; the faces between them are
    chords. The springings are rectangles, `thickness` deep, on the outer sides of the first and
    last joint.

    Args:
        voussoirs: number of voussoirs.
        inner_radius: radius of the circle through the inner corners, m.
        thickness: length of a joint, m.
        friction: law of all joints; `joint_friction` for single pairs.
        embrace: angle of the arch at the centre, rad; pi is a semicircle.

    Example:
        >>> stones = la.masonry.arch(9, inner_radius=1.0, thickness=0.2, friction=0.6)
        >>> len(stones.names)  # nine, and their two springings
        11
    """
    require_count("arch.voussoirs", voussoirs)
    require_positive("arch.inner_radius", inner_radius)
    require_positive("arch.thickness", thickness)
    if not (is_number(embrace) and 0 < embrace / voussoirs < pi and embrace < 2 * pi):
        raise InputError(
            "arch.embrace", embrace, "not the angle of an arch", "give 0 < angle < 2 pi (rad)"
        )
    angle = pi / 2 + embrace * np.linspace(0.5, -0.5, voussoirs + 1)
    radial = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    inner, outer = inner_radius * radial, (inner_radius + thickness) * radial
    # A quarter turn before the first joint and after the last, away from the arch.
    beyond_left = thickness * radial[0] @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    beyond_right = thickness * radial[-1] @ np.array([[0.0, -1.0], [1.0, 0.0]])
    bodies = {
        "left": [inner[0], outer[0], outer[0] + beyond_left, inner[0] + beyond_left],
        "right": [inner[-1], outer[-1], outer[-1] + beyond_right, inner[-1] + beyond_right],
    }
    for n in range(voussoirs):
        bodies[str(n + 1)] = [inner[n], inner[n + 1], outer[n + 1], outer[n]]
    return BlockAssembly(bodies, friction, joint_friction)
