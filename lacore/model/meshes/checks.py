"""Checks that reject invalid or unsolvable meshes with place and fix."""

from __future__ import annotations

import numpy as np
import shapely
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from skfem import MeshQuad, MeshTet, MeshTri

from lacore.model.meshes.curved import is_curved, jacobians, subdivided
from lacore.model.meshes.solid.shape import shapes
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.errors import InputError, require_range, typed
from lacore.reporting.text import Term, text

# area divided by the squared longest edge, below which gradients lose all their digits
_DEGENERATE = 1e-10
# Quality below which residuals of exact solves, about 1e-10 on good meshes, approach the 1e-6 of
# certificates: they grow as 1e-13 / quality.
SLIVER = 1e-6
_ON = 1e-6  # by an edge: a closer vertex lies on the edge; files have at least 6 digits
_FACET = {2: "edge", 3: "face"}
_NO_AREA = 1e-12  # by the squared size: overlaps by the round-off of coordinates


@typed()
def quality(mesh: MeshTri | MeshQuad | MeshTet) -> Floats:
    """Return the shape of elements, (elements,): 1 for equilateral triangles, 0 without area.

    It is ``4 sqrt(3) area / sum of squared edges``; for a quadrilateral the smallest of its four
    corners; for tetrahedra see `lacore.model.meshes.solid.shape.shapes`. Upper bounds are strict
    for any shape; below `SLIVER` a body rejects the mesh.

    Example:
        >>> mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2)
        >>> round(la.meshes.quality(mesh).min().item(), 3)
        0.866
    """
    if isinstance(mesh, MeshTet):
        return shapes(mesh)
    corner, before, after = _around(mesh)
    squares = sum(
        np.sum(side**2, axis=0) for side in (corner - before, after - corner, before - after)
    )
    area = np.abs(_turn(mesh)) / 2
    return np.asarray(
        np.min(4 * np.sqrt(3) * area / np.where(squares > 0, squares, 1.0), axis=0), dtype=float
    )


def check_mesh(mesh: MeshTri | MeshQuad, field: str) -> None:
    """Reject meshes that are not a valid division of one connected part.

    Raises:
        InputError: vertices that are not finite or not used, elements without area, slivers,
            elements that are not convex, inverted or overlapping, hanging nodes, or several parts.
    """
    if is_curved(mesh):
        check_curved(mesh, field)
        straight = subdivided(mesh)
        check_hanging(straight, field)
        _check_overlaps(straight, field)
        return
    check_finite(mesh, field)
    check_used(mesh, field)
    _check_shapes(mesh, field)
    _check_facets(mesh, field)
    check_hanging(mesh, field)
    _check_overlaps(mesh, field)
    check_connected(mesh, field)


def check_finite(mesh: MeshTri | MeshQuad | MeshTet, field: str) -> None:
    """Reject coordinates that are not finite, or too large to be multiplied."""
    if not np.all(np.isfinite(mesh.doflocs)):
        raise InputError(field, None, "has vertices that are not finite", "fix the coordinates")
    require_range(field, mesh.doflocs, np.ptp(mesh.p, axis=1))


def check_used(mesh: MeshTri | MeshQuad | MeshTet, field: str) -> None:
    """Reject vertices that no element uses."""
    unused = np.setdiff1d(np.arange(mesh.p.shape[1]), mesh.t)
    if unused.size:
        raise InputError(
            field,
            unused[:5].tolist(),
            f"vertices that no element uses, the first at {at(mesh.p[:, unused[0]])}",
            "remove them (mesh.remove_unused_nodes())",
        )


def check_slivers(mesh: MeshTri | MeshQuad | MeshTet, field: str) -> None:
    """Reject elements whose shape is below `SLIVER`."""
    shape = quality(mesh)
    slivers = np.flatnonzero(shape < SLIVER)
    if slivers.size:
        worst = slivers[np.argmin(shape[slivers])]
        raise InputError(
            field,
            slivers[:5].tolist(),
            f"slivers, the worst of quality {shape[worst]:.1e} at {centre(mesh, worst)}, where"
            f" {SLIVER:.0e} is the least (lacore.model.meshes.quality)",
            "move or merge their vertices, or mesh anew",
        )


