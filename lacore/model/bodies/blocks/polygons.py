"""Outlines of rigid blocks: read, checked, cut into edges."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import shapely

from lacore.model.bodies.blocks.overlap import overlap_told
from lacore.model.bodies.touching import NEAR, Edges, near_misses
from lacore.numerics.arrays import Floats, Geometries, Ints
from lacore.reporting.errors import InputError, require_range
from lacore.reporting.text import Quantity, text

Polygons = Mapping[str, npt.ArrayLike] | Sequence[npt.ArrayLike]
"""Corners of each block, shape (n, 2), m, by its name, or numbered from 1."""
# area divided by the squared perimeter, below which double precision leaves no interior
_DEGENERATE = 1e-10
_RESERVED = "|#"  # Joints are named "a|b#2".


@dataclass(frozen=True, eq=False, repr=False)
class BlockEdges(Edges):
    """Edges of all blocks, one block after the other; `block` numbers, (n,)."""

    block: Ints


def read_polygons(blocks: Polygons, field: str) -> dict[str, Floats]:
    """Return the vertices (k, 2) by name; a sequence is named "0", "1", ...

    A last vertex that repeats the first is dropped.

    Raises:
        InputError: no block, an invalid name, fewer than 3 vertices, or vertices that are not
            finite.
    """
    if isinstance(blocks, Mapping):
        given: Iterable[tuple[str, npt.ArrayLike]] = blocks.items()
    elif isinstance(blocks, Sequence | np.ndarray) and not isinstance(blocks, str):
        given = ((str(number), vertices) for number, vertices in enumerate(blocks))
    else:
        raise InputError(
            field, blocks, "not polygons", "give {'name': [(x, y), ...]} or a list of polygons"
        )
    read = {name: _vertices(name, vertices, field) for name, vertices in given}
    if not read:
        raise InputError(field, None, "there is no block", "give at least one polygon")
    return read


def block_name(name: object, field: str) -> str:
    """Return a valid block name; raises `InputError` for any other."""
    if isinstance(name, str) and name and not any(sign in name for sign in _RESERVED):
        return name
    raise InputError(
        field, name, "not the name of a block", f"give a text without any of {_RESERVED}"
    )


def _vertices(name: object, vertices: npt.ArrayLike, field: str) -> Floats:
    where = f"{field}[{block_name(name, field)!r}]"
    try:
        points = np.array(vertices, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(where, vertices, "not a polygon", "give [(x, y), ...]") from None
    if points.ndim != 2 or points.shape[1] != 2:
        raise InputError(
            where, f"shape {points.shape}", "not a polygon", "give [(x, y), ...], shape (k, 2)"
        )
    if not np.all(np.isfinite(points)):
        raise InputError(where, None, "has vertices that are not finite", "fix the coordinates")
    require_range(where, points)
    if len(points) > 1 and np.array_equal(points[0], points[-1]):  # only an exact copy
        points = points[:-1]
    if len(points) < 3:
        raise InputError(
            where, f"{len(points)} vertices", "not a polygon", "give at least 3 vertices"
        )
    return points


def counterclockwise(outlines: Mapping[str, Floats], field: str) -> Geometries:
    """Return the blocks as polygons (B,) with counterclockwise outlines.

    Raises:
        InputError: no area, or an outline that crosses or touches itself.
    """
    counts = [len(points) for points in outlines.values()]
    rings = shapely.linearrings(
        np.concatenate(list(outlines.values())), indices=np.repeat(np.arange(len(counts)), counts)
    )
    flat = shapely.area(shapely.convex_hull(rings)) <= _DEGENERATE * shapely.length(rings) ** 2
    names = list(outlines)
    if flat.any():
        raise InputError(
            field,
            _named(names, np.flatnonzero(flat)),
            "blocks without area (their vertices lie on one line)",
            "move or remove them",
        )
    polygons = shapely.polygons(np.where(shapely.is_ccw(rings), rings, shapely.reverse(rings)))
    crossing = np.flatnonzero(~shapely.is_valid(polygons))
    if crossing.size:
        reason = shapely.is_valid_reason(polygons[crossing[0]])
        raise InputError(
            field,
            _named(names, crossing),
            f"outlines that cross or touch themselves ({names[crossing[0]]!r}: {reason})",
            "give the vertices in order around the block",
        )
    return np.asarray(polygons)


def outline_edges(polygons: Geometries, least: float) -> BlockEdges:
    """Return the edges longer than `least` of counterclockwise polygons."""
    points, block = shapely.get_coordinates(polygons, return_index=True)
    inside = block[1:] == block[:-1]
    start, end, block = points[:-1][inside].T, points[1:][inside].T, block[:-1][inside]
    along = end - start
    length = np.linalg.norm(along, axis=0)
    kept = length > least
    normal = np.stack([along[1], -along[0]])[:, kept] / length[kept]
    return BlockEdges(start[:, kept], end[:, kept], normal, block[kept])


def require_apart(names: Sequence[str], polygons: Geometries, tolerance: float, field: str) -> None:
    """Raise `InputError` where blocks overlap deeper than `tolerance` (m)."""
    # After shrinking by half of it each, blocks that overlap less are apart, also with round-off.
    core = shapely.buffer(polygons, -tolerance / 2, join_style="mitre")
    thin = np.flatnonzero(shapely.is_empty(core))
    if thin.size:
        raise InputError(
            field,
            _named(names, thin),
            text("blocks thinner than the tolerance {}", Quantity(tolerance, "m", ".3g")),
            "remove them, or give a smaller tolerance",
        )
    i, j = shapely.STRtree(core).query(core, predicate="intersects")
    i, j = i[i < j], j[i < j]
    if i.size:
        order = np.lexsort((j, i))
        a, b = i[order[0]], j[order[0]]
        raise InputError(
            field,
            (names[a], names[b]),
            f"these blocks {overlap_told(polygons[a], polygons[b])} (overlapping pairs: {i.size})",
            "move them apart; a slight overlap is within a tolerance above its depth",
        )


def require_no_slits(
    names: Sequence[str], polygons: Geometries, edges: BlockEdges, tolerance: float, field: str
) -> None:
    """Raise `InputError` if blocks nearly touch.

    These are faces of two blocks with a gap between `tolerance` (m) and 1 % of the shorter edge,
    unless another block, such as a shim, reaches between them.
    """
    slits = near_misses(edges, edges, tolerance)
    slits = slits.take(edges.block[slits.first] < edges.block[slits.second])
    if slits.first.size == 0:
        return
    across = edges.normal[:, slits.first] * slits.gap / 2
    along = (slits.end - slits.start) * 0.1  # The ends touch the neighbours.
    middle = np.stack([slits.start + across + along, slits.end + across - along])
    lines = shapely.linestrings(np.transpose(middle, (2, 0, 1)))
    slit, block = shapely.STRtree(polygons).query(lines, predicate="intersects")
    # The middle line of a tapering slit runs into one of its own two blocks.
    other = (block != edges.block[slits.first[slit]]) & (block != edges.block[slits.second[slit]])
    slits = slits.take(np.setdiff1d(np.arange(slits.first.size), slit[other]))
    if slits.first.size:
        a, b = edges.block[slits.first[0]], edges.block[slits.second[0]]
        raise InputError(
            field,
            (names[a], names[b]),
            text(
                "these blocks nearly touch: a gap of {}, less than {} of the edge (such gaps: {})",
                Quantity(slits.gap[0], "m", ".3g"),
                f"{NEAR:.0%}",
                slits.first.size,
            ),
            text(
                "close the gap, give a tolerance above {}, or widen it if it is meant",
                Quantity(slits.gap.max(), "m", ".3g"),
            ),
        )


def _named(names: Sequence[str], which: Ints) -> list[str]:
    """Return the first few names, for messages."""
    return [names[number] for number in which[:5]]
