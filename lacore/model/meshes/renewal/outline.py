"""New mesh inside the outline of an old one, and inside the outlines of its regions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from skfem import Mesh
from skfem.mesh import MeshTri1, MeshTri2

from lacore.model.meshes.curved import EdgeCurves, edge_curves, jacobians, vertices
from lacore.model.meshes.renewal.sizes import Sizes, Uniform
from lacore.model.meshes.renewal.triangles import apart, triangulated
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.errors import InputError, require_known, require_positive, typed

_CORNER = np.cos(np.radians(20.0))  # cosine between edges of one smooth side
_SAMPLES = 8  # parts of an old edge for the measurement of its length
_SAME = 1e-9  # by the size of the mesh
_LEAST_JACOBIAN = 0.1  # by its mean in an element, below which edges are straightened
_LEAST = 3  # edges of a closed line
_GAUSS = np.array([1 - 1 / np.sqrt(3), 1 + 1 / np.sqrt(3)]) / 2


@dataclass(frozen=True)
class _Outline:
    """New edges of one closed line, in order.

    Attributes:
        start, middle: start and middle of each, shape (n, 2): the next one starts where it ends.
        old: the old facet that each lies on, for its names, shape (n,).
    """

    start: Floats
    middle: Floats
    old: Ints


@typed()
def remeshed(
    mesh: Mesh,
    size: float | Sizes,
    keep: Sequence[tuple[float, float]] = (),
    keep_edges: Sequence[str] = (),
    keep_regions: Sequence[str] = (),
) -> MeshTri2:
    """Return triangles of a length `size` in the outline of a mesh, with its boundary names.

    Corners, ends of named boundaries and the vertices in `keep` stay vertices. The same holds for
    the outlines of the regions in `keep_regions`, whose areas are kept as well. Between them edges
    are about as long as `size`. Their vertices lie on the old outline, and their midside nodes are
    placed so that the area stays the same, unless this would invert an element.

    Args:
        mesh: mesh of triangles or quadrilaterals with straight or curved edges.
        size: m, or a function that returns it at points of shape (2, n), such as
            `lacore.model.meshes.element_sizes`.
        keep: vertices to keep, on the outline or inside.
        keep_edges: names of boundaries whose edges are kept.
        keep_regions: names of regions (`mesh.subdomains`) to keep.

    Raises:
        InputError: gmsh is missing or fails; a size that is not positive; no vertex at a place, or
            an unknown boundary.

    Example:
        >>> mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2)
        >>> sorted(la.meshes.remeshed(mesh, size=0.5).boundaries)  # as before
        ['bottom', 'left', 'right', 'top']
    """
    if callable(size):
        sizes = size
    else:
        require_positive("size", size)
        sizes = Uniform(size)
    for name in keep_edges:
        require_known("keep_edges", name, mesh.boundaries or {})
    for name in keep_regions:
        require_known("keep_regions", name, mesh.subdomains or {})
    held = [np.asarray(mesh.boundaries[name], dtype=np.int64) for name in keep_edges]
    held_edges = np.unique(np.concatenate([[], *held]))
    kept = np.reshape(np.array(keep, dtype=float), (-1, 2))
    regions = {name: np.asarray(mesh.subdomains[name]) for name in keep_regions}
    part = _parts(mesh, regions)
    _require_vertices(mesh, kept)
    pieces = []
    for number in range(part.max() + 1):
        outlines, inside = _outlines(mesh, part, number, sizes, kept, held_edges)
        lines = apart([outline.start for outline in outlines])
        points, triangles = triangulated(lines, inside, sizes)
        points[: sum(map(len, lines))] = np.concatenate([outline.start for outline in outlines])
        pieces.append(_Piece(outlines, points, triangles))
    return _joined(mesh, pieces, {name: np.unique(part[own]) for name, own in regions.items()})


@dataclass(frozen=True)
class _Piece:
    """New triangles of one part.

    Attributes:
        outlines: outlines, the outermost first.
        points: points (n, 2), those of the outlines first.
        triangles: shape (m, 3).
    """

    outlines: list[_Outline]
    points: Floats
    triangles: Ints

    @property
    def edges(self) -> tuple[Ints, Ints, Floats]:
        """Edges of the outlines: ends (n, 2), old facets (n,) and midside nodes (n, 2)."""
        ends, first = [], 0
        for outline in self.outlines:
            turn = first + np.arange(len(outline.start))
            ends.append(np.stack([turn, np.roll(turn, -1)], axis=1))
            first += len(outline.start)
        old, middle = (
            np.concatenate([getattr(own, name) for own in self.outlines])
            for name in ("old", "middle")
        )
        return np.concatenate(ends), old, middle


def _parts(mesh: Mesh, regions: Mapping[str, Ints]) -> Ints:
    """Return the connected part of a region, or of the rest, of each element."""
    owner = np.zeros((mesh.nelements, len(regions)), dtype=bool)
    for number, elements in enumerate(regions.values()):
        owner[elements, number] = True
    inner = mesh.f2t[:, mesh.f2t[1] >= 0]
    links = inner[:, (owner[inner[0]] == owner[inner[1]]).all(axis=1)]
    graph = coo_matrix((np.ones(links.shape[1]), links), shape=(mesh.nelements,) * 2)
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _require_vertices(mesh: Mesh, keep: Floats) -> None:
    """Raise `InputError` if a place to keep has no vertex."""
    far = _SAME * float(np.linalg.norm(np.ptp(mesh.p, axis=1)))
    for place in keep.tolist():
        if np.linalg.norm(vertices(mesh).T - place, axis=1).min() > far:
            raise InputError("keep", tuple(place), "no vertex is there", "give one of the mesh")


def _joined(mesh: Mesh, pieces: Sequence[_Piece], regions: Mapping[str, Ints]) -> MeshTri2:
    """Return one mesh of all pieces, with the names of an old mesh.

    Args:
        mesh: the old one.
        pieces: pieces of its parts.
        regions: numbers of the pieces by name.

    Raises:
        InputError: two pieces divide the line between them differently.
    """
    first = np.cumsum([0, *(len(own.points) for own in pieces)])
    edges = [own.edges for own in pieces]
    ends = np.concatenate([own + start for (own, _, _), start in zip(edges, first, strict=False)])
    old, middle = (np.concatenate([own[which] for own in edges]) for which in (1, 2))
    points = np.concatenate([own.points for own in pieces])
    number = _merged(points, np.unique(ends[mesh.f2t[1, old] >= 0]), mesh)
    _, used = np.unique(number, return_index=True)
    triangles = np.concatenate(
        [own.triangles + start for own, start in zip(pieces, first, strict=False)]
    )
    straight = MeshTri1(points[used].T.copy(), np.ascontiguousarray(number[triangles].T))
    known = {pair: facet for facet, pair in enumerate(map(tuple, straight.facets.T.tolist()))}
    new = np.array([known[low, high] for low, high in np.sort(number[ends], axis=1).tolist()])
    curved = MeshTri2.from_mesh(straight)
    places = curved.doflocs.copy()
    places[:, curved.nvertices + new] = middle.T
    boundaries = {
        name: np.unique(new[np.isin(old, np.asarray(facets))])
        for name, facets in (mesh.boundaries or {}).items()
    }
    found = _upright(MeshTri2(places, curved.t)).with_boundaries(boundaries)
    if not regions:
        return found
    piece = np.repeat(np.arange(len(pieces)), [len(own.triangles) for own in pieces])
    return found.with_subdomains(
        {n: np.flatnonzero(np.isin(piece, own)) for n, own in regions.items()}
    )


def _merged(points: Floats, between: Ints, mesh: Mesh) -> Ints:
    """Return the numbers of points (n, 2), equal for points of several parts at one place.

    Args:
        points: points of all parts, one part after the other.
        between: those that lie on lines between two parts.
        mesh: the old one.

    Raises:
        InputError: a point between parts is in only one of them.
    """
    far = _SAME * float(np.linalg.norm(np.ptp(mesh.p, axis=1)))
    near = cKDTree(points[between]).query_pairs(far) if between.size else set()
    same = between[np.array(sorted(near), dtype=np.int64).reshape(-1, 2)]
    if np.setdiff1d(between, same).size:
        raise InputError(
            "remeshed",
            "size",
            "two regions would divide the line between them differently",
            "give a smaller size",
        )
    graph = coo_matrix((np.ones(len(same)), same.T), shape=(len(points),) * 2)
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _upright(mesh: MeshTri2) -> MeshTri2:
    """Return the mesh with straighter edges where its elements would be inverted."""
    places = mesh.doflocs.copy()
    for share in (0.5, 0.5, 0.5, 0.0):
        values = jacobians(replace(mesh, doflocs=places))
        bad = np.flatnonzero(values.min(axis=1) < _LEAST_JACOBIAN * values.mean(axis=1))
        if not bad.size:
            break
        edges = np.unique(mesh.t2f[:, bad])
        centre = places[:, mesh.facets[:, edges]].mean(axis=1)
        middle = mesh.nvertices + edges
        places[:, middle] = centre + share * (places[:, middle] - centre)
    return replace(mesh, doflocs=places)


def _outlines(
    mesh: Mesh, part: Ints, number: int, sizes: Sizes, keep: Floats, held: Ints
) -> tuple[list[_Outline], Floats]:
    """Return the outlines of a part, the outermost first, and the kept vertices inside of it.

    Args:
        mesh: the old one.
        part: number of the part that each element belongs to.
        number: number of the part.
        sizes: sizes of the new edges.
        keep: vertices to keep, (n, 2).
        held: edges to keep.
    """
    far = _SAME * float(np.linalg.norm(np.ptp(mesh.p, axis=1)))
    own = part == number
    sides = np.where(mesh.f2t >= 0, part[mesh.f2t], -1)  # parts on both sides of each facet
    outer = np.flatnonzero((sides == number).any(axis=0) & (sides != number).any(axis=0))
    beyond = np.where(sides[0] == number, sides[1], sides[0])
    numbers, names = np.arange(mesh.nfacets), (mesh.boundaries or {}).values()
    labels = np.array([beyond, *(np.isin(numbers, np.asarray(facets)) for facets in names)])
    left = np.ones(len(keep), dtype=bool)
    found = []
    for facets, forward in _loops(mesh, outer):
        curves = edge_curves(mesh, facets)
        curves = EdgeCurves(
            np.where(forward, curves.start, curves.end),
            curves.middle,
            np.where(forward, curves.end, curves.start),
        )
        first, last = (own / np.linalg.norm(own, axis=0) for own in map(curves.tangent, (0.0, 1.0)))
        breaks = np.sum(first * np.roll(last, 1, axis=1), axis=0) < _CORNER
        there = labels[:, facets]
        breaks |= np.any(there != np.roll(there, 1, axis=1), axis=0)
        fixed = np.isin(facets, held)
        breaks |= fixed | np.roll(fixed, 1)
        near = np.linalg.norm(curves.start.T[:, None] - keep[None], axis=2) <= far
        breaks |= near.any(axis=1)
        left &= ~near.any(axis=0)
        breaks[0] |= not breaks.any()
        found.append(_divided(curves, facets, np.flatnonzero(breaks), fixed, sizes))
    corners = vertices(mesh)[:, np.unique(mesh.t[:, own])].T
    left &= np.array([np.linalg.norm(corners - place, axis=1).min() <= far for place in keep], bool)
    areas = [abs(shapely.area(shapely.polygons(line.start))) for line in found]
    return [found[which] for which in np.argsort(areas)[::-1]], keep[left]


def _loops(mesh: Mesh, facets: Ints) -> list[tuple[Ints, Bools]]:
    """Return the facets of closed lines in order, and whether each runs from start to end."""
    ends = mesh.facets[:, facets]
    at: dict[int, list[int]] = {}
    for number, pair in enumerate(ends.T.tolist()):
        for vertex in pair:
            at.setdefault(vertex, []).append(number)
    left, loops = set(range(facets.size)), []
    while left:
        number = min(left)
        order, forward, vertex = [], [], int(ends[0, number])
        while number in left:
            left.remove(number)
            order.append(number)
            forward.append(int(ends[0, number]) == vertex)
            vertex = int(ends[1, number] if forward[-1] else ends[0, number])
            number = next((own for own in at[vertex] if own in left), number)
        loops.append((facets[np.array(order)].astype(np.int64), np.array(forward)))
    return loops


def _divided(
    curves: EdgeCurves, facets: Ints, breaks: Ints, fixed: Bools, sizes: Sizes
) -> _Outline:
    """Return the sides between breaks, each divided by the sizes along it.

    Args:
        curves: edges, each of which starts at the end of the last.
        facets: their numbers.
        breaks: edges with which a side starts.
        fixed: edges that are not divided.
        sizes: sizes of the new edges.
    """
    count = facets.size
    least = -(-_LEAST // breaks.size)  # edges of a side, so that a closed line has three
    starts, middles, old = [], [], []
    for begin, end in zip(breaks, [*breaks[1:], breaks[0] + count], strict=True):
        edges = np.arange(begin, end) % count
        if fixed[begin]:
            starts.append(curves.start[:, edges].T)
            middles.append(curves.middle[:, edges].T)
            old.append(facets[edges])
            continue
        side = EdgeCurves(curves.start[:, edges], curves.middle[:, edges], curves.end[:, edges])
        places = np.append(np.arange(0, edges.size, 1 / _SAMPLES), edges.size)  # edge + parameter
        points = _on(side, places)
        lengths = np.linalg.norm(np.diff(points, axis=1), axis=0)
        densities = 1 / sizes(points)
        marks = np.append(0.0, np.cumsum(lengths * (densities[1:] + densities[:-1]) / 2))
        parts = max(int(np.ceil(marks[-1] - _SAME)), least)
        ends = np.interp(np.linspace(0.0, marks[-1], parts + 1), marks, places)
        at = _on(side, ends)
        starts.append(at[:, :-1].T)
        middles.append(_middles(side, at, ends).T)
        halves = (ends[1:] + ends[:-1]) / 2
        old.append(facets[edges[halves.astype(np.int64).clip(max=edges.size - 1)]])
    return _Outline(np.concatenate(starts), np.concatenate(middles), np.concatenate(old))


def _on(side: EdgeCurves, places: Floats) -> Floats:
    """Return the points of a side, shape (2, n), by edge number plus parameter."""
    edge = places.astype(np.int64).clip(max=side.start.shape[1] - 1)
    own = EdgeCurves(side.start[:, edge], side.middle[:, edge], side.end[:, edge])
    return own.at(places - edge)


def _middles(side: EdgeCurves, at: Floats, ends: Floats) -> Floats:
    """Return the midside nodes of new edges between points of a side, with the same area.

    A quadratic edge encloses 2/3 of its bulge times its chord. A part of a single old edge follows
    that edge: its middle is that of the parameter, which may lie off the middle of the chord.
    """
    numbers = np.arange(side.start.shape[1])
    swept = np.append(0.0, np.cumsum(_swept(side, numbers, np.ones(numbers.size))))
    edge = ends.astype(np.int64).clip(max=numbers.size - 1)
    until = swept[edge] + _swept(side, edge, ends - edge)
    start, end = at[:, :-1], at[:, 1:]
    area = np.diff(until) - (start[0] * end[1] - start[1] * end[0]) / 2
    chord = end - start
    squared = np.sum(chord**2, axis=0)
    outwards = np.stack([chord[1], -chord[0]]) / squared
    centre = (start + end) / 2
    part = np.ceil(ends[1:]) - np.floor(ends[:-1]) <= 1
    along = np.sum((_on(side, (ends[1:] + ends[:-1]) / 2) - centre) * chord, axis=0) / squared
    return np.asarray(centre + 1.5 * area * outwards + np.where(part, along, 0.0) * chord)


def _swept(side: EdgeCurves, edge: Ints, s: Floats) -> Floats:
    """Return the areas that the line from the origin sweeps along edges up to parameters, m^2."""
    own = EdgeCurves(side.start[:, edge], side.middle[:, edge], side.end[:, edge])
    area = np.zeros(edge.size)
    for share in _GAUSS:  # exact, since the integrand is a cubic
        x, y = own.at(share * s)
        dx, dy = own.tangent(share * s)
        area += s * (x * dy - y * dx) / 4
    return area