def check_connected(mesh: MeshTri | MeshQuad | MeshTet, field: str) -> None:
    """Reject parts that are not joined by an edge, or by a face in three dimensions."""
    inner = mesh.f2t[:, mesh.f2t[1] >= 0]
    links = coo_matrix((np.ones(inner.shape[1]), inner), shape=(mesh.nelements,) * 2)
    parts, part = connected_components(links, directed=False)
    if parts > 1:
        places = [centre(mesh, np.flatnonzero(part == number)[0]) for number in range(2)]
        raise InputError(
            field,
            int(parts),
            f"disconnected parts (joined by no element {_FACET[mesh.p.shape[0]]}), with elements at"
            f" {places[0]} and {places[1]}",
            text(
                "make each part a {} of its own, or merge coincident vertices",
                Term("Body", "body"),
            ),
        )


def at(place: Floats) -> str:
    """Return a place for a message."""
    return "(" + ", ".join(f"{own:.6g}" for own in place) + ")"


def centre(mesh: MeshTri | MeshQuad | MeshTet, element: int) -> str:
    """Return the centre of an element for a message."""
    return at(mesh.p[:, mesh.t[:, element]].mean(axis=1))


def check_curved(mesh: MeshTri | MeshQuad, field: str) -> None:
    """Reject inverted elements with midside nodes, and parts; elements may touch or overlap."""
    check_finite(mesh, field)
    least, size = jacobians(mesh).min(axis=1), np.ptp(mesh.p[:, mesh.t], axis=1).max(axis=0)
    wrong = np.flatnonzero(~(least > SLIVER * size**2))
    if wrong.size:
        raise InputError(
            field,
            wrong[:5].tolist(),
            f"inverted elements, det J <= 0 somewhere inside, the first at"
            f" {centre(mesh, wrong[0])}",
            "move their vertices or midside nodes, or mesh anew",
        )
    _check_crowded(mesh, field)
    check_connected(mesh, field)


def _check_shapes(mesh: MeshTri | MeshQuad, field: str) -> None:
    corner, _, after = _around(mesh)
    turn = _turn(mesh)
    turn = turn * np.sign(turn.sum(axis=0))
    least = 2 * _DEGENERATE * np.max(np.linalg.norm(after - corner, axis=0), axis=0) ** 2
    flat = np.flatnonzero(turn.max(axis=0) <= least)
    if flat.size:
        raise InputError(
            field,
            flat[:5].tolist(),
            f"elements without area, the first at {centre(mesh, flat[0])}",
            "remove or move their vertices",
        )
    bent = np.flatnonzero(turn.min(axis=0) < least)
    if bent.size:
        raise InputError(
            field,
            bent[:5].tolist(),
            f"quadrilaterals that are not convex, the first at {centre(mesh, bent[0])}",
            "move their vertices, or cut them into triangles",
        )
    check_slivers(mesh, field)


def _check_crowded(mesh: MeshTri | MeshQuad, field: str) -> None:
    crowded = np.flatnonzero(np.bincount(mesh.t2f.ravel()) > 2)
    if crowded.size:
        raise InputError(
            field,
            None,
            f"an edge with more than two elements, {_edge(mesh, crowded[0])}: they overlap",
            "remove the elements that lie on top of others",
        )


def _check_facets(mesh: MeshTri | MeshQuad, field: str) -> None:
    _check_crowded(mesh, field)
    folded = _folded_facets(mesh)
    if folded.size:
        raise InputError(
            field,
            np.unique(mesh.f2t[:, folded[:5]]).tolist(),
            "inverted elements (they lie on top of a neighbour), the first at the edge"
            f" {_edge(mesh, folded[0])}",
            "move the vertices so that elements do not overlap",
        )


