"""Closed outlines: drawn ones, and those that lines of a layer enclose."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from lacore.model.bodies.blocks.drawings.snapping import on_edges, unique_edges
from lacore.model.bodies.blocks.drawings.strokes import place_told, refused
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact
from lacore.reporting.text import Quantity, text


@dataclass(frozen=True, eq=False, repr=False)
class Chain(Compact):
    """Stroke as numbers of merged vertices, without repetitions in a row.

    Attributes:
        layer, handle: layer and handle of the stroke.
        vertices: (k,).
        closed: whether the last is joined to the first.
    """

    layer: str
    handle: str
    vertices: Ints
    closed: bool

    @property
    def told(self) -> str:
        """``layer 'stone', handle 2F``."""
        return f"layer {self.layer!r}, handle {self.handle}"

    @property
    def edges(self) -> Ints:
        """Pairs of vertices, (e, 2)."""
        own = self.vertices
        if self.closed:
            return np.stack([own, np.roll(own, -1)], axis=1)
        return np.stack([own[:-1], own[1:]], axis=1)


def chain(layer: str, handle: str, vertices: Ints, closed: bool) -> Chain:
    """Return a stroke with merged vertices; one that ends where it starts is closed."""
    kept = vertices[np.append(True, vertices[1:] != vertices[:-1])]
    if kept.size > 1 and kept[0] == kept[-1]:
        kept, closed = kept[:-1], True
    return Chain(layer, handle, kept, closed)


def enclosed(
    path: str, lines: Sequence[Chain], crossed: Ints, place: Floats, snap: float
) -> list[Chain]:
    """Return the faces of the open lines of one layer: blocks between joints drawn once.

    Lines are cut where vertices of others lie on them. Each must be part of the outline of a face.

    Args:
        path: path of the file, for messages.
        lines: lines of one layer.
        crossed: vertices where lines cross, (k,).
        place: places of all vertices, (2, m), m.
        snap: m.

    Raises:
        InputError: lines that end without meeting another.
    """
    drawn = np.concatenate([line.edges for line in lines])
    edges = unique_edges(drawn)
    vertex, edge = on_edges(place, np.union1d(edges, crossed), edges, snap)
    parts = unique_edges(_split(edges, vertex, edge, place))
    faces, *bad = shapely.polygonize_full(shapely.linestrings(place.T[parts]))
    loose = [line for kind in bad for line in shapely.get_parts(kind)]
    if loose:
        raise _open(path, lines, place, parts, len(loose), snap)
    number = {tuple(own): n for n, own in enumerate(place.T.tolist())}
    handles = _handles(lines, edges, vertex, edge, place)
    closed = []
    for face in shapely.get_parts(faces):
        ring = shapely.get_exterior_ring(face)
        own = np.array([number[tuple(at)] for at in shapely.get_coordinates(ring)[:-1].tolist()])
        pairs = unique_edges(np.stack([own, np.roll(own, -1)], axis=1)).tolist()
        named = sorted({name for pair in pairs for name in handles[tuple(pair)]})
        found = Chain(lines[0].layer, ", ".join(named), own, closed=True)
        if shapely.get_num_interior_rings(face):
            raise refused(
                path,
                found.told,
                text("lines around {} enclose an area with a hole", place_told(place[:, own[0]])),
                "cut the block there, or draw what is inside in another layer",
            )
        closed.append(found)
    return closed


def _split(edges: Ints, vertex: Ints, edge: Ints, place: Floats) -> Ints:
    """Return the edges (e, 2) cut at vertices that lie on them: pairs of vertices."""
    every = np.arange(len(edges))
    owner = np.concatenate([every, every, edge])
    stop = np.concatenate([edges[:, 0], edges[:, 1], vertex])
    start, end = place[:, edges[owner, 0]], place[:, edges[owner, 1]]
    along = np.sum((place[:, stop] - start) * (end - start), axis=0)
    order = np.lexsort((along, owner))
    owner, stop = owner[order], stop[order]
    same = owner[1:] == owner[:-1]
    return np.stack([stop[:-1][same], stop[1:][same]], axis=1)


def _handles(
    lines: Sequence[Chain], edges: Ints, vertex: Ints, edge: Ints, place: Floats
) -> dict[tuple[int, int], set[str]]:
    """Return the handles of the lines that each part of an edge belongs to."""
    drawn: dict[tuple[int, int], set[str]] = {}
    for line in lines:
        for pair in unique_edges(line.edges).tolist():
            drawn.setdefault((pair[0], pair[1]), set()).add(line.handle)
    found: dict[tuple[int, int], set[str]] = {}
    for number, pair in enumerate(edges.tolist()):
        own = vertex[edge == number]
        zeros = np.zeros(own.size, dtype=np.int64)
        for part in unique_edges(_split(edges[[number]], own, zeros, place)).tolist():
            found.setdefault((part[0], part[1]), set()).update(drawn[pair[0], pair[1]])
    return found


def _open(
    path: str, lines: Sequence[Chain], place: Floats, parts: Ints, loose: int, snap: float
) -> InputError:
    """Return the error for lines that are not part of an outline; it names one."""
    ends = np.flatnonzero(np.bincount(parts.ravel()) == 1)
    why = f"a line that closes no outline (such parts of lines: {loose})"
    fix = "close it, give a larger snap, or draw what is no outline in another layer"
    if not ends.size:  # It leads from one outline to another.
        return refused(path, lines[0].told, why, fix)
    end = ends[0]
    joined = parts[(parts == end).any(axis=1)]
    others = np.setdiff1d(parts, joined)
    gap = np.linalg.norm(place[:, others].T - place[:, end], axis=1).min(initial=np.inf)
    near = text(", {} from the next vertex", Quantity(float(gap), "m", ".3g"))
    owner = next(line for line in lines if end in line.vertices)
    told = text(
        "{}: it ends at {}{}; snap is {}",
        why,
        place_told(place[:, end]),
        near if np.isfinite(gap) else "",
        Quantity(snap, "m", ".3g"),
    )
    return refused(path, owner.told, told, fix)


def simplified(ring: Ints, place: Floats, snap: float) -> Ints:
    """Return the corners of a ring, without vertices within the snap of the line of the others.

    It starts at the vertex that is farthest off the line of its neighbours, which is a corner.
    """
    if ring.size < 4:
        return ring
    own = place[:, ring]
    chord, away = np.roll(own, -1, axis=1) - np.roll(own, 1, axis=1), own - np.roll(own, 1, axis=1)
    length = np.maximum(np.linalg.norm(chord, axis=0), np.finfo(float).tiny)
    off = np.abs(chord[0] * away[1] - chord[1] * away[0]) / length
    ring = np.roll(ring, -int(np.argmax(off)))
    number = {tuple(place[:, own].tolist()): own for own in ring.tolist()}
    outline = shapely.linestrings(place.T[np.append(ring, ring[0])])
    simple = shapely.simplify(outline, snap, preserve_topology=False)
    corners = shapely.get_coordinates(simple)[:-1].tolist()
    if len(corners) < 3:
        return ring  # thinner than the snap, which is rejected later
    return np.array([number[tuple(corner)] for corner in corners])


def crossings(segments: Floats) -> Floats:
    """Return the places (k, 2) where segments (n, 2, 2) cross inside both."""
    lines = shapely.linestrings(segments)
    one, other = shapely.STRtree(lines).query(lines, predicate="crosses")
    pairs = one < other
    met = shapely.intersection(lines[one[pairs]], lines[other[pairs]])
    return np.asarray(shapely.get_coordinates(met[shapely.get_type_id(met) == 0]))
