"""Outlines that meet, from drawn lines: merged, closed, straightened, in order."""

from collections import Counter
from collections.abc import Sequence, Set
from dataclasses import dataclass

import numpy as np
import shapely

from lacore.model.bodies.blocks.drawings.loops import Chain, chain, crossings, enclosed, simplified
from lacore.model.bodies.blocks.drawings.snapping import Merged, merged, straightened, unique_edges
from lacore.model.bodies.blocks.drawings.strokes import Stroke, place_told, refused
from lacore.model.bodies.blocks.overlap import overlap_told
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError
from lacore.reporting.text import Quantity, text

_WIDEST = 2.0  # in snaps: largest distance of merged vertices

_REACH = 2.0  # in snaps: largest distance of corners from an edge after vertices are merged
_SHARPEST = 10.0  # by half of the gap: longest corner of a widened outline
_SAME_COURSE = 0.25  # by the mean height of blocks


@dataclass(frozen=True)
class Outlines:
    """Closed outlines, by courses from below, and from left to right.

    Attributes:
        rings: numbers of vertices.
        place: places of the vertices, (2, m), m.
        moved: the farthest that a vertex of a block was moved, m.
        repeated: handles of blocks that are drawn several times.
    """

    rings: tuple[Chain, ...]
    place: Floats
    moved: float
    repeated: tuple[str, ...] = ()


def outlines(path: str, strokes: Sequence[Stroke], openings: Set[str], snap: float) -> Outlines:
    """Return the outlines of blocks from strokes in m.

    Args:
        path: path of the file, for messages.
        strokes: strokes of the layers of blocks and of openings.
        openings: layers of openings.
        snap: m: vertices closer than this are merged.

    Raises:
        InputError: lines that stay open, slivers, or overlaps.
    """
    points = np.concatenate([own.points for own in strokes])
    crossed = _crossings(strokes)
    vertices = merged(np.concatenate([points, *crossed.values()]), snap)
    ends = np.cumsum([len(own) for own in (*(own.points for own in strokes), *crossed.values())])
    numbers = np.split(vertices.number, ends[:-1])
    chains = [
        chain(own.layer, own.handle, number, own.closed)
        for own, number in zip(strokes, numbers, strict=False)
    ]
    _require_clear(path, chains, vertices, snap)
    met = dict(zip(crossed, numbers[len(strokes) :], strict=True))
    place = vertices.place
    rings = _closed(path, chains, met, place, snap, openings)
    # Before vertices are put on edges, which takes long where blocks are thinner than the snap.
    _require_blocks(path, rings, place, snap)
    edges = unique_edges(np.concatenate([own.edges for own in rings]))
    moved = straightened(place, np.unique(edges), edges, _REACH * snap)
    _require_blocks(path, rings, moved, snap)
    _require_apart(path, rings, moved, snap)
    far = _farthest(points, vertices, edges, moved)
    return Outlines(tuple(_ordered(rings, moved)), moved, far, _repeated(chains, rings))


def grown(found: Outlines, gap: float) -> list[Stroke]:
    """Return the outlines moved outwards by half of a gap (m), which closes it."""
    strokes = []
    for ring in found.rings:
        polygon = shapely.Polygon(found.place[:, ring.vertices].T)
        wider = shapely.buffer(polygon, gap / 2, join_style="mitre", mitre_limit=_SHARPEST)
        corners = shapely.get_coordinates(shapely.get_exterior_ring(wider))[:-1]
        strokes.append(Stroke(ring.layer, ring.handle, corners, closed=True))
    return strokes


def _repeated(chains: Sequence[Chain], rings: Sequence[Chain]) -> tuple[str, ...]:
    """Return the handles of blocks that are the outline of several closed lines."""
    drawn = Counter((own.layer, frozenset(own.vertices.tolist())) for own in chains if own.closed)
    twice = {key for key, count in drawn.items() if count > 1}
    return tuple(
        own.handle for own in rings if (own.layer, frozenset(own.vertices.tolist())) in twice
    )


def _crossings(strokes: Sequence[Stroke]) -> dict[str, Floats]:
    """Return the places (k, 2) where open lines of each layer cross."""
    found = {}
    for layer in sorted({own.layer for own in strokes if not own.closed}):
        parts = [
            np.stack([own.points[:-1], own.points[1:]], axis=1)
            for own in strokes
            if own.layer == layer and not own.closed
        ]
        found[layer] = crossings(np.concatenate(parts))
    return found


def _closed(
    path: str,
    chains: Sequence[Chain],
    crossed: dict[str, Ints],
    place: Floats,
    snap: float,
    openings: Set[str],
) -> list[Chain]:
    """Return the outlines of blocks: closed chains, and faces of open ones, without openings."""
    rings, holes = [], []
    # Openings come first, since faces of all other layers may lie in them.
    for layer in sorted({own.layer for own in chains}, key=lambda own: (own not in openings, own)):
        lines = [own for own in chains if own.layer == layer]
        closed = _corners([own for own in lines if own.closed], place, snap)
        faces = []
        if layer in crossed:
            found = enclosed(path, lines, crossed[layer], place, snap)
            faces = _others(path, _corners(found, place, snap), closed)
        if layer in openings:
            holes += [*closed, *faces]
            continue
        rings += closed
        rings += [face for face in faces if not _in_opening(face, holes, place)]
    if not rings:
        raise InputError("path", path, "its lines enclose no block", "name the layers of blocks")
    return rings


