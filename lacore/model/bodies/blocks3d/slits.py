"""Three-dimensional blocks that nearly touch, with gaps too small to be intended."""

from collections.abc import Mapping

import numpy as np
import shapely

from lacore.model.bodies.blocks3d.faces import boxes_that_meet, faces_of
from lacore.model.bodies.blocks3d.joints import gaps, shared_pieces
from lacore.model.bodies.blocks3d.polyhedron import Polyhedron
from lacore.model.bodies.blocks3d.surface import axes_of
from lacore.model.bodies.touching import NEAR
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.errors import InputError
from lacore.reporting.text import Quantity, text


def require_no_slits(polyhedra: Mapping[str, Polyhedron], tolerance: float, field: str) -> None:
    """Raise `InputError` if blocks nearly touch.

    These are facing faces of two blocks with a gap between `tolerance` (m) and 1 % of the width of
    the narrower one (`Faces.width`), unless another block, such as a shim, reaches between them.
    """
    blocks = list(polyhedra.values())
    faces = faces_of(blocks)
    first, second = boxes_that_meet(faces.low, faces.high, NEAR * faces.width.max())
    lean = np.linalg.norm(faces.normal[:, first] + faces.normal[:, second], axis=0)
    near = NEAR * np.minimum(faces.width[first], faces.width[second])
    kept = (faces.block[first] != faces.block[second]) & (lean <= NEAR)
    kept &= _close(faces.low, faces.high, first, second, near)
    first, second, near = first[kept], second[kept], near[kept]
    normal = faces.normal[:, first] - faces.normal[:, second]
    normal /= np.linalg.norm(normal, axis=0)
    one, two = axes_of(normal)
    pair, shared = shared_pieces(faces, first, second, one, two, 0.0)
    wide = 2 * shapely.area(shared) > near[pair] * shapely.length(shared)
    pair, shared = pair[wide], shared[wide]
    corners, piece = shapely.get_coordinates(shared, return_index=True)
    own = pair[piece]
    axes = normal[:, own], one[:, own], two[:, own]
    _, gap = gaps(faces, first[own], second[own], axes, corners.T)
    widest, least = np.full(pair.size, -np.inf), np.full(pair.size, np.inf)
    np.maximum.at(widest, piece, gap)
    np.minimum.at(least, piece, gap)
    slit = np.flatnonzero((widest > tolerance) & (widest <= near[pair]) & (least >= -tolerance))
    if not slit.size:
        return
    inside = shapely.get_coordinates(shapely.point_on_surface(shared[slit])).T
    own = pair[slit]
    axes = normal[:, own], one[:, own], two[:, own]
    low, gap = gaps(faces, first[own], second[own], axes, inside)
    middle = axes[0] * (low + gap / 2) + axes[1] * inside[0] + axes[2] * inside[1]
    middle += faces.origin[:, None]
    empty = ~filled(blocks, middle)
    slit, middle = slit[empty], middle[:, empty]
    if slit.size:
        names = list(polyhedra)
        worst = pair[slit[0]]
        raise InputError(
            field,
            (names[faces.block[first[worst]]], names[faces.block[second[worst]]]),
            text(
                "these blocks nearly touch at {}: a gap of {}, less than {} of the face "
                "(such gaps: {})",
                Quantity(tuple(middle[:, 0]), "m", ".6g"),
                Quantity(widest[slit[0]], "m", ".3g"),
                f"{NEAR:.0%}",
                slit.size,
            ),
            text(
                "close the gap, give a tolerance above {}, or widen it if it is meant",
                Quantity(widest[slit].max(), "m", ".3g"),
            ),
        )


def _close(low: Floats, high: Floats, first: Ints, second: Ints, near: Floats) -> Bools:
    """Return whether two boxes are within that distance along each axis."""
    apart = np.maximum(low[:, first] - high[:, second], low[:, second] - high[:, first])
    return np.asarray(apart.max(axis=0) <= near)


def filled(blocks: list[Polyhedron], places: Floats) -> Bools:
    """Return whether places (3, k) lie in blocks, (k,)."""
    inside = np.zeros(places.shape[1], dtype=bool)
    for block in blocks:
        low, high = block.box
        beside = np.maximum(low - places.T, places.T - high).max(axis=1)
        near = np.flatnonzero(beside <= 0)
        for piece in block.pieces if near.size else ():
            inside[near] |= piece.height(places[:, near].T).max(axis=1) <= 0
    return inside
