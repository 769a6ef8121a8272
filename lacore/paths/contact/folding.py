"""Folds: where, and when within a step, a body touches itself without contact that is stated.

Edges are taken as polylines, whose points move along straight lines within a step. A point is on
the line of a segment where a quadratic polynomial of the time is zero: straight edges are exact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from skfem import Mesh

from lacore.model.meshes.curved import edge_curves
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.paths.contact.pairs import Pair
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Compact
from lacore.reporting.text import Quantity

FOLDED = "boundary folded"
_PARTS = 4  # of an edge as a polyline
_ON = 1e-9  # of the body size: for points closer to a line at the start, no contact is detected


@dataclass(frozen=True, repr=False)
class Fold(Compact):
    """Place at which a body first touches itself.

    Attributes:
        body: Name of the body.
        place: Place, m, shape (2,).
        share: Share of the motion, from 0 to 1.
    """

    body: str
    place: Floats
    share: float

    @property
    def finding(self) -> Finding:
        """``the boundary of 'body' touches itself near (1, 0) m``."""
        x, y = self.place.tolist()
        values = {"place": Quantity((x, y), "m", ".4g")}
        return Finding(Kind.FOLD, (self.body,), values, Severity.DETAIL)


def first_fold(
    before: Mapping[str, Mesh], after: Mapping[str, Mesh], pairs: Sequence[Pair] = ()
) -> Fold | None:
    """The first fold as bodies move, between parts that no pair keeps apart; None of none.

    Args:
        before, after: the same meshes at the beginning and at the end of the motion, by body.
        pairs: of the path.
    """
    folding = [pair for pair in pairs if pair.self_contact]
    found = [
        _fold(name, mesh, after[name], [own for own in folding if own.slave.body == name])
        for name, mesh in before.items()
    ]
    return min((own for own in found if own is not None), key=lambda own: own.share, default=None)


def _fold(name: str, before: Mesh, after: Mesh, pairs: Sequence[Pair]) -> Fold | None:
    first, segments = _polylines(before)
    motion = _polylines(after)[0] - first
    point, segment = _near(first, first + motion, segments)
    for pair in pairs:
        one, other = (_points_of(before, side.edges) for side in pair.sides)
        kept = one[point] & other[segments[:, segment]].any(axis=0)
        kept |= other[point] & one[segments[:, segment]].any(axis=0)
        point, segment = point[~kept], segment[~kept]
    start, end = segments[:, segment]
    on = _ON * float(np.ptp(first, axis=1).max())
    shares = _met(first, motion, point, start, end, on)  # two of each pair
    at, a, b = (first[:, own, None] + shares * motion[:, own, None] for own in (point, start, end))
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.sum((at - a) * (b - a), axis=0) / np.sum((b - a) ** 2, axis=0)
    met = (part >= 0) & (part <= 1)  # not so of NaN
    if not met.any():
        return None
    shares = np.where(met, shares, np.inf)
    which = np.unravel_index(int(np.argmin(shares)), shares.shape)
    return Fold(name, at[:, which[0], which[1]], float(shares[which]))


def _polylines(mesh: Mesh) -> tuple[Floats, Ints]:
    """Points of the boundary (2, p), and segments as pairs of their numbers, (2, s)."""
    facets = mesh.boundary_facets()
    ends = mesh.facets[:, facets]
    used, numbers = np.unique(ends, return_inverse=True)
    numbers = numbers.reshape(ends.shape)
    curves = edge_curves(mesh, facets)
    inner = [curves.at(part / _PARTS) for part in range(1, _PARTS)]
    count = facets.size
    middle = [used.size + part * count + np.arange(count) for part in range(_PARTS - 1)]
    chain = [numbers[0], *middle, numbers[1]]
    segments = [np.stack([one, two]) for one, two in pairwise(chain)]
    return np.concatenate([mesh.p[:, used], *inner], axis=1), np.concatenate(segments, axis=1)


def _points_of(mesh: Mesh, edges: Ints) -> Bools:
    """Which points of the polylines lie on some edges."""
    facets = mesh.boundary_facets()
    used = np.unique(mesh.facets[:, facets])
    ends = np.isin(used, mesh.facets[:, edges])
    return np.concatenate([ends, np.tile(np.isin(facets, edges), _PARTS - 1)])


def _near(before: Floats, after: Floats, segments: Ints) -> tuple[Ints, Ints]:
    """Pairs of a point and a segment, not its own, whose ways lie in boxes that meet."""
    low, high = np.minimum(before, after), np.maximum(before, after)
    boxes = shapely.box(
        *low[:, segments].min(axis=1),
        *high[:, segments].max(axis=1),
    )
    point, segment = shapely.STRtree(boxes).query(shapely.box(*low, *high))
    apart = (segments[:, segment] != point).all(axis=0)
    return point[apart], segment[apart]


def _met(first: Floats, motion: Floats, point: Ints, start: Ints, end: Ints, on: float) -> Floats:
    """Return the shares of the motion at which points reach lines of segments, (n, 2), or NaN."""
    away, along = (first[:, own] - first[:, start] for own in (point, end))
    away_moves, along_moves = (motion[:, own] - motion[:, start] for own in (point, end))
    length = np.linalg.norm(along, axis=0)
    constant = _cross(along, away)
    linear = _cross(along_moves, away) + _cross(along, away_moves)
    square = _cross(along_moves, away_moves)
    root = np.sqrt(np.maximum(linear**2 - 4 * square * constant, 0.0))
    half = -(linear + np.where(linear < 0, -root, root)) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        roots = np.stack([constant / half, half / square], axis=1)
    real = (linear**2 >= 4 * square * constant) & (np.abs(constant) > on * length)
    within: Bools = (roots > 0) & (roots <= 1) & real[:, None]
    return np.where(within, roots, np.nan)


def _cross(one: Floats, other: Floats) -> Floats:
    return np.asarray(one[0] * other[1] - one[1] * other[0])