def _corners(rings: Sequence[Chain], place: Floats, snap: float) -> list[Chain]:
    """Return the rings without collinear vertices, and without duplicates in a layer."""
    once: dict[frozenset[int], Chain] = {}
    for own in rings:
        corners = simplified(own.vertices, place, snap)
        key = frozenset(corners.tolist())
        handle = own.handle
        if key in once:
            handle = ", ".join(sorted({once[key].handle, handle}))
        once[key] = Chain(own.layer, handle, corners, closed=True)
    return list(once.values())


def _others(path: str, faces: Sequence[Chain], closed: Sequence[Chain]) -> list[Chain]:
    """Return the faces of a layer that were not drawn as closed outlines.

    Closed outlines must be faces, too.
    """
    drawn = {frozenset(own.vertices.tolist()): own for own in closed}
    found = {frozenset(own.vertices.tolist()): own for own in faces}
    for corners, own in drawn.items():
        if corners not in found:
            why = "a closed outline that other lines of its layer cut, overlap or lie in"
            raise refused(path, own.told, why, "draw each block once, and nothing across it")
    return [own for corners, own in found.items() if corners not in drawn]


def _in_opening(face: Chain, holes: Sequence[Chain], place: Floats) -> bool:
    inside = shapely.point_on_surface(shapely.Polygon(place[:, face.vertices].T))
    outlines = (place[:, hole.vertices].T for hole in holes if hole.vertices.size > 2)
    return any(shapely.contains(shapely.Polygon(own), inside) for own in outlines)


def _farthest(points: Floats, vertices: Merged, edges: Ints, moved: Floats) -> float:
    """Return the farthest that a vertex of a block was moved, m."""
    own = np.isin(vertices.number, edges)
    away = moved[:, vertices.number[: len(points)]] - points.T
    return float(np.linalg.norm(away, axis=0)[own[: len(points)]].max(initial=0.0))


def _ordered(rings: Sequence[Chain], place: Floats) -> list[Chain]:
    """Order rings by courses from below, and from left to right.

    A course starts where no ring reaches into it.
    """
    polygons = [shapely.Polygon(place[:, own.vertices].T) for own in rings]
    x, y = shapely.get_coordinates(shapely.centroid(polygons)).T
    bounds = shapely.bounds(polygons)
    apart = _SAME_COURSE * np.mean(bounds[:, 3] - bounds[:, 1])
    order = np.argsort(y, kind="stable")
    course = np.empty(y.size, dtype=np.int64)
    course[order] = np.cumsum(np.diff(y[order], prepend=y[order[:1]]) > apart)
    return [rings[number] for number in np.lexsort((x, course))]


def _require_clear(path: str, chains: Sequence[Chain], vertices: Merged, snap: float) -> None:
    """Raise `InputError` where vertices are one only by others between them."""
    wide = int(np.argmax(vertices.width))
    if vertices.width[wide] > _WIDEST * snap:
        owner = next(chain for chain in chains if wide in chain.vertices)
        raise refused(
            path,
            owner.told,
            text(
                "vertices at {} are nearer to each other than the snap of {}, and {} "
                "from the first to the last",
                place_told(vertices.place[:, wide]),
                Quantity(snap, "m", ".3g"),
                Quantity(vertices.width[wide], "m", ".3g"),
            ),
            "give a smaller snap",
        )


def _require_blocks(path: str, rings: Sequence[Chain], place: Floats, snap: float) -> None:
    """Raise `InputError` for slivers, and outlines that cross themselves.

    Args:
        path: of the file.
        rings: closed outlines.
        place: of all vertices, (2, m), m.
        snap: m: thinner blocks are slivers.
    """
    for ring in rings:
        own = place[:, ring.vertices]
        at = text("the outline at {}", place_told(own[:, 0]))
        if ring.vertices.size < 3:
            raise refused(
                path,
                ring.told,
                text("{} is smaller than the snap of {}", at, Quantity(snap, "m", ".3g")),
                "remove it",
            )
        polygon = shapely.Polygon(own.T)
        if not polygon.is_valid:
            reason = shapely.is_valid_reason(polygon)
            why = f"{at} crosses or touches itself ({reason})"
            raise refused(path, ring.told, why, "draw its vertices in order around the block")
        if shapely.buffer(polygon, -snap / 2, join_style="mitre").is_empty:
            why = text(
                "{} is a sliver: thinner than the snap of {}", at, Quantity(snap, "m", ".3g")
            )
            raise refused(path, ring.told, why, "remove it, or give a smaller snap")


def _require_apart(path: str, rings: Sequence[Chain], place: Floats, snap: float) -> None:
    polygons = np.array([shapely.Polygon(place[:, ring.vertices].T) for ring in rings])
    cores = shapely.buffer(polygons, -snap / 2, join_style="mitre")
    i, j = shapely.STRtree(cores).query(cores, predicate="intersects")
    i, j = i[i < j], j[i < j]
    if not i.size:
        return
    one, other = rings[i[0]], rings[j[0]]
    told = overlap_told(polygons[i[0]], polygons[j[0]])
    raise refused(
        path,
        f"{one.told}, and {other.told}",
        f"these blocks {told} (overlapping pairs: {i.size})",
        "draw each block once, or give a snap above a slight depth; name the layer of the outlines"
        " of windows in `openings`",
    )
