"""A new mesh inside the outline of an old one, by gmsh (the optional dependency ``gmsh``)."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from skfem import Mesh
from skfem.mesh import MeshTri1, MeshTri2

from lacore.arrays import Bools, Floats, Ints
from lacore.errors import (
    InputError,
    install_command,
    require_known,
    require_positive,
    typed,
)
from lacore.meshes.curved import EdgeCurves, edge_curves, jacobians, vertices
from lacore.meshes.renewal.sizes import Sizes

_CORNER = np.cos(np.radians(20.0))  # between edges that are parts of one smooth side
_SAMPLES = 8  # parts of an old edge, in which its length is measured
_SAME = 1e-9  # of the size of the mesh
_LEAST_JACOBIAN = 0.1  # of its mean in an element: below, edges are made straighter
_LEAST = 3  # edges of a closed line
_INWARDS = 0.05  # of an edge: how far vertices are moved where a body is in contact with itself
_GAUSS = np.array([1 - 1 / np.sqrt(3), 1 + 1 / np.sqrt(3)]) / 2


@dataclass(frozen=True)
class _Uniform:
    """The same size everywhere."""

    size: float

    def __call__(self, points: Floats) -> Floats:
        return np.full(points.shape[1], self.size)


@dataclass(frozen=True)
class _Outline:
    """New edges of one closed line, in turn.

    Attributes:
        start, middle: of each, shape (n, 2): the next one starts where it ends.
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
) -> MeshTri2:
    """Triangles of a length `size` in the outline of a mesh, with its boundary names.

    Corners, ends of named boundaries and the vertices in `keep` stay vertices. Between them edges
    are about as long as `size`. Their vertices lie on the old outline, and their midside nodes are
    placed so that the area stays the same, unless this would invert an element.

    Args:
        mesh: of triangles or quadrilaterals, edges straight or curved.
        size: m, or a function that returns it at points of shape (2, n), such as
            `lacore.meshes.element_sizes`.
        keep: vertices, on the outline or inside.
        keep_edges: names of boundaries whose edges stay as they are.

    Raises:
        InputError: gmsh is missing or fails; a size that is not positive; no vertex at a place, no
            boundary of a name.

    Example:
        >>> mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2)
        >>> sorted(la.meshes.remeshed(mesh, size=0.5).boundaries)  # as before
        ['bottom', 'left', 'right', 'top']
    """
    if callable(size):
        sizes = size
    else:
        require_positive("size", size)
        sizes = _Uniform(size)
    for name in keep_edges:
        require_known("keep_edges", name, mesh.boundaries or {})
    held = [np.asarray(mesh.boundaries[name], dtype=np.int64) for name in keep_edges]
    kept = np.reshape(np.array(keep, dtype=float), (-1, 2))
    outlines, inside = _outlines(mesh, sizes, kept, np.unique(np.concatenate([[], *held])))
    lines = _apart([outline.start for outline in outlines])
    points, triangles = _triangulated(lines, inside, sizes)
    points[: sum(map(len, lines))] = np.concatenate([outline.start for outline in outlines])
    straight = MeshTri1(np.ascontiguousarray(points.T), np.ascontiguousarray(triangles.T))
    known = {ends: facet for facet, ends in enumerate(map(tuple, straight.facets.T.tolist()))}
    new, old, first = [], [], 0
    for outline in outlines:
        count = len(outline.start)
        turn = first + np.arange(count)
        ends = np.sort(np.stack([turn, np.roll(turn, -1)], axis=1), axis=1)
        new += [known[start, end] for start, end in ends.tolist()]
        old += outline.old.tolist()
        first += count
    curved = MeshTri2.from_mesh(straight)
    places = curved.doflocs.copy()
    middle = np.concatenate([outline.middle for outline in outlines])
    places[:, curved.nvertices + np.array(new)] = middle.T
    names = {
        name: np.array(new)[np.isin(old, np.asarray(facets))]
        for name, facets in (mesh.boundaries or {}).items()
    }
    return _upright(MeshTri2(places, curved.t)).with_boundaries(names)


