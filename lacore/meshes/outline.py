"""A new mesh inside the outline of an old one, by gmsh (the optional dependency ``gmsh``)."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from skfem import Mesh
from skfem.mesh import MeshTri1, MeshTri2

from lacore.arrays import Bools, Floats, Ints
from lacore.errors import InputError, install_command, require_positive, typed
from lacore.meshes.curved import edge_curves

_CORNER = np.cos(np.radians(20.0))  # between edges that are parts of one smooth side
_SAMPLES = np.linspace(0.0, 1.0, 9)[:-1]  # of an old edge
_SAME = 1e-9  # of the size of the mesh


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
def remeshed(mesh: Mesh, size: float, keep: Sequence[tuple[float, float]] = ()) -> MeshTri2:
    """Triangles of a length `size` in the outline of a mesh, with its boundary names.

    Corners, ends of named boundaries and the vertices in `keep` stay vertices. Between them edges
    are about as long as `size`, with vertices and midside nodes on the old outline.

    Args:
        mesh: of triangles or quadrilaterals, edges straight or curved.
        size: m.
        keep: vertices on the outline.

    Raises:
        InputError: gmsh is missing or fails; a size that is not positive; no vertex at a place.

    Example:
        >>> mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2)
        >>> sorted(la.meshes.remeshed(mesh, size=0.5).boundaries)  # as before
        ['bottom', 'left', 'right', 'top']
    """
    require_positive("size", size)
    outlines = _outlines(mesh, size, np.reshape(np.array(keep, dtype=float), (-1, 2)))
    points, triangles = _triangulated(outlines, size)
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
    return MeshTri2(places, curved.t).with_boundaries(names)


def _outlines(mesh: Mesh, size: float, keep: Floats) -> list[_Outline]:
    """Those of a mesh, the outermost first."""
    far = _SAME * float(np.linalg.norm(np.ptp(mesh.p, axis=1)))
    numbers, names = np.arange(mesh.nfacets), (mesh.boundaries or {}).values()
    named = np.array([np.isin(numbers, np.asarray(facets)) for facets in names])
    left = np.ones(len(keep), dtype=bool)
    found = []
    for facets, forward in _loops(mesh):
        curves = edge_curves(mesh, facets)
        shares = np.where(forward[:, None], _SAMPLES, 1 - _SAMPLES)  # (edges, samples)
        lines = np.stack([curves.at(s) for s in shares.T]).transpose(2, 0, 1)  # (edges, samples, 2)
        first = curves.tangent(np.where(forward, 0.0, 1.0)) * np.where(forward, 1, -1)
        last = curves.tangent(np.where(forward, 1.0, 0.0)) * np.where(forward, 1, -1)
        first, last = (own / np.linalg.norm(own, axis=0) for own in (first, last))
        breaks = np.sum(first * np.roll(last, 1, axis=1), axis=0) < _CORNER
        if named.size:
            own = named[:, facets]
            breaks |= np.any(own != np.roll(own, 1, axis=1), axis=0)
        near = np.linalg.norm(lines[:, None, 0] - keep[None], axis=2) <= far
        breaks |= near.any(axis=1)
        left &= ~near.any(axis=0)
        breaks[0] |= not breaks.any()
        found.append(_divided(lines, facets, np.flatnonzero(breaks), size))
    if left.any():
        place = tuple(keep[left][0].tolist())
        raise InputError("keep", place, "no vertex of the outline is there", "give one that is")
    areas = [abs(shapely.area(shapely.polygons(own.start))) for own in found]
    return [found[number] for number in np.argsort(areas)[::-1]]


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


def _divided(lines: Floats, facets: Ints, breaks: Ints, size: float) -> _Outline:
    """Sides between breaks, each divided evenly."""
    count = len(lines)
    starts, middles, old = [], [], []
    for begin, end in zip(breaks, [*breaks[1:], breaks[0] + count], strict=True):
        edges = np.arange(begin, end) % count
        points = [*lines[edges].reshape(-1, 2), lines[end % count, 0]]
        side = shapely.LineString(points)
        # Places of old vertices along the side, to find the facet of each new edge.
        ends = [np.concatenate([lines[e], lines[(e + 1) % count, :1]]) for e in edges]
        marks = np.cumsum(shapely.length(shapely.linestrings(ends)))
        parts = max(int(np.ceil(side.length / size)), 1)
        at = np.linspace(0.0, side.length, 2 * parts + 1)
        places = shapely.get_coordinates(shapely.line_interpolate_point(side, at))
        starts.append(places[:-1:2])
        middles.append(places[1::2])
        inside = np.searchsorted(marks, at[1::2]).clip(max=len(edges) - 1)
        old.append(facets[edges[inside]])
    return _Outline(np.concatenate(starts), np.concatenate(middles), np.concatenate(old))


def _triangulated(outlines: Sequence[_Outline], size: float) -> tuple[Floats, Ints]:
    """Points (n, 2), those of the outlines first, and triangles (m, 3), by gmsh."""
    gmsh = _gmsh()
    ours = not gmsh.isInitialized()
    if ours:
        with _pipes_as_before():
            gmsh.initialize(interruptible=False)
        gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("remeshed")
    try:
        geometry, loops, corners = gmsh.model.geo, [], []
        for outline in outlines:
            tags = [geometry.addPoint(x, y, 0, size) for x, y in outline.start.tolist()]
            pairs = zip(tags, tags[1:] + tags[:1], strict=True)
            sides = [geometry.addLine(one, two) for one, two in pairs]
            for side in sides:
                geometry.mesh.setTransfiniteCurve(side, 2)  # one edge
            loops.append(geometry.addCurveLoop(sides))
            corners += tags
        geometry.addPlaneSurface(loops)
        geometry.synchronize()
        gmsh.model.mesh.generate(2)
        nodes, places, _ = gmsh.model.mesh.getNodes()
        _, used = gmsh.model.mesh.getElementsByType(2)
        first = [int(gmsh.model.mesh.getNodes(0, tag)[0][0]) for tag in corners]
    except Exception as error:  # gmsh has no other
        raise InputError("remeshed", str(error), "gmsh failed", "give another size") from error
    finally:
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


def _gmsh() -> Any:
    try:
        import gmsh
    except (ImportError, OSError) as error:  # OSError: it lacks libraries of the system
        raise InputError(
            "remeshed", None, f"gmsh cannot be loaded ({error})", install_command("gmsh")
        ) from error
    return gmsh
