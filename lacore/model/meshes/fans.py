"""Fans: elements around a point, as lower bounds need at singular points (T26b)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import ceil, exp, log2, pi

import numpy as np
from skfem import MeshTri

from lacore.model.meshes.refinement import facets_between, with_named_elements
from lacore.model.meshes.structured import graded, named_sides
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError

_STRAIGHT = 1e-6  # rad, round-off of angles
# radius of a ring of a fan by the next larger one, for elements about as long as wide
_SHRINK = (0.55, 0.7)
_LATER = 0.8  # radius while sectors are halved from ring to ring


def fan(
    x: tuple[float, float],
    y: tuple[float, float],
    at: tuple[float, float],
    sectors: int,
    rings: int,
    grade: float | None = None,
    crossed: bool = True,
) -> MeshTri:
    """Return a triangle mesh of a rectangle around a point; boundaries as in `rectangle`.

    Where a stress fan ends in a point, a lower bound needs many elements there, and refinement does
    not halve their angles: with n sectors in the 90 degrees of a footing's fan it remains at about
    ``(2 + 2 n sin(pi/(2 n)))/(2 + pi)`` of the load.

    Args:
        x, y: extents.
        at: the point, inside, on a side or at a corner.
        sectors: even number of sectors in 180 degrees; equal at the point, where rays are straight.
            The
            ray next to a corner of the rectangle bends towards it.
        rings: number of rings of cells around the point; those of the first one are triangles.
        grade: ratio of the outermost cell to the innermost; None: cells as long as wide.
        crossed: see `rectangle`.

    Raises:
        InputError: see `graded`; a point outside, or too few sectors for the corners.

    Example:
        >>> mesh = la.meshes.fan(x=(0, 2), y=(-1, 0), at=(1, 0), sectors=6, rings=3)
        >>> bool(np.isclose(mesh.p.T, (1, 0)).all(axis=1).any())  # a vertex where velocities jump
        True
    """
    if not (x[0] <= at[0] <= x[1] and y[0] <= at[1] <= y[1]):
        raise InputError("at", at, "outside the rectangle", "give one of its points")
    if not (isinstance(sectors, (int, np.integer)) and sectors >= 4 and sectors % 2 == 0):
        raise InputError("sectors", sectors, "not an even number from 4 on", "give 8, 16, 24, ...")
    angle = pi / sectors
    share = graded(0.0, 1.0, rings, (0.0, exp(rings * angle) if grade is None else grade))[1:]
    straight, ends, closed = _rays(np.array([x, y]), np.array(at), sectors)
    bend, centre = ends - straight, np.reshape(at, (2, 1, 1))
    towards = (straight - centre[:, 0])[:, None]
    rows = centre + towards * share[:, None] + bend[:, None] * share[:, None] ** 2
    rows[:, -1] = ends
    rays = ends.shape[1]
    number = 1 + np.arange(rows[0].size).reshape(rings, rays)
    number = np.append(number, number[:, :1], axis=1) if closed else number
    inner, outer = number[:-1], number[1:]
    points = np.concatenate([centre[:, :, 0], rows.reshape(2, -1)], axis=1)
    a, b, c, d = (
        part.ravel() for part in (inner[:, :-1], outer[:, :-1], outer[:, 1:], inner[:, 1:])
    )
    triangles = [np.stack([np.zeros_like(number[0, 1:]), number[0, :-1], number[0, 1:]])]
    if crossed:
        middle = points.shape[1] + np.arange(a.size)
        points = np.append(points, _crossing(*(points[:, part] for part in (a, c, b, d))), axis=1)
        triangles += [np.stack([p, q, middle]) for p, q in ((a, b), (b, c), (c, d), (d, a))]
    else:
        triangles += [np.stack([a, b, c]), np.stack([a, c, d])]
    turning: MeshTri = named_sides(MeshTri(points, np.concatenate(triangles, axis=1)))
    return turning


def _rays(box: Floats, at: Floats, sectors: int) -> tuple[Floats, Floats, bool]:
    """Return where rays from a point meet the sides of a box, their ends, and if they close.

    Both arrays have the shape (2, rays): the second has the corners of the box in place of the
    nearest points.
    """
    low, high = at == box[:, 0], at == box[:, 1]
    on = int(np.sum(low | high))
    # Quarter turns to the first direction, anticlockwise, that stays in the box.
    sides = {(0, 0): 0, (0, 1): 0, (-1, 0): 1, (0, -1): 2, (1, 0): 3}
    corners = {(1, 1): 0, (-1, 1): 1, (-1, -1): 2, (1, -1): 3}
    start = (sides | corners)[int(low[0]) - int(high[0]), int(low[1]) - int(high[1])]
    count = {0: 2 * sectors, 1: sectors + 1, 2: sectors // 2 + 1}[on]
    angles = start * pi / 2 + np.arange(count) * pi / sectors
    direction = np.stack([np.cos(angles), np.sin(angles)])
    direction[np.abs(direction) < 1e-12] = 0.0
    side = np.where(direction > 0, box[:, 1:], box[:, :1])
    reach = np.full(direction.shape, np.inf)
    np.divide(side - at[:, None], direction, out=reach, where=np.abs(direction) > 0)
    first, every = np.argmin(reach, axis=0), np.arange(count)
    straight = at[:, None] + direction * reach[first, every]
    straight[first, every] = side[first, every]  # without round-off
    ends, taken = straight.copy(), set()
    for corner in np.array(np.meshgrid(*box)).reshape(2, 4).T:
        if np.array_equal(corner, at):
            continue
        along = (corner - at) / np.linalg.norm(corner - at)
        nearest = int(np.argmax(along @ direction))
        if nearest in taken:
            raise InputError(
                "sectors", sectors, "too few for the corners of the rectangle", "give more"
            )
        taken.add(nearest)
        ends[:, nearest] = corner
    return straight, ends, on == 0


def _crossing(a: Floats, c: Floats, b: Floats, d: Floats) -> Floats:
    """Return where the diagonals a-c and b-d of quadrilaterals cross, shape (2, n)."""
    u, v, w = c - a, d - b, b - a
    share = (w[0] * v[1] - w[1] * v[0]) / (u[0] * v[1] - u[1] * v[0])
    return np.asarray(a + share * u)


def fanned(mesh: MeshTri, vertices: Sequence[int], sectors: int) -> MeshTri:
    """Return the mesh with the elements at vertices divided into fans; all names are kept.

    Args:
        mesh: any mesh; vertices keep their numbers.
        vertices: centres of the fans, in turn.
        sectors: smallest number in 180 degrees; an element gets a power of 2 of them.
    """
    for vertex in vertices:
        mesh = _fan(mesh, vertex, sectors)
    return mesh


def _fan(mesh: MeshTri, centre: int, sectors: int) -> MeshTri:
    around = np.flatnonzero(np.any(mesh.t == centre, axis=0))
    corners = np.array([_spokes(mesh, element, centre) for element in around.tolist()])
    place = mesh.p[:, centre]
    spokes = mesh.p[:, corners] - place[:, None, None]  # shape (2, elements, 2)
    one, other = spokes[..., 0], spokes[..., 1]
    angle = np.arctan2(one[0] * other[1] - one[1] * other[0], np.sum(one * other, axis=0))
    rings = ceil(log2(max(float(angle.max()) * sectors / pi, 1.0)) - _STRAIGHT)
    if rings == 0:
        return mesh
    shrink = [1.0, *_SHRINK, *[_LATER] * rings][: rings + 1]
    radius = np.cumprod(shrink)
    points, triangles = list(mesh.p.T), []
    parts: list[int] = []
    on_spoke: dict[tuple[int, int], int] = {}
    for end in np.unique(corners).tolist():
        for ring in range(1, rings + 1):
            on_spoke[end, ring] = len(points)
            points.append(place + radius[ring] * (mesh.p[:, end] - place))
    for k, (start, stop) in enumerate(corners.tolist()):
        rows = [[start, stop]]
        for ring in range(1, rings + 1):
            inside = _arc(one[:, k], other[:, k], float(angle[k]), 2**ring, ring / rings)
            first = len(points)
            points += list((place[:, None] + radius[ring] * inside).T)
            rows.append([on_spoke[start, ring], *range(first, len(points)), on_spoke[stop, ring]])
        for outer, inner in pairwise(rows):
            for i in range(len(outer) - 1):
                a, b, (x, y, z) = outer[i], outer[i + 1], inner[2 * i : 2 * i + 3]
                triangles += [(a, y, x), (a, b, y), (b, z, y)]
        last = rows[-1]
        triangles += [(centre, a, b) for a, b in pairwise(last)]
        parts.append(len(triangles) - sum(parts))
    if _turn(np.transpose(points)[:, np.transpose(triangles)]).min() <= 0:
        return mesh  # The elements are too flat for a fan.
    finer = MeshTri(
        np.ascontiguousarray(np.transpose(points)),
        np.ascontiguousarray(
            np.concatenate([np.delete(mesh.t, around, axis=1), np.transpose(triangles)], axis=1)
        ),
    )
    kept = np.delete(np.arange(mesh.nelements), around)
    finer = with_named_elements(finer, mesh, np.concatenate([kept, np.repeat(around, parts)]))
    names = {}
    for name, facets in (mesh.boundaries or {}).items():
        ends = []
        for a, b in mesh.facets[:, np.asarray(facets, dtype=np.int64)].T.tolist():
            end = b if a == centre else a
            if centre in (a, b) and (end, 1) in on_spoke:
                chain = [end, *(on_spoke[end, ring] for ring in range(1, rings + 1)), centre]
                ends += list(pairwise(chain))
            else:
                ends.append((a, b))
        names[name] = facets_between(finer, np.array(ends, dtype=np.int64).reshape(-1, 2).T)
    return finer.with_boundaries(names) if names else finer


def _spokes(mesh: MeshTri, element: int, centre: int) -> list[int]:
    """Return the other two vertices, anticlockwise."""
    a, b = (vertex for vertex in mesh.t[:, element].tolist() if vertex != centre)
    one, other = mesh.p[:, a] - mesh.p[:, centre], mesh.p[:, b] - mesh.p[:, centre]
    return [a, b] if one[0] * other[1] - one[1] * other[0] > 0 else [b, a]


def _turn(corner: Floats) -> Floats:
    """Return twice the signed area of triangles, corners of shape (2, 3, n)."""
    u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    return np.asarray(u[0] * v[1] - u[1] * v[0])


def _arc(one: Floats, other: Floats, angle: float, parts: int, round_: float) -> Floats:
    """Return points between two spokes at equal angles, (2, parts-1).

    They lie on the chord for 0 and on an arc for 1.
    """
    share = np.arange(1, parts) / parts
    turn = angle * share
    near, far = float(np.linalg.norm(one)), float(np.linalg.norm(other))
    chord = np.sin(angle) / (np.sin(angle - turn) / near + np.sin(turn) / far)
    arc = near * (1 - share) + far * share
    direction = np.arctan2(one[1], one[0]) + turn
    reach = (1 - round_) * chord + round_ * arc
    return np.asarray(reach * np.stack([np.cos(direction), np.sin(direction)]))
