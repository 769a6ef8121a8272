"""Shapes of rigid tools and obstacles: planes, wedges, discs, and polygons with rounded corners.

Each is a `lacore.model.contact.obstacles.Shape`, for `lacore.Tool` and
`lacore.RigidObstacle(shape=...)`, with exact distances and normals. Its `reference` is the point
that `Tool.velocity` moves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from typing import Any

import numpy as np
import shapely

from lacore.model.contact.obstacles import Plane
from lacore.model.contact.profiles import Arcs, InnerCorner, Lines, Profile, corner, no_arcs
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import (
    InputError,
    is_number,
    is_plane_vector,
    require_place,
    require_positive,
)
from lacore.reporting.showing import Compact
from lacore.reporting.text import Quantity, Term, text

__all__ = ["Disc", "Outline", "Wedge", "disc", "outline", "plane", "read_outline", "wedge"]

_FINE = np.radians(5.0)  # step of a drawn arc
_FITS = 1e-12  # by an edge: round-off of roundings

Point = tuple[float, float]


@dataclass(frozen=True, repr=False)
class Disc(Compact):
    """A disc.

    Attributes:
        centre: m.
        radius: m.

    Example:
        >>> la.shapes.Disc(centre=(0, 2), radius=1).distance(np.array([[0.0], [0.5]]))
        array([0.5])
    """

    centre: Point
    radius: float

    @property
    def reference(self) -> Point:
        """Its centre."""
        return self.centre

    def distance(self, places: Floats) -> Floats:
        """Return the distance, see `Shape`."""
        return np.asarray(np.linalg.norm(self._away(places), axis=0) - self.radius)

    def normal(self, places: Floats) -> Floats:
        """Return the normals, see `Shape`."""
        away = self._away(places)
        return np.asarray(away / np.linalg.norm(away, axis=0))

    def outline(self, low: Floats, high: Floats) -> Floats:
        """Return the whole outline, see `Shape`."""
        return self._at(np.arange(0, 2 * np.pi + _FINE / 2, _FINE))

    def _away(self, places: Floats) -> Floats:
        return np.asarray(places - np.reshape(self.centre, (2, 1)))

    def _at(self, angle: Floats) -> Floats:
        circle = np.stack([np.cos(angle), np.sin(angle)])
        return np.asarray(np.reshape(self.centre, (2, 1)) + self.radius * circle)


class _Profiled(Compact):
    """A shape made of lines and arcs."""

    @cached_property
    def profile(self) -> Profile:
        """Its face."""
        raise NotImplementedError

    @property
    def corners(self) -> Floats:
        """Sharp convex corners, m, shape (2, c), which may rest on an edge of a body."""
        return self.profile.corners[:, self.profile.convex]

    def distance(self, places: Floats) -> Floats:
        """Return the distance, see `Shape`."""
        return self.profile.distance_and_normal(places)[0]

    def normal(self, places: Floats) -> Floats:
        """Return the normals, see `Shape`."""
        return self.profile.distance_and_normal(places)[1]


@dataclass(frozen=True, repr=False)
class Wedge(_Profiled):
    """Unbounded wedge.

    Attributes:
        tip: m.
        half_angle: angle between its axis and a face, degrees.
        axis: direction from the tip into the wedge, of length 1.

    Example:
        >>> la.shapes.Wedge(tip=(0, 0), half_angle=45).normal(np.array([[1.0], [0.0]])).round(3)
        array([[ 0.707],
               [-0.707]])
    """

    tip: Point
    half_angle: float
    axis: Point = (0.0, 1.0)

    @property
    def reference(self) -> Point:
        """Its tip."""
        return self.tip

    @cached_property
    def profile(self) -> Profile:
        """Its two faces to and from the tip, with the solid on their left."""
        tip = np.repeat(np.reshape(self.tip, (2, 1)), 2, axis=1)
        first, second = self._faces
        along = np.stack([-first, second], axis=1)
        low, high = np.array([-np.inf, 0.0]), np.array([0.0, np.inf])
        bisector, convex = corner(along[:, :1], along[:, 1:])
        lines = Lines(tip, along, low, high)
        return Profile(lines, no_arcs(), tip[:, :1], bisector, convex)

    def outline(self, low: Floats, high: Floats) -> Floats:
        """Return the outline, see `Shape`."""
        tip = np.array(self.tip)
        far = float(np.linalg.norm(high - low) + np.linalg.norm((low + high) / 2 - tip))
        first, second = self._faces
        return np.stack([tip + far * first, tip, tip + far * second], axis=1)

    @property
    def _faces(self) -> tuple[Floats, Floats]:
        """Directions of the faces from the tip: left and right of the axis."""
        (x, y), angle = self.axis, np.radians(self.half_angle)
        c, s = np.cos(angle), np.sin(angle)
        return np.array([c * x - s * y, s * x + c * y]), np.array([c * x + s * y, c * y - s * x])


@dataclass(frozen=True, repr=False)
class Outline(_Profiled):
    """A polygon whose corners are sharp or rounded.

    Attributes:
        points: its corners before they are rounded, anticlockwise, m.
        radii: radii of the corners, m; 0 for a sharp one.

    Example:
        >>> la.shapes.Outline(((0, 0), (2, 0), (2, 1), (0, 1)), radii=(0, 0, 0, 0)).reference
        (1.0, 0.5)
    """

    points: tuple[Point, ...]
    radii: tuple[float, ...]

    @property
    def reference(self) -> Point:
        """The centroid of the polygon."""
        centre = shapely.Polygon(self.points).centroid
        return float(centre.x), float(centre.y)

    @cached_property
    def profile(self) -> Profile:
        """Edges, shortened where corners are rounded, and arcs between them."""
        own, (before, after) = np.array(self.points).T, self._directions
        taken, radius = _taken(before, after, np.array(self.radii)), np.array(self.radii)
        following = np.roll(np.arange(radius.size), -1)
        length = np.linalg.norm(own[:, following] - own, axis=0)
        lines = Lines(own, after, taken, length - taken[following])
        sharp, curved = radius == 0, np.flatnonzero(radius)
        bisectors, convex = corner(before[:, sharp], after[:, sharp])
        turn = _turn(before, after)[curved]
        start = np.stack([before[1], -before[0]])[:, curved] * np.copysign(1.0, turn)
        ends = (own - taken * before)[:, curved]
        angle = np.arctan2(start[1], start[0])
        arcs = Arcs(ends - start * radius[curved], radius[curved], angle, turn)
        return Profile(lines, arcs, own[:, sharp], bisectors, convex)

    @property
    def inner(self) -> list[InnerCorner]:
        """Sharp reentrant corners of the solid, such as that of a container and its die."""
        before, after = self._directions
        lines = self.profile.lines
        length = lines.high - lines.low
        hollow = (np.array(self.radii) == 0) & (_turn(before, after) < 0)
        return [
            InnerCorner(
                np.array(self.points[at]),
                np.stack([[own[1, at], -own[0, at]] for own in (before, after)]),
                float(min(length[at - 1], length[at])),
            )
            for at in np.flatnonzero(hollow).tolist()
        ]

    def outline(self, low: Floats, high: Floats) -> Floats:
        """Return the whole outline, see `Shape`."""
        arcs = self.profile.arcs
        drawn, number = [], 0
        for point, radius in zip(self.points, self.radii, strict=True):
            if not radius:
                drawn.append(np.reshape(point, (2, 1)))
                continue
            sweep = arcs.sweep[number]
            angle = arcs.start[number] + sweep * np.linspace(0, 1, 2 + int(abs(sweep) / _FINE))
            circle = np.stack([np.cos(angle), np.sin(angle)])
            drawn.append(arcs.centre[:, number, None] + radius * circle)
            number += 1
        return np.concatenate([*drawn, drawn[0][:, :1]], axis=1)

    @property
    def _directions(self) -> tuple[Floats, Floats]:
        """Directions of the edges before and after each corner, shape (2, k) each."""
        own = np.array(self.points).T
        after = np.roll(own, -1, axis=1) - own
        after = after / np.linalg.norm(after, axis=0)
        return np.roll(after, 1, axis=1), after


def plane(point: Point, normal: Point) -> Plane:
    """Return a plane through a point whose normal points out of the tool, towards the bodies.

    Example:
        >>> la.shapes.plane(point=(0, 1), normal=(0, -2)).direction
        (0.0, -1.0)
    """
    _require_direction("shapes.plane.normal", normal)
    return Plane.through(_place("shapes.plane.point", point), np.array(normal, dtype=float))


def disc(centre: Point, radius: float) -> Disc:
    """Return a disc.

    Example:
        >>> la.shapes.disc(centre=(0, 2), radius=1).reference
        (0.0, 2.0)
    """
    require_positive("shapes.disc.radius", radius)
    x, y = _place("shapes.disc.centre", centre).tolist()
    return Disc((x, y), float(radius))


def wedge(tip: Point, half_angle: float, axis: Point = (0, 1)) -> Wedge:
    """Return a wedge without end.

    Args:
        tip: m.
        half_angle: between the axis and a face, degrees, above 0 and below 90.
        axis: direction from the tip into the wedge, of any length.

    Example:
        >>> la.shapes.wedge(tip=(0, 0), half_angle=30).distance(np.array([[0.0], [-2.0]]))
        array([2.])
    """
    if not (is_number(half_angle) and 0 < half_angle < 90):
        raise InputError(
            "shapes.wedge.half_angle",
            half_angle,
            "not an angle between 0 and 90 degrees",
            text(
                "give the angle between the axis and a face; a flat tool is {}",
                Term("la.shapes.plane", 'tool = "plane"'),
            ),
        )
    _require_direction("shapes.wedge.axis", axis)
    x, y = _place("shapes.wedge.tip", tip).tolist()
    along = np.array(axis, dtype=float)
    a, b = (along / np.linalg.norm(along)).tolist()
    return Wedge((x, y), float(half_angle), (a, b))


def outline(points: Sequence[Point], rounding: float | Sequence[float] = 0.0) -> Outline:
    """Return a polygon with sharp or rounded corners.

    Args:
        points: corners, clockwise or anticlockwise, m.
        rounding: radius of all corners, or one radius per corner, m; 0 is sharp.

    Example:
        >>> punch = la.shapes.outline([(-1, 0), (1, 0), (1, 2), (-1, 2)], rounding=[0.1, 0.1, 0, 0])
        >>> punch.distance(np.array([[0.0, 1.0], [-1.0, 0.0]])).round(4)
        array([1.    , 0.0414])
    """
    field = "shapes.outline.points"
    if not isinstance(points, Sequence | np.ndarray) or len(points) < 3:
        raise InputError(field, points, "fewer than 3 corners", "give [(x, y), (x, y), (x, y)]")
    corners = [_place(f"{field}[{number}]", own) for number, own in enumerate(points)]
    polygon = shapely.Polygon(corners)
    if not polygon.is_valid or not polygon.area > 0:
        why = "its area is zero" if polygon.is_valid else shapely.is_valid_reason(polygon)
        raise InputError(field, points, f"not a polygon: {why}", "list the corners in order")
    radii: Any = [rounding] * len(corners) if is_number(rounding) else rounding
    if not isinstance(radii, Sequence | np.ndarray) or len(radii) != len(corners):
        raise InputError(
            "shapes.outline.rounding",
            rounding,
            f"not one radius per corner, of which there are {len(corners)}",
            "give a number, or a list with one number per corner",
        )
    if not all(is_number(radius) and radius >= 0 for radius in radii):
        raise InputError(
            "shapes.outline.rounding", rounding, "not radii", "give numbers of at least 0, in m"
        )
    if not polygon.exterior.is_ccw:
        corners, radii = corners[::-1], list(radii)[::-1]
    found = Outline(
        tuple((float(x), float(y)) for x, y in corners), tuple(float(own) for own in radii)
    )
    _require_fitting(found)
    return found


def read_outline(
    path: str | PathLike[str],
    layer: str | None = None,
    unit: str | None = None,
    sagitta: float | None = None,
    rounding: float | Sequence[float] = 0.0,
) -> Outline:
    """Return the polygon in a drawing, read as by `lacore.masonry.read`.

    Args:
        path: path of a .dxf or .geojson file with one closed outline, or lines around one area.
        layer: layer of the outline; None: the only layer of the drawing.
        unit: "m", "dm", "cm", "mm", "km", "in", "ft" or "yd", in place of the file's; None: that of
            a DXF file.
        sagitta: m: largest distance of chords from curves; None: curves are rejected.
        rounding: see `outline`.

    Raises:
        InputError: a file that cannot be read, no unit, not one outline; see `outline`.

    Example:
        >>> import json
        >>> corners = [[0, 0], [500, 0], [500, 250], [0, 250], [0, 0]]
        >>> with open("punch.geojson", "w") as file:
        ...     json.dump({"type": "Polygon", "coordinates": [corners]}, file)
        >>> la.shapes.read_outline("punch.geojson", unit="mm").reference
        (0.25, 0.125)
    """
    # imported here, because it imports many readers
    from lacore.model.bodies.blocks.drawings.reading import read_outline

    return outline(read_outline(path, layer, unit, sagitta).tolist(), rounding)


def _require_fitting(own: Outline) -> None:
    """Raise `InputError` if roundings take more of an edge than its length."""
    lines = own.profile.lines
    short = lines.high - lines.low < -_FITS * np.abs(lines.high)
    if short.any():
        which = int(np.argmax(short))
        end = (which + 1) % len(own.points)
        raise InputError(
            "shapes.outline.rounding",
            (own.radii[which], own.radii[end]),
            text(
                "the roundings take {} more than the edge from {} to {} is long",
                Quantity(lines.low[which] - lines.high[which], "m", ".3g"),
                Quantity(tuple(own.points[which]), "m", ".6g"),
                Quantity(tuple(own.points[end]), "m", ".6g"),
            ),
            "give smaller radii",
        )


def _turn(before: Floats, after: Floats) -> Floats:
    """Return the angles by which the outline turns at its corners, rad, shape (k,)."""
    across = before[0] * after[1] - before[1] * after[0]
    return np.asarray(np.arctan2(across, np.sum(before * after, axis=0)))


def _taken(before: Floats, after: Floats, radius: Floats) -> Floats:
    """Return the length that roundings take of each edge at a corner, m, shape (k,)."""
    return np.asarray(radius * np.tan(np.abs(_turn(before, after)) / 2))


def _place(field: str, given: object) -> Floats:
    if not is_plane_vector(given):
        raise InputError(field, given, "not a point", "give (x, y), in m")
    require_place(field, given)
    return np.asarray(given, dtype=float)


def _require_direction(field: str, given: Any) -> None:
    if not (is_plane_vector(given) and np.any(given)):
        raise InputError(field, given, "not a direction", "give two numbers, not both 0")
