"""Arches and vaults of circular section: along y, or two crossing ones."""

from __future__ import annotations

from math import pi

import numpy as np

from lacore.model.bodies.blocks import masonry
from lacore.model.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.model.bodies.blocks3d.builders.prisms import extruded, prism
from lacore.model.bodies.blocks3d.crushing import Crushing
from lacore.model.bodies.blocks3d.polyhedron import Polyhedron
from lacore.model.materials.friction import Friction
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError, require_count, require_positive

_QUARTERS = ("+x", "+y", "-x", "-y")
_ROUND_OFF = 1e-12  # by the radius: sines and cosines of right angles


def arch(
    voussoirs: int,
    inner_radius: float,
    thickness: float,
    depth: float,
    friction: float | Friction,
    embrace: float = pi,
    slices: int = 1,
    crushing: float | Crushing | None = None,
) -> BlockAssembly3D:
    """Return the arch of `lacore.masonry.arch` in the plane of x and z, with a depth along y.

    Blocks are named "1", "2", ..., "left", "right", with several slices "1/1", "1/2", ...

    Args:
        voussoirs: number of voussoirs, from left to right.
        inner_radius: radius of the circle through the inner corners, m.
        thickness: length of a joint, m.
        depth: depth along y, m. `slices`: number of equal slices along y.
        friction: law of all joints. `crushing`: their strength in compression, Pa, if finite.
        embrace: angle of the arch at the centre, rad; pi is a semicircle.

    Example:
        >>> stones = la.masonry3d.arch(5, inner_radius=1.0, thickness=0.2, depth=0.5, friction=0.6)
        >>> len(stones.names)  # five, and their two springings
        7
    """
    plane = masonry.arch(voussoirs, inner_radius, thickness, friction, embrace)
    return extruded(plane, depth, slices, crushing)


def barrel_vault(
    voussoirs: int,
    courses: int,
    inner_radius: float,
    thickness: float,
    length: float,
    friction: float | Friction,
    embrace: float = pi,
    bond: bool = True,
    crushing: float | Crushing | None = None,
) -> BlockAssembly3D:
    """Return a barrel vault along y, with radial beds and head joints in planes of y.

    Blocks are named ``v1c1`` (voussoir from left to right, place along y); "left" and "right" are
    the springings, as long as the vault.

    Args:
        voussoirs: number of voussoirs of its section.
        courses: blocks along y; in bond every second voussoir begins and ends with half of one.
        inner_radius: radius of the circle through the inner corners, m.
        thickness: m. `length`: length along y, m.
        friction: law of all joints. `crushing`: their strength in compression, Pa, if finite.
        embrace: angle of the section at the centre, rad.
        bond: whether head joints of neighbouring voussoirs are shifted by half a block.

    Example:
        >>> vault = la.masonry3d.barrel_vault(
        ...     voussoirs=5, courses=2, inner_radius=1.0, thickness=0.2, length=1.0, friction=0.6
        ... )
        >>> len(vault.names)
        14
    """
    require_count("barrel_vault.courses", courses)
    require_positive("barrel_vault.length", length)
    section = masonry.arch(voussoirs, inner_radius, thickness, friction, embrace).polygons
    whole = np.linspace(0.0, length, courses + 1)
    halves = np.concatenate([[0.0], (whole[1:] + whole[:-1]) / 2, [length]])
    blocks = {}
    for name, outline in section.items():
        if name in ("left", "right"):
            blocks[name] = prism(outline, 0.0, length)
            continue
        ends = halves if bond and int(name) % 2 == 0 else whole
        for k in range(len(ends) - 1):
            blocks[f"v{name}c{k + 1}"] = prism(outline, ends[k], ends[k + 1])
    return BlockAssembly3D(blocks, friction, crushing=crushing)


