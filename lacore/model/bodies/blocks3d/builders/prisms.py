"""Prisms across the plane of x and z, and plane assemblies extruded to a depth."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.model.bodies.blocks3d.crushing import Crushing
from lacore.model.bodies.blocks3d.polyhedron import Polyhedron
from lacore.model.materials.friction import Friction
from lacore.reporting.errors import require_count, require_positive


def prism(outline: npt.ArrayLike, low: float, high: float) -> Polyhedron:
    """Return the prism over a polygon of (x, z), m, between two planes of y, m."""
    flat = np.asarray(outline, dtype=np.float64)
    count = len(flat)
    near, far = (np.insert(flat, 1, y, axis=1) for y in (low, high))
    sides = [(n, (n + 1) % count, (n + 1) % count + count, n + count) for n in range(count)]
    return Polyhedron(np.concatenate([near, far]), [range(count), range(count, 2 * count), *sides])


def extruded(
    plane: BlockAssembly, depth: float, slices: int = 1, crushing: float | Crushing | None = None
) -> BlockAssembly3D:
    """Return a plane assembly extruded along y (T78).

    Its x and y become x and z, and y runs from 0 to the depth. Blocks keep their names; with
    several slices they are ``NAME/1``, ``NAME/2``, ..., and a law of `joint_friction` applies to
    all of them, as does the tolerance of the assembly.

    Args:
        plane: plane assembly, such as one of `lacore.masonry`.
        depth: depth along y, m.
        crushing: strength of joints in compression, Pa, if finite.
        slices: number of equal slices, one behind the other.

    Example:
        >>> plane = la.masonry.stack([(1.0, 0.5), (0.8, 0.5)], friction=0.5)
        >>> la.masonry3d.extruded(plane, depth=0.4).names
        ('base', '1', '2')
    """
    require_positive("extruded.depth", depth)
    require_count("extruded.slices", slices)
    ends = np.linspace(0.0, depth, slices + 1)
    blocks = {
        _named(name, k, slices): prism(outline, ends[k], ends[k + 1])
        for name, outline in plane.polygons.items()
        for k in range(slices)
    }
    laws: Mapping[tuple[str, str], float | Friction] = {
        (_named(one, k, slices), _named(other, k, slices)): law
        for (one, other), law in (plane.joint_friction or {}).items()
        for k in range(slices)
    }
    return BlockAssembly3D(blocks, plane.friction, laws, plane.tolerance, crushing)


def _named(name: str, slice_: int, slices: int) -> str:
    return name if slices == 1 else f"{name}/{slice_ + 1}"
