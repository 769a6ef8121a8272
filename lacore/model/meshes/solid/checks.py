"""Checks that reject invalid or unsolvable tetrahedra with their place."""

import numpy as np
import shapely
from skfem import MeshTet

from lacore.model.meshes.checks import (
    at,
    centre,
    check_connected,
    check_finite,
    check_slivers,
    check_used,
)
from lacore.model.meshes.solid.shape import ENDS, signed_volumes
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError

# volume divided by the cubed longest edge, below which gradients lose all their digits
_FLAT = 1e-10
_ON = 1e-6  # by a face: a closer vertex lies on the face; files have at least 6 digits
_WITHIN = 1e-9  # barycentric coordinate above which a place is in an element, not on its face


def check_tetrahedra(mesh: MeshTet, field: str) -> None:
    """Reject meshes that are not a conforming division of one connected body into tetrahedra.

    Raises:
        InputError: vertices that are not finite or not used, elements without volume, slivers,
            inverted or overlapping elements, hanging nodes, or several parts.
    """
    check_finite(mesh, field)
    check_used(mesh, field)
    _check_shapes(mesh, field)
    _check_facets(mesh, field)
    _check_hanging(mesh, field)
    _check_overlaps(mesh, field)
    check_connected(mesh, field)


def _check_shapes(mesh: MeshTet, field: str) -> None:
    edges = mesh.p[:, mesh.t[ENDS[0]]] - mesh.p[:, mesh.t[ENDS[1]]]
    longest = np.linalg.norm(edges, axis=0).max(axis=0)
    flat = np.flatnonzero(~(np.abs(signed_volumes(mesh)) > _FLAT * longest**3))
    if flat.size:
        raise InputError(
            field,
            flat[:5].tolist(),
            f"elements without volume, the first at {centre(mesh, flat[0])}",
            "remove or move their vertices",
        )
    check_slivers(mesh, field)


def _check_facets(mesh: MeshTet, field: str) -> None:
    crowded = np.flatnonzero(np.bincount(mesh.t2f.ravel()) > 2)
    if crowded.size:
        raise InputError(
            field,
            None,
            f"a face with more than two elements, around {_face(mesh, crowded[0])}: they overlap",
            "remove the elements that lie on top of others",
        )
    inner = np.flatnonzero(mesh.f2t[1] >= 0)
    a, b, c = mesh.p[:, mesh.facets[:, inner]].transpose(1, 2, 0)
    normal = np.cross(b - a, c - a)
    side = [
        np.sum(normal * (mesh.p[:, mesh.t[:, own]].mean(axis=1).T - a), axis=1)
        for own in mesh.f2t[:, inner]
    ]
    folded = inner[np.sign(side[0]) == np.sign(side[1])]
    if folded.size:
        raise InputError(
            field,
            np.unique(mesh.f2t[:, folded[:5]]).tolist(),
            "inverted elements (they lie on top of a neighbour), the first at the face around"
            f" {_face(mesh, folded[0])}",
            "move the vertices so that elements do not overlap",
        )


def _check_hanging(mesh: MeshTet, field: str) -> None:
    """Reject vertices in a face, or on an edge, of another element; both on the boundary."""
    facets = mesh.boundary_facets()
    corner = mesh.p[:, mesh.facets[:, facets]]
    vertices = np.unique(mesh.facets[:, facets])
    size = np.linalg.norm(np.ptp(corner, axis=1), axis=0)
    near, face = _in_boxes(mesh.p[:, vertices], corner, _ON * size)
    own = np.any(mesh.facets[:, facets[face]] == vertices[near], axis=0)
    near, face = near[~own], face[~own]
    a, b, c = corner[:, :, face].transpose(1, 2, 0)
    place = mesh.p[:, vertices[near]].T
    normal = np.cross(b - a, c - a)
    squared = np.sum(normal**2, axis=1)
    off = np.abs(np.sum(normal * (place - a), axis=1)) / np.sqrt(squared)
    shares = [
        np.sum(normal * np.cross(two - one, place - one), axis=1) / squared
        for one, two in ((a, b), (b, c), (c, a))
    ]
    inside = (off <= _ON * size[face]) & (np.min(shares, axis=0) >= -_ON)
    if inside.any():
        first = np.flatnonzero(inside)[0]
        raise InputError(
            field,
            np.unique(vertices[near[inside]])[:5].tolist(),
            f"hanging nodes, the first at {at(place[first])} in the face around"
            f" {_face(mesh, facets[face[first]])}",
            "split the element with that face there",
        )


def _check_overlaps(mesh: MeshTet, field: str) -> None:
    """Reject vertices, and centres of elements, within another element.

    Elements must not be folded over a neighbour, with at most two elements at a face: other
    overlaps are between parts of the boundary that intersect.
    """
    corner = mesh.p[:, mesh.t]
    middle = corner.mean(axis=1)
    places = np.concatenate([mesh.p, middle], axis=1)
    near, element = _in_boxes(places, corner, np.zeros(mesh.nelements))
    own = np.any(mesh.t[:, element] == near, axis=0)
    own |= near == mesh.p.shape[1] + element
    near, element = near[~own], element[~own]
    origin = corner[:, 0, element]
    sides = (corner[:, 1:, element] - origin[:, None]).transpose(2, 0, 1)
    away = (places[:, near] - origin).T
    shares = np.linalg.solve(sides, away[:, :, None])[:, :, 0]
    least = np.minimum(shares.min(axis=1, initial=1.0), 1 - shares.sum(axis=1))
    inside = np.flatnonzero(least > _WITHIN)
    if inside.size:
        first = inside[0]
        raise InputError(
            field,
            element[inside[:5]].tolist(),
            f"elements that overlap at {at(places[:, near[first]])}",
            "move or remove elements until each place is in one",
        )


def _in_boxes(places: Floats, corner: Floats, room: Floats) -> tuple[Ints, Ints]:
    """Return pairs of places (3, n) and elements, corners (3, a, e), whose boxes contain them."""
    low, high = corner.min(axis=1) - room, corner.max(axis=1) + room
    tree = shapely.STRtree(shapely.points(places[:2].T))
    element, near = tree.query(shapely.box(low[0], low[1], high[0], high[1]))
    level = places[2, near]
    kept = (level >= low[2, element]) & (level <= high[2, element])
    return near[kept], element[kept]


def _face(mesh: MeshTet, facet: int) -> str:
    return at(mesh.p[:, mesh.facets[:, facet]].mean(axis=1))