def cross_vault(
    voussoirs: int,
    inner_radius: float,
    thickness: float,
    half_side: float,
    friction: float | Friction,
    base: bool = True,
    crushing: float | Crushing | None = None,
) -> BlockAssembly3D:
    """Return two equal crossing barrel vaults: four webs, cut along x = y and x = -y.

    The sections are semicircles, which spring at z = 0. Blocks are named ``+x1``, ``+x2``, ...: web
    on that side of the z axis, voussoir around its axis. Webs meet in the groins, which are
    vertical planes.

    Args:
        voussoirs: number of voussoirs of a web.
        inner_radius: radius of the circle through the inner corners of a section, m.
        thickness: m.
        half_side: distance of the free ends of the webs from the z axis, m, more than the outer
            radius.
        friction: law of all joints. `crushing`: their strength in compression, Pa, if finite.
        base: whether blocks ``base+x1``, ... lie below the lowest voussoirs, one each, for
            supports.

    Example:
        >>> vault = la.masonry3d.cross_vault(
        ...     voussoirs=5, inner_radius=1.0, thickness=0.2, half_side=1.3, friction=0.6
        ... )
        >>> len(vault.names)
        28
    """
    require_count("cross_vault.voussoirs", voussoirs)
    require_positive("cross_vault.inner_radius", inner_radius)
    require_positive("cross_vault.thickness", thickness)
    require_positive("cross_vault.half_side", half_side)
    if voussoirs < 3:
        raise InputError("cross_vault.voussoirs", voussoirs, "no web", "give at least 3")
    outer_radius = inner_radius + thickness
    if half_side <= outer_radius:
        why = "the webs are not as long as they are wide"
        fix = f"give more than {outer_radius:g}"
        raise InputError("cross_vault.half_side", half_side, why, fix)
    angle = np.linspace(pi, 0.0, voussoirs + 1)
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    around[np.abs(around) < _ROUND_OFF] = 0.0  # springings in z = 0, the crown in y = 0
    inner, outer = inner_radius * around, outer_radius * around
    sections = {
        str(n + 1): np.array([inner[n], inner[n + 1], outer[n + 1], outer[n]])
        for n in range(voussoirs)
    }
    if base:
        for n, k in ((0, 1), (voussoirs, voussoirs)):
            ends = np.array([inner[n], outer[n]])
            sections[f"base{k}"] = np.concatenate([ends, ends[::-1] - [0.0, thickness]])
    blocks = {}
    for quarter, side in enumerate(_QUARTERS):
        for name, section in sections.items():
            number = name.removeprefix("base")
            label = name[: -len(number)] + side + number
            blocks[label] = _turned(_web(section, half_side), quarter)
    return BlockAssembly3D(blocks, friction, crushing=crushing)


def _web(section: Floats, half_side: float) -> tuple[Floats, list[tuple[int, ...]]]:
    """Return a prism along x over a section of (y, z), from the planes x = abs(y) to x = half_side.

    A section across y = 0 is cut there, where the planes meet.
    """
    y, z = _split(section)
    count = y.size
    start = np.stack([np.abs(y), y, z], axis=1)
    end = np.stack([np.full(count, half_side), y, z], axis=1)
    left, right = ([n for n in range(count) if sign * y[n] >= 0] for sign in (1, -1))
    sides = [(n, (n + 1) % count, (n + 1) % count + count, n + count) for n in range(count)]
    caps = [tuple(own) for own in (left, right) if len(own) > 2]
    return np.concatenate([start, end]), [*caps, tuple(range(count, 2 * count)), *sides]


def _split(section: Floats) -> tuple[Floats, Floats]:
    """Return a convex section of (y, z), with corners where its outline crosses y = 0."""
    found = []
    for (y, z), (next_y, next_z) in zip(section, np.roll(section, -1, axis=0), strict=True):
        found.append((y, z))
        if y * next_y < 0:
            share = y / (y - next_y)
            found.append((0.0, z + share * (next_z - z)))
    y, z = np.array(found).T
    return y, z


def _turned(web: tuple[Floats, list[tuple[int, ...]]], quarters: int) -> Polyhedron:
    """Return a block turned about z by right angles, without round-off."""
    points, faces = web
    for _ in range(quarters):
        points = points[:, [1, 0, 2]] * [-1.0, 1.0, 1.0]
    return Polyhedron(points, faces)