def _upright(mesh: MeshTri2) -> MeshTri2:
    """The mesh with straighter edges on the outline where its elements would be inverted."""
    places = mesh.doflocs.copy()
    for share in (0.5, 0.5, 0.5, 0.0):
        values = jacobians(replace(mesh, doflocs=places))
        bad = np.flatnonzero(values.min(axis=1) < _LEAST_JACOBIAN * values.mean(axis=1))
        if not bad.size:
            break
        edges = np.intersect1d(mesh.t2f[:, bad], mesh.boundary_facets())
        centre = places[:, mesh.facets[:, edges]].mean(axis=1)
        middle = mesh.nvertices + edges
        places[:, middle] = centre + share * (places[:, middle] - centre)
    return replace(mesh, doflocs=places)


def _outlines(mesh: Mesh, sizes: Sizes, keep: Floats, held: Ints) -> tuple[list[_Outline], Floats]:
    """Those of a mesh, the outermost first; and the kept vertices that are on none."""
    far = _SAME * float(np.linalg.norm(np.ptp(mesh.p, axis=1)))
    numbers, names = np.arange(mesh.nfacets), (mesh.boundaries or {}).values()
    named = np.array([np.isin(numbers, np.asarray(facets)) for facets in names])
    left = np.ones(len(keep), dtype=bool)
    found = []
    for facets, forward in _loops(mesh):
        curves = edge_curves(mesh, facets)
        curves = EdgeCurves(
            np.where(forward, curves.start, curves.end),
            curves.middle,
            np.where(forward, curves.end, curves.start),
        )
        first, last = (own / np.linalg.norm(own, axis=0) for own in map(curves.tangent, (0.0, 1.0)))
        breaks = np.sum(first * np.roll(last, 1, axis=1), axis=0) < _CORNER
        if named.size:
            own = named[:, facets]
            breaks |= np.any(own != np.roll(own, 1, axis=1), axis=0)
        fixed = np.isin(facets, held)
        breaks |= fixed | np.roll(fixed, 1)
        near = np.linalg.norm(curves.start.T[:, None] - keep[None], axis=2) <= far
        breaks |= near.any(axis=1)
        left &= ~near.any(axis=0)
        breaks[0] |= not breaks.any()
        found.append(_divided(curves, facets, np.flatnonzero(breaks), fixed, sizes))
    inside = keep[left]
    for place in inside.tolist():
        if np.linalg.norm(vertices(mesh).T - place, axis=1).min() > far:
            raise InputError("keep", tuple(place), "no vertex is there", "give one of the mesh")
    areas = [abs(shapely.area(shapely.polygons(own.start))) for own in found]
    return [found[number] for number in np.argsort(areas)[::-1]], inside


def _loops(mesh: Mesh) -> list[tuple[Ints, Bools]]:
    """Boundary facets in turn, and whether each is run through from its start to its end."""
    facets = mesh.boundary_facets()
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
    """Sides between breaks, each divided by the sizes along it.

    Args:
        curves: edges, each of which starts where the one before ends.
        facets: their numbers.
        breaks: edges with which a side starts.
        fixed: edges that are not divided.
        sizes: of the new edges.
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
    """Points of a side, shape (2, n), by number of the edge plus parameter on it."""
    edge = places.astype(np.int64).clip(max=side.start.shape[1] - 1)
    own = EdgeCurves(side.start[:, edge], side.middle[:, edge], side.end[:, edge])
    return own.at(places - edge)


def _middles(side: EdgeCurves, at: Floats, ends: Floats) -> Floats:
    """Midside nodes of new edges between points of a side, which enclose the same area with it.

    A quadratic edge encloses 2/3 of its bulge times its chord. A part of one old edge is that edge
    again: its middle is that of the parameter, which may lie off the middle of the chord.
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
    """Areas that the line from the origin sweeps along edges up to parameters, m^2."""
    own = EdgeCurves(side.start[:, edge], side.middle[:, edge], side.end[:, edge])
    area = np.zeros(edge.size)
    for share in _GAUSS:  # exact: the integrand is a cubic
        x, y = own.at(share * s)
        dx, dy = own.tangent(share * s)
        area += s * (x * dy - y * dx) / 4
    return area


