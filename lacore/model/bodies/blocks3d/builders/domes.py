"""Axisymmetric domes, cut into blocks by meridians and by cones about their centre."""

from __future__ import annotations

from math import pi

import numpy as np

from lacore.model.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.model.bodies.blocks3d.crushing import Crushing
from lacore.model.bodies.blocks3d.polyhedron import Polyhedron
from lacore.model.materials.friction import Friction
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError, is_number, require_count, require_positive


def dome(
    meridians: int,
    rings: int,
    radius: float,
    thickness: float,
    oculus: float,
    friction: float | Friction,
    springing: float = pi / 2,
    bond: bool = False,
    base: bool = True,
    crushing: float | Crushing | None = None,
) -> BlockAssembly3D:
    """Return a spherical dome about the z axis, with its centre at the origin.

    Blocks are named ``r1m1`` (ring from the springing up, place around). Beds go through the
    centre; between two meridians all faces are plane: chords in place of circles. In bond, a block
    extends over two such sectors, shifted by one from ring to ring: its beds and its inner and
    outer faces have two facets (T70).

    Args:
        meridians: number of blocks of a ring, at least 3.
        rings: number of rings.
        radius: radius of the sphere halfway between the inner and the outer corners, m.
        thickness: m, below twice the radius.
        oculus: angle at the centre from the axis to the topmost bed, rad.
        friction: law of all joints. `crushing`: their strength in compression, Pa, if finite.
        springing: angle from the axis to the lowest bed, rad; pi/2 is a hemisphere.
        bond: whether head joints of neighbouring rings are shifted by half a block.
        base: whether blocks ``base1``, ``base2``, ... lie below the lowest ring, one per block and
            of the same size, for supports.

    Raises:
        InputError: numbers that do not form a dome; anything that `BlockAssembly3D` rejects.

    Example:
        >>> dome = la.masonry3d.dome(6, 2, radius=1.0, thickness=0.2, oculus=0.3, friction=0.6)
        >>> len(dome.names)
        18
    """
    _require_dome(meridians, rings, radius, thickness, oculus, springing)
    sectors = 2 if bond else 1
    around = 2 * pi * np.arange(meridians * sectors) / (meridians * sectors)
    polar = np.linspace(springing, oculus, rings + 1)
    beds = [*polar, *([2 * polar[0] - polar[1]] if base else [])]
    shells = radius + thickness * np.array([-0.5, 0.5])
    grid = {number: _bed(shells, angle, around) for number, angle in enumerate(beds)}
    blocks = {}
    for ring in range(rings):
        first = ring % sectors
        for place in range(meridians):
            own = [(first + sectors * place + k) % around.size for k in range(sectors + 1)]
            blocks[f"r{ring + 1}m{place + 1}"] = _block(grid[ring], grid[ring + 1], own)
    if base:
        for place in range(meridians):
            own = [(sectors * place + k) % around.size for k in range(sectors + 1)]
            blocks[f"base{place + 1}"] = _block(grid[rings + 1], grid[0], own)
    return BlockAssembly3D(blocks, friction, crushing=crushing)


def _require_dome(
    meridians: int, rings: int, radius: float, thickness: float, oculus: float, springing: float
) -> None:
    """Raise `InputError` where numbers make no dome; they are those of `dome`."""
    require_count("dome.meridians", meridians)
    require_count("dome.rings", rings)
    require_positive("dome.radius", radius)
    require_positive("dome.thickness", thickness)
    if meridians < 3:
        raise InputError("dome.meridians", meridians, "no ring closes", "give at least 3")
    if thickness >= 2 * radius:
        raise InputError("dome.thickness", thickness, "more than the radius", "give less")
    if not (is_number(springing) and 0 < springing <= 3 * pi / 4):
        raise InputError("dome.springing", springing, "no springing", "give 0 < angle <= 3 pi/4")
    if not (is_number(oculus) and 0 < oculus < springing):
        fix = "give an angle (rad) above 0 and below the springing: a ring needs a hole"
        raise InputError("dome.oculus", oculus, "no oculus", fix)


def _bed(shells: Floats, polar: float, around: Floats) -> Floats:
    """Return the corners of a bed, inside and outside, (2, stations, 3), m."""
    flat = np.stack(
        [
            np.sin(polar) * np.cos(around),
            np.sin(polar) * np.sin(around),
            np.full_like(around, np.cos(polar)),
        ],
        axis=-1,
    )
    return np.asarray(shells[:, None, None] * flat)


def _block(low: Floats, high: Floats, stations: list[int]) -> Polyhedron:
    """Return the block between two beds, over the sectors between stations around."""
    k = len(stations)
    points = np.concatenate([bed[side, stations] for bed in (low, high) for side in (0, 1)])
    inner, outer, above, beyond = (np.arange(k) + n * k for n in range(4))
    faces = [
        (inner[0], outer[0], beyond[0], above[0]),
        (inner[-1], outer[-1], beyond[-1], above[-1]),
    ]
    for i in range(k - 1):
        for one, other in ((inner, outer), (above, beyond), (inner, above), (outer, beyond)):
            faces.append((one[i], one[i + 1], other[i + 1], other[i]))
    return Polyhedron(points, faces)
