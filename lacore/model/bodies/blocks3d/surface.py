"""Surfaces of polygons: whether they are closed, their orientation, and their plane faces."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np
import shapely
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact
from lacore.reporting.text import Quantity, text

_DEGENERATE = 1e-10  # area divided by the squared perimeter, below which a polygon has no normal


@dataclass(frozen=True, eq=False, repr=False)
class HalfEdges(Compact):
    """Sides of polygons, one polygon after the other, in order around each.

    Attributes:
        start, end: vertex numbers, (h,).
        face: the polygon, (h,); `first`: first side of each polygon, (p,).
        twin: the side of the neighbour along the same edge, (h,).
    """

    start: Ints
    end: Ints
    face: Ints
    first: Ints
    twin: Ints

    @property
    def counts(self) -> Ints:
        """Vertices of each polygon, (p,)."""
        return np.diff(self.first, append=self.start.size)


def closed_surface(points: Floats, faces: Sequence[Sequence[int]], field: str) -> HalfEdges:
    """Return the sides of polygons of a closed surface, oriented consistently.

    Args:
        points: vertices, (n, 3), m.
        faces: vertex numbers of each polygon, in order around it, in either sense.
        field: name for errors.

    Raises:
        InputError: no polygons, unknown or repeated vertices, an open edge, more than two polygons
            at an edge, a surface with one side only or of several parts.
    """
    flat, counts = _numbers(points, faces, field)
    edges = _sides(flat, counts)
    low, high = np.minimum(edges[0], edges[1]), np.maximum(edges[0], edges[1])
    key = low * len(points) + high
    order = np.argsort(key, kind="stable")
    _, begin, met = np.unique(key[order], return_index=True, return_counts=True)
    if np.any(met != 2):
        worst = order[begin[np.flatnonzero(met != 2)[0]]]
        a, b = edges[0][worst], edges[1][worst]
        many = met[np.flatnonzero(met != 2)[0]]
        why = "is open: one face only has it" if many == 1 else f"joins {many} faces"
        fix = (
            "give the missing face, or merge vertices that lie in one place"
            if many == 1
            else "let the surface nowhere touch itself, and give each block its own polyhedron"
        )
        raise InputError(
            field,
            None,
            text(
                "the edge from {} to {} (vertices {}, {}; face {}) {} (such edges: {})",
                Quantity(tuple(points[a]), "m", ".6g"),
                Quantity(tuple(points[b]), "m", ".6g"),
                a,
                b,
                edges[2][worst],
                why,
                np.count_nonzero(met != 2),
            ),
            fix,
        )
    twin = np.empty_like(flat)
    twin[order[0::2]], twin[order[1::2]] = order[1::2], order[0::2]
    start, end, face = edges
    turned = _turned(start, face, twin, counts.size, field)
    if turned.any():
        # In a reversed polygon the sides are in the opposite order.
        first = np.cumsum(counts) - counts
        last = first[face] + counts[face] - 1
        mirror = np.where(turned[face], first[face] + last - np.arange(face.size), 0)
        place = np.where(turned[face], mirror, np.arange(face.size))
        return closed_again(np.where(turned[face], end[place], start[place]), counts, len(points))
    return HalfEdges(start, end, face, np.cumsum(counts) - counts, twin)


def closed_again(flat: Ints, counts: Ints, points: int) -> HalfEdges:
    """Return the sides of polygons that are known to be closed and consistent."""
    start, end, face = _sides(flat, counts)
    forward = np.argsort(start * points + end)
    backward = np.argsort(end * points + start)
    twin = np.empty_like(flat)
    twin[forward] = backward
    return HalfEdges(start, end, face, np.cumsum(counts) - counts, twin)


def _numbers(points: Floats, faces: Sequence[Sequence[int]], field: str) -> tuple[Ints, Ints]:
    """Return all vertex numbers of polygons, and the number of vertices of each."""
    try:
        listed = [list(face) for face in faces]
    except TypeError:
        raise InputError(field, faces, "no faces", "give [(0, 1, 2, 3), ...]") from None
    if not listed:
        raise InputError(field, None, "there is no face", "give at least four")
    counts = np.array([len(face) for face in listed])
    short = np.flatnonzero(counts < 3)
    if short.size:
        face = short[0]
        raise InputError(
            f"{field}[{face}]", listed[face], "fewer than 3 vertices", "remove it, or fix it"
        )
    flat = np.array(list(chain.from_iterable(listed)))
    if flat.ndim != 1 or flat.dtype.kind not in "iu":
        raise InputError(field, None, "not vertex numbers", "give whole numbers from 0 on")
    flat = flat.astype(np.int64)
    number = np.repeat(np.arange(counts.size), counts)
    unknown = np.flatnonzero((flat < 0) | (flat >= len(points)))
    if unknown.size:
        face = number[unknown[0]]
        raise InputError(
            f"{field}[{face}]",
            listed[face],
            f"there is no vertex {flat[unknown[0]]}",
            f"give numbers from 0 to {len(points) - 1}",
        )
    key = np.sort(number * len(points) + flat)
    again = np.flatnonzero(np.diff(key) == 0)
    if again.size:
        face, vertex = divmod(int(key[again[0]]), len(points))
        raise InputError(
            f"{field}[{face}]", listed[face], f"vertex {vertex} stands there twice", "give it once"
        )
    return flat, counts


def _sides(flat: Ints, counts: Ints) -> tuple[Ints, Ints, Ints]:
    """Start, end, and polygon of each side."""
    face = np.repeat(np.arange(counts.size), counts)
    first = np.cumsum(counts) - counts
    following = np.arange(1, flat.size + 1)
    following[first + counts - 1] = first
    return flat, flat[following], face


def _turned(start: Ints, face: Ints, twin: Ints, faces: int, field: str) -> Bools:
    """Return which polygons must be reversed, (p,), for all to agree with the first.

    Each polygon is included twice, as given and reversed. Neighbours that agree link equal copies,
    others opposite ones: a surface with two sides falls into two parts, one with one side does not.
    """
    same = start == start[twin]  # If both begin at the same end, one of them must be reversed.
    one, other = face, face[twin]
    row = np.concatenate([one, one + faces])
    column = np.concatenate([other + faces * same, other + faces * ~same])
    graph = coo_matrix((np.ones(row.size), (row, column)), shape=(2 * faces, 2 * faces))
    parts, part = connected_components(graph, directed=False)
    if np.any(part[:faces] == part[faces:]):
        raise InputError(
            field, None, "the surface has one side only", "give the faces of a solid block"
        )
    if parts > 2:
        raise InputError(
            field,
            None,
            f"the surface falls into {parts // 2} parts",
            "give each part as a block of its own (a block has no cavity inside)",
        )
    return np.asarray(part[:faces] != part[0])


def area_vectors(points: Floats, edges: HalfEdges) -> tuple[Floats, Floats]:
    """Return area vector and centroid of the triangle of each side and its polygon's first vertex.

    Returns:
        m^2 and m, (h, 3) each.
    """
    corner = points[edges.start[edges.first]][edges.face]
    start, end = points[edges.start], points[edges.end]
    return np.cross(start - corner, end - corner) / 2, (corner + start + end) / 3


def axes_of(normal: Floats) -> tuple[Floats, Floats]:
    """Return two unit vectors normal to each unit normal, (3, f) each, right-handed with it.

    They result from the smallest rotation of the closest coordinate axes.
    """
    size = np.abs(normal)
    helper = np.zeros_like(normal)
    helper[np.argmin(size, axis=0), np.arange(normal.shape[1])] = 1.0
    one = np.cross(helper, normal, axis=0)
    one /= np.linalg.norm(one, axis=0)
    return one, np.cross(normal, one, axis=0)


def require_polygons(points: Floats, edges: HalfEdges, tolerance: float, field: str) -> None:
    """Raise `InputError` for polygons without area, or that are warped or crossed.

    They may be warped by `tolerance` (m). The error names the polygon, the place, and the
    deviation.
    """
    triangle, _ = area_vectors(points, edges)
    vector = np.add.reduceat(triangle, edges.first)
    area = np.linalg.norm(vector, axis=1)
    along = points[edges.end] - points[edges.start]
    around = np.add.reduceat(np.linalg.norm(along, axis=1), edges.first)
    thin = np.flatnonzero(~(area > _DEGENERATE * around**2))
    if thin.size:
        place = points[edges.start[edges.first[thin[0]]]]
        raise InputError(
            f"{field}[{thin[0]}]",
            None,
            text(
                "a face without area, at {} (such faces: {})",
                Quantity(tuple(place), "m", ".6g"),
                thin.size,
            ),
            "remove it, and let its neighbours share their vertices",
        )
    normal = vector / area[:, None]
    middle = np.add.reduceat(points[edges.start], edges.first) / edges.counts[:, None]
    own = points[edges.start] - middle[edges.face]
    off = np.abs(np.sum(own * normal[edges.face], axis=1))
    warped = np.argmax(off)
    if off[warped] > tolerance:
        face = edges.face[warped]
        raise InputError(
            f"{field}[{face}]",
            None,
            text(
                "a warped face: vertex {} at {} is {} off its plane, more than the "
                "tolerance {} (warped faces: {})",
                edges.start[warped],
                Quantity(tuple(points[edges.start[warped]]), "m", ".6g"),
                Quantity(off[warped], "m", ".3g"),
                Quantity(tolerance, "m", ".3g"),
                np.unique(edges.face[off > tolerance]).size,
            ),
            "move the vertex into the plane, cut the face into plane ones as its neighbour block"
            " does, or give a larger tolerance",
        )
    one, two = axes_of(normal.T)
    flat = np.stack([np.sum(own.T * axis[:, edges.face], axis=0) for axis in (one, two)], axis=1)
    crossed = np.flatnonzero(~shapely.is_valid(shapely.polygons(_rings(flat, edges.face))))
    if crossed.size:
        raise InputError(
            f"{field}[{crossed[0]}]",
            None,
            text(
                "a face whose outline crosses or touches itself, at {} (such faces: {})",
                Quantity(tuple(middle[crossed[0]]), "m", ".6g"),
                crossed.size,
            ),
            "give its vertices in order around it",
        )


def _rings(flat: Floats, ring: Ints) -> object:
    return shapely.linearrings(flat, indices=ring)


def in_one_plane(points: Floats, edges: HalfEdges, tolerance: float) -> Ints:
    """Return the numbers of the plane faces of neighbouring polygons in one plane, (p,).

    Neighbours belong together if rotating one into the plane of the other moves it by at most
    `tolerance` (m). If the ends of a chain of them are not in one plane, each polygon stays
    separate.
    """
    triangle, _ = area_vectors(points, edges)
    vector = np.add.reduceat(triangle, edges.first)
    polygons = len(vector)
    normal = vector / np.linalg.norm(vector, axis=1)[:, None]
    middle = np.add.reduceat(points[edges.start], edges.first) / edges.counts[:, None]
    reach = np.maximum.reduceat(
        np.linalg.norm(points[edges.start] - middle[edges.face], axis=1), edges.first
    )
    one, other = edges.face, edges.face[edges.twin]
    sine = np.linalg.norm(np.cross(normal[one], normal[other]), axis=1)
    alike = np.sum(normal[one] * normal[other], axis=1) > 0
    alike &= 2 * sine * np.minimum(reach[one], reach[other]) <= tolerance
    if not alike.any():
        return np.arange(polygons)
    graph = coo_matrix((alike[alike], (one[alike], other[alike])), shape=(polygons, polygons))
    parts, part = connected_components(graph, directed=False)
    whole = np.zeros((parts, 3))
    np.add.at(whole, part, vector)
    whole /= np.linalg.norm(whole, axis=1)[:, None]
    heights = np.sum(points[edges.start] * whole[part[edges.face]], axis=1)
    low, high = np.full(parts, np.inf), np.full(parts, -np.inf)
    np.minimum.at(low, part[edges.face], heights)
    np.maximum.at(high, part[edges.face], heights)
    alone = (high - low)[part] > 2 * tolerance
    label = np.where(alone, polygons + np.arange(polygons), part)
    _, first, number = np.unique(label, return_index=True, return_inverse=True)
    rank = np.empty_like(first)
    rank[np.argsort(first)] = np.arange(first.size)  # numbered in the order of the polygons
    return rank[number]


def outlines(edges: HalfEdges, plane: Ints) -> tuple[tuple[Ints, ...], Ints]:
    """Return the rings of vertex numbers around plane faces, and the face of each ring.

    A face has one ring that runs counterclockwise as seen from outside, and one that runs clockwise
    around each hole.
    """
    own = plane[edges.face]
    inner = own == own[edges.twin]
    following = np.arange(1, own.size + 1)
    following[edges.first + edges.counts - 1] = edges.first
    after = following
    while np.any(inner[after[~inner]]):  # past the sides that two polygons of a face share
        after = np.where(inner[after], following[edges.twin[after]], after)
    ways = after.tolist()
    left = dict.fromkeys(np.flatnonzero(~inner).tolist())
    rings = []
    while left:
        side = next(iter(left))
        ring = []
        while side in left:
            del left[side]
            ring.append(side)
            side = ways[side]
        rings.append(np.array(ring))
    return tuple(edges.start[ring] for ring in rings), own[[ring[0] for ring in rings]]
