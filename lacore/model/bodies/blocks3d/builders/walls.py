"""Walls, corners and stairs of rectangular blocks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lacore.model.bodies.blocks import masonry
from lacore.model.bodies.blocks.masonry import Rows
from lacore.model.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.model.bodies.blocks3d.builders.prisms import extruded, prism
from lacore.model.bodies.blocks3d.crushing import Crushing
from lacore.model.bodies.blocks3d.polyhedron import Polyhedron
from lacore.model.materials.friction import Friction
from lacore.reporting.errors import InputError, is_number, require_count, require_positive

Size = tuple[float, float, float]
_SIZE: Size = (0.4, 0.2, 0.175)


def wall(
    rows: Rows,
    friction: float | Friction,
    block: Size = _SIZE,
    base: bool = True,
    slices: int = 1,
    crushing: float | Crushing | None = None,
) -> BlockAssembly3D:
    """Return the wall of `lacore.masonry.running_bond` along x, from the origin.

    Blocks are named ``c1b1`` (course from the bottom, place from the left).

    Args:
        rows: courses, bottom first: widths in blocks, negative for openings; see
            `lacore.masonry.regular_bond` and `lacore.masonry.random_bond`.
        friction: law of all joints. `crushing`: their strength in compression, Pa, if finite.
        block: length (x), depth (y) and height (z) of a block, m.
        base: whether a block ``base`` lies below.
        slices: number of leaves of the wall, one behind the other, within the depth.

    Example:
        >>> wall = la.masonry3d.wall([[1, 1], [0.5, 1, 0.5]], friction=0.6)
        >>> len(wall.names)  # five, and their base
        6
    """
    length, depth, height = _size(block, "wall.block")
    plane = masonry.running_bond(rows, friction, (length, height), base)
    return extruded(plane, depth, slices, crushing)


def corner(
    blocks: tuple[int, int],
    courses: int,
    friction: float | Friction,
    block: Size = _SIZE,
    base: bool = True,
    crushing: float | Crushing | None = None,
) -> BlockAssembly3D:
    """Return two walls at a right angle, along x and y, in bond at the corner, the origin.

    In every other course the first block of the wall along x is at the corner, in the others that
    of the wall along y; the other wall begins behind it, so that head joints are shifted by the
    depth of a block. Blocks are named ``c1x1``, ``c1y1`` (course, wall, place).

    Args:
        blocks: lengths of the two walls from the corner on, in blocks.
        courses: number of courses.
        friction: law of all joints. `crushing`: their strength in compression, Pa, if finite.
        block: length, depth and height of a block, m; the depth is below the length.
        base: whether an L-shaped block ``base`` lies below.

    Example:
        >>> corner = la.masonry3d.corner(blocks=(2, 2), courses=2, friction=0.6)
        >>> len(corner.names)
        9
    """
    length, depth, height = _size(block, "corner.block")
    if not depth < length:
        fix = "give a depth below the length"
        raise InputError("corner.block", block, "head joints would lie above each other", fix)
    if not (isinstance(blocks, Sequence) and len(blocks) == 2):
        raise InputError("corner.blocks", blocks, "not two lengths", "give (4, 3)")
    for number in blocks:
        require_count("corner.blocks", number)
    require_count("corner.courses", courses)
    found = {}
    for course in range(courses):
        low = course * height
        for wall_, axis in enumerate("xy"):
            begin = 0.0 if course % 2 == wall_ else depth
            end = blocks[wall_] * length
            ends = np.append(np.arange(begin, end - 1e-9 * length, length), end)
            for place in range(ends.size - 1):
                along, across = (ends[place], ends[place + 1]), (0.0, depth)
                x, y = (along, across) if axis == "x" else (across, along)
                found[f"c{course + 1}{axis}{place + 1}"] = _box(x, y, (low, low + height))
    if base:
        wide, long = (number * length for number in blocks)
        outline = [
            (0.0, 0.0),
            (wide, 0.0),
            (wide, depth),
            (depth, depth),
            (depth, long),
            (0.0, long),
        ]
        found["base"] = _upright(outline, -height, 0.0)
    return BlockAssembly3D(found, friction, crushing=crushing)


def stairs(
    steps: int,
    going: float,
    rise: float,
    width: float,
    overlap: float,
    friction: float | Friction,
    bearing: float = 0.0,
    crushing: float | Crushing | None = None,
) -> BlockAssembly3D:
    """Return a straight flight of steps along x, each on the back of the one below.

    Steps are named ``step1``, ``step2``, ...; the first lies on ``base``, the last leans on
    ``landing``, a block behind it. Built into a wall, the side y < 0 of each step lies between two
    blocks of it, ``below2`` (the first one has the base there) and ``above2``.

    Args:
        steps: number of steps.
        going: horizontal distance of steps, m. `rise`: their height, m.
        width: width of the flight along y, m.
        overlap: overlap of a step with the next one, along x, m.
        friction: law of all joints. `crushing`: their strength in compression, Pa, if finite.
        bearing: depth of steps in the wall, m; 0 for a free flight.

    Raises:
        InputError: numbers that do not form stairs; anything that `BlockAssembly3D` rejects.

    Example:
        >>> stairs = la.masonry3d.stairs(
        ...     steps=3, going=0.3, rise=0.18, width=1.0, overlap=0.05, friction=0.6
        ... )
        >>> len(stairs.names)
        5
    """
    require_count("stairs.steps", steps)
    for name, value in (("going", going), ("rise", rise), ("width", width), ("overlap", overlap)):
        require_positive(f"stairs.{name}", value)
    if not (is_number(bearing) and bearing >= 0):
        raise InputError("stairs.bearing", bearing, "no depth", "give 0, or a length in m")
    if overlap >= going:
        raise InputError("stairs.overlap", overlap, "as long as the going", "give less")
    deep = going + overlap
    across = (-bearing, width)
    blocks = {"base": _box((0.0, deep), across, (-rise, 0.0))}
    for n in range(steps):
        x, z = n * going, n * rise
        blocks[f"step{n + 1}"] = _box((x, x + deep), across, (z, z + rise))
        if bearing > 0:
            wall_, up = (-bearing, 0.0), (z + rise, z + 2 * rise)
            blocks[f"above{n + 1}"] = _box((x, x + going), wall_, up)
            if n > 0:
                under = (x + overlap, x + deep)
                blocks[f"below{n + 1}"] = _box(under, wall_, (z - rise, z))
    x, z = steps * going + overlap, steps * rise
    blocks["landing"] = _box((x, x + deep), across, (z - rise, z))
    return BlockAssembly3D(blocks, friction, crushing=crushing)


def _size(block: Size, field: str) -> Size:
    given = isinstance(block, Sequence | np.ndarray) and len(block) == 3
    if not given or not all(is_number(own) and own > 0 for own in block):
        raise InputError(field, block, "not a block", "give (length, depth, height) in m")
    length, depth, height = block
    return length, depth, height


def _box(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]) -> Polyhedron:
    outline = [(x[0], z[0]), (x[1], z[0]), (x[1], z[1]), (x[0], z[1])]
    return prism(outline, *y)


def _upright(outline: Sequence[tuple[float, float]], low: float, high: float) -> Polyhedron:
    """Return the prism over a polygon of (x, y), m, between two levels of z, m."""
    lying = prism(outline, low, high)
    return Polyhedron(lying.vertices[:, [0, 2, 1]], lying.faces)
