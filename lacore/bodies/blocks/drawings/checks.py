"""What is wrong with outlines, by layer, handle and place: where the drawing has to be mended."""

from collections.abc import Sequence

import numpy as np
import shapely

from lacore.arrays import Floats
from lacore.bodies.blocks.drawings.loops import Chain
from lacore.bodies.blocks.drawings.snapping import Merged
from lacore.bodies.blocks.drawings.strokes import place_told, refused
from lacore.bodies.blocks.overlap import overlap_told
from lacore.reporting.text import Quantity, text

_WIDEST = 2.0  # snaps: vertices that are one lie no farther apart


def require_clear(path: str, chains: Sequence[Chain], vertices: Merged, snap: float) -> None:
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


def require_blocks(path: str, rings: Sequence[Chain], place: Floats, snap: float) -> None:
    """Raise `InputError` for slivers, outlines that cross themselves, and blocks that overlap.

    Args:
        path: of the file.
        rings: closed outlines.
        place: of all vertices, (2, m), m.
        snap: m: thinner blocks are slivers, and deeper overlaps are some.
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
    _require_apart(path, rings, place, snap)


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
        "draw each block once; name the layer of the outlines of windows in `openings`",
    )
