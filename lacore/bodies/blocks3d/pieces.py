"""Convex pieces of blocks, as half-spaces, and the largest balls in what such pieces share."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from lacore.arrays import Floats
from lacore.errors import InputError
from lacore.numerics.linear_program import least
from lacore.showing import Compact, placed

_NOTHING = 1e-9  # of the size of a block: cells with a smaller ball in them are round-off


@dataclass(frozen=True, eq=False, repr=False)
class Piece(Compact):
    """A convex region ``normal.x <= offset``; normals (3, f), offsets (f,), m."""

    normal: Floats
    offset: Floats

    def with_plane(self, normal: Floats, offset: float) -> "Piece":
        """The part of it with ``normal.x <= offset``, normal (3,)."""
        return Piece(np.column_stack([self.normal, normal]), np.append(self.offset, offset))

    def and_of(self, other: "Piece") -> "Piece":
        """What two pieces have in common."""
        return Piece(
            np.concatenate([self.normal, other.normal], axis=1),
            np.concatenate([self.offset, other.offset]),
        )


def largest_balls(pieces: Sequence[Piece], near: Floats, size: Floats) -> tuple[Floats, Floats]:
    """Radii (k,) and centres (3, k), m, of the largest balls in pieces; without inside: below 0.

    A linear program for all together.

    Args:
        pieces: bounded.
        near: a place near each piece, (3, k), m, and how large it is, `size`, (k,), m.
    """
    if not pieces:
        return np.zeros(0), np.zeros((3, 0))
    own = np.repeat(np.arange(len(pieces)), [piece.offset.size for piece in pieces])
    normal = np.concatenate([piece.normal for piece in pieces], axis=1)
    offset = np.concatenate([piece.offset for piece in pieces])
    room = (offset - np.sum(normal * near[:, own], axis=0)) / size[own]
    rows = np.repeat(np.arange(own.size), 4)
    columns = (4 * own[:, None] + np.arange(4)).ravel()
    values = np.vstack([normal, np.ones(own.size)]).T.ravel()
    inside = coo_matrix((values, (rows, columns)), shape=(own.size, 4 * len(pieces)))
    unbounded = np.full(4 * len(pieces), np.inf)
    found = least(
        np.tile([0.0, 0.0, 0.0, -1.0], len(pieces)),
        at_most=(inside.tocsr(), room),
        equal=(csr_matrix((0, unbounded.size)), np.zeros(0)),
        lower=-unbounded,
        upper=unbounded,
    )
    if found is None:  # of the time limit: each has a largest ball
        raise RuntimeError("the largest balls in convex pieces were not found in time")
    ball = found.reshape(-1, 4).T * size
    return ball[3], near + ball[:3]


def convex_pieces(
    normal: Floats, offset: Floats, points: Floats, triangles: Floats, tolerance: float, field: str
) -> tuple[Piece, ...]:
    """The convex pieces into which the planes of its own faces cut a block.

    Args:
        normal, offset: of its plane faces, outward, (3, f) and (f,).
        points: its vertices, (n, 3), m.
        triangles: corners of signed triangles that make up its surface, (t, 3, 3), m.
        tolerance: m: a plane with no vertex farther outside does not cut it.
        field: named in errors.

    Raises:
        InputError: a surface that crosses itself.
    """
    cuts = (points @ normal - offset).max(axis=0) > tolerance
    cells = [Piece(normal[:, ~cuts], offset[~cuts])]
    low, high = points.min(axis=0), points.max(axis=0)
    box = Piece(np.hstack([np.eye(3), -np.eye(3)]), np.concatenate([high, -low]))
    cells = [cells[0].and_of(box)]
    middle, size = (low + high) / 2, float(np.linalg.norm(high - low))
    if not cuts.any():
        return tuple(cells)
    centre = np.zeros((3, 0))
    for face in np.flatnonzero(cuts):
        parts = [
            cell.with_plane(sign * normal[:, face], sign * offset[face])
            for cell in cells
            for sign in (1.0, -1.0)
        ]
        near = np.repeat(middle[:, None], len(parts), axis=1)
        radius, centre = largest_balls(parts, near, np.full(len(parts), size))
        kept = radius > _NOTHING * size
        cells = [part for part, whole in zip(parts, kept, strict=True) if whole]
        centre = centre[:, kept]
    turns = _windings(centre, triangles)
    wrong = np.flatnonzero((turns != 0) & (turns != 1))
    if wrong.size:
        raise InputError(
            field,
            None,
            f"the surface crosses itself near {placed(centre[:, wrong[0]])} m",
            "mend its faces, or cut the block into several",
        )
    return tuple(cell for cell, turn in zip(cells, turns, strict=True) if turn == 1)


def _windings(places: Floats, triangles: Floats) -> Floats:
    """How often a surface winds around places (3, k): solid angles of its triangles, summed."""
    a, b, c = np.moveaxis(triangles[:, :, :, None] - places, 1, 0)  # (t, 3, k) each
    la, lb, lc = (np.linalg.norm(own, axis=1) for own in (a, b, c))
    volume = np.sum(a * np.cross(b, c, axis=1), axis=1)
    below = la * lb * lc + np.sum(a * b, axis=1) * lc
    below += np.sum(b * c, axis=1) * la + np.sum(c * a, axis=1) * lb
    angle = 2 * np.arctan2(volume, below)
    return np.asarray(np.round(angle.sum(axis=0) / (4 * np.pi)))
