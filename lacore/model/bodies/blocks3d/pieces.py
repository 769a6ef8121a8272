"""Convex pieces of blocks, and the largest balls in the overlap of such pieces."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from lacore.model.bodies.blocks3d.ranges import spread
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.numerics.linear_program import least
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact
from lacore.reporting.text import Quantity, text

_SAME = 1e-9  # by the size of a block: distance within which corners are equal
_PARALLEL = 1e-9  # product of three normals of planes that meet in a point
_MOST = 1000  # limit of pieces of a block
_TOGETHER = 200  # number of pieces in one linear program


@dataclass(frozen=True, eq=False, repr=False)
class Piece(Compact):
    """A convex region ``normal.x <= offset``.

    Attributes:
        normal: normals, (3, f). `offset`: offsets, (f,), m.
        points: its corners, (n, 3), m.
    """

    normal: Floats
    offset: Floats
    points: Floats

    def height(self, points: Floats) -> Floats:
        """Return how far outside of each plane places (n, 3) lie, (n, f), m."""
        return points @ self.normal - self.offset


def hull_of(normal: Floats, offset: Floats, points: Floats, tolerance: float) -> Piece:
    """Return the vertices of a block (n, 3) with its planes that have no vertex outside.

    A vertex is outside if it is farther than `tolerance` (m).
    """
    outer = (points @ normal - offset).max(axis=0) <= tolerance
    return Piece(normal[:, outer], offset[outer], points)


def convex_pieces(
    normal: Floats,
    offset: Floats,
    points: Floats,
    outline: tuple[Ints, Ints],
    triangles: Floats,
    tolerance: float,
    field: str,
) -> tuple[Piece, ...]:
    """Return the convex pieces into which the planes of its faces cut a block.

    A plane cuts the pieces that its face intersects; the resulting pieces are completely inside or
    outside.

    Args:
        normal, offset: outward normals and offsets of its plane faces, (3, f) and (f,).
        points: its vertices, (n, 3), m.
        outline: vertex numbers of the corners of all faces, (k,), and the face of each, (k,).
        triangles: corners of signed triangles that make up its surface, (t, 3, 3), m.
        tolerance: m: a plane with no vertex farther outside does not cut it.
        field: name for errors.

    Raises:
        InputError: a surface that crosses itself, or has too many reentrant faces.
    """
    hull = hull_of(normal, offset, points, tolerance)
    if hull.offset.size == offset.size:
        return (hull,)
    cuts = (points @ normal - offset).max(axis=0) > tolerance
    low, high = points.min(axis=0), points.max(axis=0)
    near = _SAME * float(np.linalg.norm(high - low))
    sides = np.hstack([hull.normal, np.eye(3), -np.eye(3)])
    cells = [_bounded(sides, np.concatenate([hull.offset, high, -low]), near)]
    vertex, owner = outline
    for face in np.flatnonzero(cuts):
        corners = points[vertex[owner == face]]
        cells = [
            part
            for cell in cells
            for part in _cut(cell, normal[:, face], offset[face], corners, tolerance, near)
        ]
        if len(cells) > _MOST:
            fix = "cut it into several blocks"
            raise InputError(field, None, "reentrant faces cut it into too many pieces", fix)
    middle = np.stack([cell.points.mean(axis=0) for cell in cells], axis=1)
    turns = _windings(middle, triangles)
    wrong = np.flatnonzero((turns != 0) & (turns != 1))
    if wrong.size:
        raise InputError(
            field,
            None,
            text(
                "the surface crosses itself near {}",
                Quantity(tuple(middle[:, wrong[0]]), "m", ".6g"),
            ),
            "fix its faces, or cut the block into several",
        )
    return tuple(cell for cell, turn in zip(cells, turns, strict=True) if turn == 1)


def _cut(
    cell: Piece, normal: Floats, offset: float, face: Floats, tolerance: float, near: float
) -> list[Piece]:
    """Return a cell cut in two if a face intersects it."""
    height = cell.points @ normal - offset
    beside = height.max() <= tolerance or height.min() >= -tolerance
    if beside or np.any(cell.height(face).min(axis=0) >= -tolerance):
        return [cell]
    return [
        _bounded(
            np.column_stack([cell.normal, sign * normal]),
            np.append(cell.offset, sign * offset),
            near,
        )
        for sign in (1.0, -1.0)
    ]


def _bounded(normal: Floats, offset: Floats, near: float) -> Piece:
    """Return a region by its corners, without planes that it does not reach."""
    three = np.array(list(combinations(range(offset.size), 3)))
    planes = normal.T[three]
    place = three[np.abs(np.linalg.det(planes)) > _PARALLEL]
    points = np.linalg.solve(normal.T[place], offset[place][:, :, None])[:, :, 0]
    points = points[(points @ normal - offset).max(axis=1) <= near]
    _, once = np.unique(np.round(points / (10 * near)), axis=0, return_index=True)
    points = points[once]
    reached = (points @ normal - offset >= -10 * near).sum(axis=0) >= 3
    return Piece(normal[:, reached], offset[reached], points)


def _windings(places: Floats, triangles: Floats) -> Floats:
    """Return the winding number of a surface around places (3, k), by solid angles."""
    a, b, c = np.moveaxis(triangles[:, :, :, None] - places, 1, 0)  # shape (t, 3, k) each
    la, lb, lc = (np.linalg.norm(own, axis=1) for own in (a, b, c))
    volume = np.sum(a * np.cross(b, c, axis=1), axis=1)
    below = la * lb * lc + np.sum(a * b, axis=1) * lc
    below += np.sum(b * c, axis=1) * la + np.sum(c * a, axis=1) * lb
    angle = 2 * np.arctan2(volume, below)
    return np.asarray(np.round(angle.sum(axis=0) / (4 * np.pi)))


def kept_apart(pieces: Sequence[Piece], first: Ints, second: Ints, depth: float) -> Bools:
    """Return whether the plane of a face separates two pieces, except for `depth` (m), (k,)."""
    faces = np.repeat(np.arange(len(pieces)), [own.offset.size for own in pieces])
    corners = np.repeat(np.arange(len(pieces)), [len(own.points) for own in pieces])
    normal = np.concatenate([own.normal for own in pieces], axis=1)
    points = np.concatenate([own.points for own in pieces]).T
    offset = np.concatenate([own.offset for own in pieces])
    apart = np.zeros(first.size, dtype=bool)
    for own, other in ((first, second), (second, first)):
        left = np.flatnonzero(~apart)
        if left.size:
            face, pair = spread(faces, own[left], len(pieces))
            vertex, row = spread(corners, other[left][pair], len(pieces))
            height = np.sum(normal[:, face[row]] * points[:, vertex], axis=0) - offset[face[row]]
            lowest = np.minimum.reduceat(height, np.flatnonzero(np.diff(row, prepend=-1)))
            apart[left[np.unique(pair[lowest >= -depth])]] = True
    return apart


def shared_middles(
    pieces: Sequence[Piece], first: Ints, second: Ints, reach: float, otherwise: Floats
) -> Floats:
    """Return the mean of the corners of either piece that are in the other, to `reach` (m), (3, k).

    For pieces that touch along an edge this is its middle. If there is no such corner, as for
    crossing edges, it is the given place, (3, k).
    """
    faces = np.repeat(np.arange(len(pieces)), [own.offset.size for own in pieces])
    corners = np.repeat(np.arange(len(pieces)), [len(own.points) for own in pieces])
    normal = np.concatenate([own.normal for own in pieces], axis=1)
    points = np.concatenate([own.points for own in pieces]).T
    offset = np.concatenate([own.offset for own in pieces])
    total, number = np.zeros_like(otherwise), np.zeros(first.size)
    for own, other in ((first, second), (second, first)):
        vertex, pair = spread(corners, own, len(pieces))
        face, row = spread(faces, other[pair], len(pieces))
        height = np.sum(normal[:, face] * points[:, vertex[row]], axis=0) - offset[face]
        highest = np.maximum.reduceat(height, np.flatnonzero(np.diff(row, prepend=-1)))
        inside = np.flatnonzero(highest <= reach)
        number += np.bincount(pair[inside], minlength=first.size)
        for axis in range(3):
            total[axis] += np.bincount(pair[inside], points[axis, vertex[inside]], first.size)
    return np.where(number > 0, total / np.maximum(number, 1), otherwise)


def largest_balls(pairs: Sequence[tuple[Piece, Piece]]) -> tuple[Floats, Floats]:
    """Return radii (k,) and centres (3, k), m, of the largest balls in both of two pieces.

    For pieces that are apart, the radius is minus half the distance.
    """
    radius, centre = [np.zeros(0)], [np.zeros((3, 0))]
    for begin in range(0, len(pairs), _TOGETHER):
        own_radius, own_centre = _balls(pairs[begin : begin + _TOGETHER])
        radius.append(own_radius)
        centre.append(own_centre)
    return np.concatenate(radius), np.concatenate(centre, axis=1)


def _balls(pairs: Sequence[tuple[Piece, Piece]]) -> tuple[Floats, Floats]:
    """Solve one linear program, with lengths in sizes of the smaller piece from its middle."""
    near = np.stack([min(pair, key=_size).points.mean(axis=0) for pair in pairs], axis=1)
    size = np.array([min(map(_size, pair)) for pair in pairs])
    own = np.repeat(np.arange(len(pairs)), [a.offset.size + b.offset.size for a, b in pairs])
    normal = np.concatenate([piece.normal for pair in pairs for piece in pair], axis=1)
    offset = np.concatenate([piece.offset for pair in pairs for piece in pair])
    room = (offset - np.sum(normal * near[:, own], axis=0)) / size[own]
    rows = np.repeat(np.arange(own.size), 4)
    columns = (4 * own[:, None] + np.arange(4)).ravel()
    values = np.vstack([normal, np.ones(own.size)]).T.ravel()
    inside = coo_matrix((values, (rows, columns)), shape=(own.size, 4 * len(pairs)))
    unbounded = np.full(4 * len(pairs), np.inf)
    found = least(
        np.tile([0.0, 0.0, 0.0, -1.0], len(pairs)),
        at_most=(inside.tocsr(), room),
        equal=(csr_matrix((0, unbounded.size)), np.zeros(0)),
        lower=-unbounded,
        upper=unbounded,
    )
    if found is None:  # A largest ball always exists, so the time limit was reached.
        raise RuntimeError("whether blocks overlap was not found in time")
    ball = found.reshape(-1, 4).T * size
    return ball[3], near + ball[:3]


def _size(piece: Piece) -> float:
    return float(np.linalg.norm(np.ptp(piece.points, axis=0)))