def _apart(lines: list[Floats]) -> list[Floats]:
    """Closed lines that do not cross, the outermost first.

    Where a body is in contact with itself they do, by little. Gmsh would not end then: all vertices
    are moved into the body.

    Raises:
        InputError: they still cross.
    """
    if shapely.is_valid(shapely.Polygon(lines[0], lines[1:])):
        return lines
    moved = []
    for number, line in enumerate(lines):
        along = np.roll(line, -1, axis=0) - np.roll(line, 1, axis=0)
        inwards = np.stack([-along[:, 1], along[:, 0]], axis=1)
        if shapely.LinearRing(line).is_ccw == (number > 0):
            inwards = -inwards
        moved.append(line + _INWARDS * inwards / 2)
    if not shapely.is_valid(shapely.Polygon(moved[0], moved[1:])):
        raise InputError(
            "remeshed",
            None,
            "the outline crosses itself, and gmsh needs one that does not",
            "give a smaller size, or end the path before",
        )
    return moved


def _triangulated(lines: Sequence[Floats], inside: Floats, sizes: Sizes) -> tuple[Floats, Ints]:
    """Points (n, 2), those of the closed lines first, and triangles (m, 3), by gmsh."""
    gmsh = load_gmsh()
    ours = not gmsh.isInitialized()
    if ours:
        with _pipes_as_before():
            gmsh.initialize(interruptible=False)
        gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("remeshed")
    try:
        geometry, loops, corners = gmsh.model.geo, [], []
        for line in lines:
            starts = zip(line.tolist(), sizes(line.T).tolist(), strict=True)
            tags = [geometry.addPoint(x, y, 0, size) for (x, y), size in starts]
            pairs = zip(tags, tags[1:] + tags[:1], strict=True)
            sides = [geometry.addLine(one, two) for one, two in pairs]
            for side in sides:
                geometry.mesh.setTransfiniteCurve(side, 2)  # one edge
            loops.append(geometry.addCurveLoop(sides))
            corners += tags
        surface = geometry.addPlaneSurface(loops)
        held = [geometry.addPoint(x, y, 0) for x, y in inside.tolist()]
        geometry.synchronize()
        gmsh.model.mesh.embed(0, held, 2, surface)
        if not isinstance(sizes, _Uniform):
            gmsh.model.mesh.setSizeCallback(
                lambda dim, tag, x, y, z, size: float(sizes(np.array([[x], [y]]))[0])
            )
        gmsh.model.mesh.generate(2)
        nodes, places, _ = gmsh.model.mesh.getNodes()
        _, used = gmsh.model.mesh.getElementsByType(2)
        first = [int(gmsh.model.mesh.getNodes(0, tag)[0][0]) for tag in corners]
    except Exception as error:  # gmsh has no other
        raise InputError("remeshed", str(error), "gmsh failed", "give another size") from error
    finally:
        gmsh.model.mesh.removeSizeCallback()
        gmsh.model.remove()
        if ours:
            gmsh.finalize()
    where = dict(zip(map(int, nodes), places.reshape(-1, 3)[:, :2], strict=True))
    inner = sorted(set(map(int, used)) - set(first))
    number = {tag: place for place, tag in enumerate([*first, *inner])}
    points = np.array([where[tag] for tag in number])
    return points, np.array([number[int(tag)] for tag in used], dtype=np.int64).reshape(-1, 3)


@contextmanager
def _pipes_as_before() -> Iterator[None]:
    """Undo what gmsh does when it starts: a pipe that nobody reads would end the process."""
    before = signal.getsignal(signal.SIGPIPE) if hasattr(signal, "SIGPIPE") else None
    try:
        yield
    finally:
        if before is not None and threading.current_thread() is threading.main_thread():
            signal.signal(signal.SIGPIPE, before)


def load_gmsh() -> Any:
    """Return the module `gmsh`.

    Raises:
        InputError: it is missing, or lacks libraries of the system.
    """
    try:
        import gmsh
    except (ImportError, OSError) as error:  # OSError: it lacks libraries of the system
        raise InputError(
            "remeshed", None, f"gmsh cannot be loaded ({error})", install_command("gmsh")
        ) from error
    return gmsh
