"""Fans: elements that turn around a vertex, as lower bounds need at singular points (T26b)."""

from collections.abc import Sequence
from itertools import pairwise
from math import ceil, log2, pi

import numpy as np
from skfem import MeshTri

from lacore.arrays import Floats
from lacore.meshes.refinement import facets_between, with_named_elements

_STRAIGHT = 1e-6  # rad: round-off of angles
_SHRINK = (0.55, 0.7)  # radius of a ring of a fan, per next larger one: elements about as long as
_LATER = 0.8  # wide, while sectors are halved from ring to ring


def fanned(mesh: MeshTri, vertices: Sequence[int], sectors: int) -> MeshTri:
    """The mesh with the elements at vertices divided into fans; all names are kept.

    Args:
        mesh: any; vertices keep their numbers.
        vertices: to turn around, one after the other.
        sectors: in 180 degrees, at least; an element gets a power of 2 of them.
    """
    for vertex in vertices:
        mesh = _fan(mesh, vertex, sectors)
    return mesh


def _fan(mesh: MeshTri, centre: int, sectors: int) -> MeshTri:
    around = np.flatnonzero(np.any(mesh.t == centre, axis=0))
    corners = np.array([_spokes(mesh, element, centre) for element in around.tolist()])
    place = mesh.p[:, centre]
    spokes = mesh.p[:, corners] - place[:, None, None]  # (2, elements, 2)
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
        return mesh  # elements too flat to be turned around
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
    """The other two vertices, anticlockwise."""
    a, b = (vertex for vertex in mesh.t[:, element].tolist() if vertex != centre)
    one, other = mesh.p[:, a] - mesh.p[:, centre], mesh.p[:, b] - mesh.p[:, centre]
    return [a, b] if one[0] * other[1] - one[1] * other[0] > 0 else [b, a]


def _turn(corner: Floats) -> Floats:
    """Twice the signed area of triangles, corners of shape (2, 3, n)."""
    u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    return np.asarray(u[0] * v[1] - u[1] * v[0])


def _arc(one: Floats, other: Floats, angle: float, parts: int, round_: float) -> Floats:
    """Points between two spokes at equal angles: on their chord (0) to an arc (1), (2, parts-1)."""
    share = np.arange(1, parts) / parts
    turn = angle * share
    near, far = float(np.linalg.norm(one)), float(np.linalg.norm(other))
    chord = np.sin(angle) / (np.sin(angle - turn) / near + np.sin(turn) / far)
    arc = near * (1 - share) + far * share
    direction = np.arctan2(one[1], one[0]) + turn
    reach = (1 - round_) * chord + round_ * arc
    return np.asarray(reach * np.stack([np.cos(direction), np.sin(direction)]))
