"""Boxes of tetrahedra with named sides."""

from __future__ import annotations

from itertools import permutations
from typing import Any

import numpy as np
from skfem import MeshTet

from lacore.model.meshes.structured import along_axis
from lacore.numerics.arrays import Floats, Ints

_SIDES = (("left", "right"), ("front", "back"), ("bottom", "top"))


def box(
    x: tuple[float, float],
    y: tuple[float, float],
    z: tuple[float, float],
    nx: int,
    ny: int,
    nz: int,
    crossed: bool = False,
    grade_x: tuple[float, float] | None = None,
    grade_y: tuple[float, float] | None = None,
    grade_z: tuple[float, float] | None = None,
) -> MeshTet:
    """Return a box of tetrahedra: `left`, `right`, `front`, `back` (y), `bottom`, `top`.

    Args:
        x, y, z: extents.
        nx, ny, nz: number of cells in each direction.
        crossed: 24 tetrahedra per cell around its centre and those of its faces, equal in all
            directions; else six around the diagonal of the cell, whose faces contain the planes
            x = y, y = z and z = x through its corners (T89).
        grade_x, grade_y, grade_z: ``(at, ratio)``, see `lacore.model.meshes.graded`.

    Raises:
        InputError: see `graded`.

    Example:
        >>> la.meshes.box(x=(0, 1), y=(0, 1), z=(0, 1), nx=1, ny=1, nz=1).nelements
        6
    """
    rows = [
        along_axis("x", x, nx, grade_x),
        along_axis("y", y, ny, grade_y),
        along_axis("z", z, nz, grade_z),
    ]
    points = np.stack([axis.ravel() for axis in np.meshgrid(*rows, indexing="ij")])
    number = np.arange(points.shape[1]).reshape([own.size for own in rows])
    places, corners = _crossed(points, number) if crossed else (points, _halved(number))
    return with_named_sides(MeshTet(*map(np.ascontiguousarray, (places, corners))))


def with_named_sides(mesh: Any) -> Any:
    """Return a mesh of a box with its six sides named, by exact coordinates."""
    low, high = mesh.p.min(axis=1), mesh.p.max(axis=1)
    own = mesh.boundary_facets()
    corner = mesh.p[:, mesh.facets[:, own]]
    names = {}
    for axis, (first, last) in enumerate(_SIDES):
        for name, at in ((first, low[axis]), (last, high[axis])):
            names[name] = own[np.all(corner[axis] == at, axis=0)]
    return mesh.with_boundaries(names)


def _corner(number: Ints, offset: tuple[int, ...]) -> Ints:
    """Return the numbers of the corner of each cell at an offset of zeros and ones."""
    parts = tuple(slice(o, n - 1 + o) for o, n in zip(offset, number.shape, strict=True))
    return np.asarray(number[parts].ravel())


def _halved(number: Ints) -> Ints:
    """Return six tetrahedra per cell, from the lowest corner along the axes in any order."""
    parts = []
    for order in permutations(range(3)):
        at = [0, 0, 0]
        path = [_corner(number, (0, 0, 0))]
        for axis in order:
            at[axis] = 1
            path.append(_corner(number, tuple(at)))
        parts.append(np.stack(path))
    return np.concatenate(parts, axis=1)


def _crossed(points: Floats, number: Ints) -> tuple[Floats, Ints]:
    """Return places and tetrahedra of cells cut from their centres and those of their faces."""
    shape = np.array(number.shape)
    places, parts = [points], []
    centre = number.size + np.arange(int(np.prod(shape - 1))).reshape(shape - 1)
    offsets = np.array(np.meshgrid(*[[0, 1]] * 3, indexing="ij")).reshape(3, 8).T
    corners = np.stack([_corner(number, tuple(own)) for own in offsets.tolist()])
    places.append(points[:, corners].mean(axis=1))
    first = number.size + centre.size
    for axis in range(3):
        others = [other for other in range(3) if other != axis]
        ring = []  # corners of the faces across the axis, in order
        for turn in ((0, 0), (1, 0), (1, 1), (0, 1)):
            parts_of = [slice(None)] * 3
            for other, o in zip(others, turn, strict=True):
                parts_of[other] = slice(o, shape[other] - 1 + o)
            ring.append(number[tuple(parts_of)])
        faces = first + np.arange(ring[0].size).reshape(ring[0].shape)
        places.append(np.mean([points[:, own.ravel()] for own in ring], axis=0))
        first += faces.size
        for side in (0, 1):
            near = [slice(None)] * 3
            near[axis] = slice(side, shape[axis] - 1 + side)
            at = tuple(near)
            for k in range(4):
                ends = (ring[k][at], ring[(k + 1) % 4][at])
                own = (centre, faces[at], *ends)
                parts.append(np.stack([part.ravel() for part in own]))
    return np.concatenate(places, axis=1), np.concatenate(parts, axis=1)
