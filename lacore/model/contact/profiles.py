"""Profiles of lines and arcs: signed distances and normals, exact up to round-off."""

from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Bools, Floats
from lacore.reporting.showing import Compact

_SAME = 1e-9  # by the coordinates: closer to a corner, a point has no direction from it


@dataclass(frozen=True, repr=False)
class Lines(Compact):
    """k straight pieces with the solid on their left.

    Attributes:
        origin, along: point, m, and unit direction of each, shape (2, k).
        low, high: distances from the origin at which each begins and ends, m, may be infinite.
    """

    origin: Floats
    along: Floats
    low: Floats
    high: Floats

    @property
    def outward(self) -> Floats:
        """Unit normals, shape (2, k)."""
        return np.stack([self.along[1], -self.along[0]])


@dataclass(frozen=True, repr=False)
class Arcs(Compact):
    """k circular arcs.

    Attributes:
        centre: centres, shape (2, k), m.
        radius: radii, m, shape (k,).
        start, sweep: angle at which each begins, and by which it turns, rad: anticlockwise around
            a solid, clockwise around a hollow, shape (k,).
    """

    centre: Floats
    radius: Floats
    start: Floats
    sweep: Floats


@dataclass(frozen=True, repr=False)
class InnerCorner(Compact):
    """Corner of two lines that both keep a point out of the solid.

    Attributes:
        place: m, shape (2,).
        normals: normals of the two lines, out of the solid, shape (2, 2), one in each row.
        reach: length of the shorter line, m.
    """

    place: Floats
    normals: Floats
    reach: float

    @property
    def bisector(self) -> Floats:
        """Unit normal of a `Profile` at the corner, the mean of both, shape (2,)."""
        mean = self.normals.sum(axis=0)
        return np.asarray(mean / np.linalg.norm(mean))


@dataclass(frozen=True, repr=False)
class Profile(Compact):
    """Face of a solid, made of lines and arcs.

    Attributes:
        lines, arcs: its pieces.
        corners: where lines meet at an angle, m, shape (2, c).
        bisectors: unit normals there, the means of both sides, shape (2, c).
        convex: whether the solid is convex there, shape (c,).
    """

    lines: Lines
    arcs: Arcs
    corners: Floats
    bisectors: Floats
    convex: Bools

    def distance_and_normal(self, points: Floats) -> tuple[Floats, Floats]:
        """Return the signed distances, m, shape (n,), negative inside, and unit normals.

        The shape is (2, n).
        """
        place, normal = self._nearest(points)
        away = points - place
        distance = np.sum(away * normal, axis=0)
        if self.corners.shape[1]:
            gap = points[:, :, None] - self.corners[:, None]
            length = np.linalg.norm(gap, axis=0)
            which = np.argmin(length, axis=1)
            length = length[np.arange(which.size), which]
            direct = np.linalg.norm(away, axis=0)
            scale = max(float(np.abs(points).max(initial=0.0)), float(np.abs(self.corners).max()))
            at = length <= np.maximum(direct * (1 + _SAME), _SAME * scale)
            bisector = self.bisectors[:, which]
            towards = gap[:, np.arange(which.size), which]
            side = np.where(np.sum(towards * bisector, axis=0) < 0, -1.0, 1.0)
            near = length <= _SAME * scale
            radial = side * towards / np.where(~near, length, 1.0)
            normal = np.where(at, np.where(near, bisector, radial), normal)
            distance = np.where(at, side * length, distance)
        return np.asarray(distance), np.asarray(normal)

    def _nearest(self, points: Floats) -> tuple[Floats, Floats]:
        """Return the closest places on all pieces, and their normals there, shape (2, n)."""
        found = [own for own in (self._on_lines(points), self._on_arcs(points)) if own[0].size]
        places, normals = (np.concatenate(part, axis=2) for part in zip(*found, strict=True))
        away = np.linalg.norm(points[:, :, None] - places, axis=0)
        which, every = np.argmin(away, axis=1), np.arange(points.shape[1])
        return places[:, every, which], normals[:, every, which]

    def _on_lines(self, points: Floats) -> tuple[Floats, Floats]:
        own = self.lines
        away = points[:, :, None] - own.origin[:, None]
        t = np.clip(np.einsum("ink,ik->nk", away, own.along), own.low, own.high)
        places = own.origin[:, None] + own.along[:, None] * t
        return places, np.broadcast_to(own.outward[:, None], places.shape)

    def _on_arcs(self, points: Floats) -> tuple[Floats, Floats]:
        own = self.arcs
        away = points[:, :, None] - own.centre[:, None]
        turn = np.copysign(1.0, own.sweep)  # also of an arc without a sweep
        angle = turn * (np.arctan2(away[1], away[0]) - own.start) % (2 * np.pi)
        # Beyond an arc, the other end may be closer: the adjacent line covers it.
        angle = own.start + turn * np.minimum(angle, np.abs(own.sweep))
        ray = np.stack([np.cos(angle), np.sin(angle)])
        return own.centre[:, None] + own.radius * ray, turn * ray


def no_arcs() -> Arcs:
    """Return an empty set of arcs."""
    return Arcs(np.zeros((2, 0)), np.zeros(0), np.zeros(0), np.zeros(0))


def corner(before: Floats, after: Floats) -> tuple[Floats, Bools]:
    """Return the bisectors (2, c) of corners between directions (2, c), and which are convex."""
    mean = np.stack([before[1] + after[1], -before[0] - after[0]])
    convex = before[0] * after[1] - before[1] * after[0] > 0
    return mean / np.linalg.norm(mean, axis=0), convex