def _folded_facets(mesh: MeshTri | MeshQuad) -> Ints:
    """Return the interior facets whose two elements lie on the same side."""
    inner = np.flatnonzero(mesh.f2t[1] >= 0)
    start, end = mesh.p[:, mesh.facets[0, inner]], mesh.p[:, mesh.facets[1, inner]]

    def side(elements: Ints) -> Floats:
        centre = mesh.p[:, mesh.t[:, elements]].mean(axis=1)
        return np.asarray(np.sign(_cross(end - start, centre - start)))

    return np.asarray(inner[side(mesh.f2t[0, inner]) == side(mesh.f2t[1, inner])])


def check_hanging(mesh: MeshTri | MeshQuad, field: str) -> None:
    """Reject vertices inside the edge of another element; both are on the boundary."""
    facets = mesh.boundary_facets()
    vertices = np.unique(mesh.facets[:, facets])
    start, end = mesh.p[:, mesh.facets[0, facets]], mesh.p[:, mesh.facets[1, facets]]
    length = np.linalg.norm(end - start, axis=0)
    tree = shapely.STRtree(shapely.points(mesh.p[:, vertices].T))
    lines = shapely.linestrings(np.stack([start.T, end.T], axis=1))
    edge, near = tree.query(lines, predicate="dwithin", distance=_ON * length)
    from_start, from_end = (
        np.linalg.norm(mesh.p[:, vertices[near]] - ends[:, edge], axis=0) for ends in (start, end)
    )
    inside = np.flatnonzero(np.minimum(from_start, from_end) > _ON * length[edge])
    if inside.size:
        first = inside[0]
        raise InputError(
            field,
            np.unique(vertices[near[inside]])[:5].tolist(),
            f"hanging nodes, the first at {at(mesh.p[:, vertices[near[first]]])} inside the edge"
            f" {_edge(mesh, facets[edge[first]])}",
            "split the element with that edge there, or make the sides Bodies with an Interface",
        )


def _check_overlaps(mesh: MeshTri | MeshQuad, field: str) -> None:
    """Reject places in two elements.

    If no element is folded over its neighbour, the number of elements at a place is constant on
    each face of the plane that boundary edges enclose.
    """
    origin, size = mesh.p.min(axis=1), float(np.max(np.ptp(mesh.p, axis=1)))
    # Rounded, since the geometry library overflows on coordinates like 1e-313.
    scaled = np.round((mesh.p.T - origin) / size, 13)
    lines = shapely.linestrings(scaled[mesh.facets[:, mesh.boundary_facets()].T])
    faces = shapely.get_parts(shapely.polygonize([shapely.union_all(lines)]))
    faces = faces[shapely.area(faces) > _NO_AREA]
    for inner in shapely.get_coordinates(shapely.point_on_surface(faces)):
        place = origin + size * inner
        elements = np.flatnonzero(_inside(mesh, place))
        if elements.size > 1:
            raise InputError(
                field,
                elements[:5].tolist(),
                f"elements that overlap at {at(place)}",
                "move or remove elements until each place is in one, or make Bodies of the layers",
            )


def _around(mesh: MeshTri | MeshQuad) -> tuple[Floats, Floats, Floats]:
    """Return the corners of elements, those before and those after them.

    (2, corners, elements) each.
    """
    corner = mesh.p[:, mesh.t]
    return corner, np.roll(corner, 1, axis=1), np.roll(corner, -1, axis=1)


def _turn(mesh: MeshTri | MeshQuad) -> Floats:
    """Return twice the area of the triangle at each corner, anticlockwise positive."""
    corner, before, after = _around(mesh)
    return _cross(corner - before, after - corner)


def _inside(mesh: MeshTri | MeshQuad, place: Floats) -> Bools:
    """Return the elements that contain a place."""
    corner, _, after = _around(mesh)
    side = _cross(after - corner, place[:, None, None] - corner)
    return np.asarray(np.all(side > 0, axis=0) | np.all(side < 0, axis=0))


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[0] * b[1] - a[1] * b[0])


def _edge(mesh: MeshTri | MeshQuad, facet: int) -> str:
    start, end = mesh.p[:, mesh.facets[:, facet]].T
    return f"from {at(start)} to {at(end)}"
