"""Places given by numbers: boxes, lines, half-planes. These predicates can be written to files."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, inf

import numpy as np

from lacore.numerics.arrays import Bools, Floats
from lacore.reporting.errors import InputError, is_number, is_plane_vector, require_place
from lacore.reporting.showing import Compact
from lacore.reporting.text import Quantity, join, text

Extent = float | tuple[float, float] | None
_NEAR = 1e-9  # by the extent of the places: coordinates in double precision agree to this


@dataclass(frozen=True, repr=False)
class Within(Compact):
    """Places in a box: ``la.Within(x=(0, 1), y=0)`` is the line y = 0 from x = 0 to 1.

    It includes its sides, and places within 1e-9 of the size of the body.

    Attributes:
        x, y: a number, or the least and the greatest one (which may be infinite), m; None: any.

    Raises:
        InputError: neither x nor y, invalid numbers, or an interval with its larger end first.

    Example:
        >>> under = la.Within(x=(0, 1), y=0)  # a line 1 m long
        >>> under(np.array([[0.5, 2.0], [0.0, 0.0]]))
        array([ True, False])
    """

    x: Extent = None
    y: Extent = None

    def __post_init__(self) -> None:
        if self.x is None and self.y is None:
            raise InputError("Within", None, "neither x nor y", "give one of them, or both")
        for name in ("x", "y"):
            given = getattr(self, name)
            if given is not None:
                object.__setattr__(self, name, _extent(f"Within.{name}", given))

    @property
    def told(self) -> str:
        """Short text: ``(x = 0 to 1 m, y = 0 m)``."""
        own = [
            text("{} = {}", name, _said(at))
            for name, at in (("x", self.x), ("y", self.y))
            if at is not None
        ]
        return text("({})", join(", ", own))

    def __call__(self, places: Floats) -> Bools:
        """Return which of the places of shape (2, n) lie in it, shape (n,)."""
        _require_plane("Within", places)
        slack = _slack(places)
        inside = np.ones(places.shape[1], dtype=bool)
        for own, values in zip((self.x, self.y), places, strict=True):
            if own is not None:
                low, high = own if isinstance(own, tuple) else (own, own)
                inside &= (values >= low - slack) & (values <= high + slack)
        return inside


@dataclass(frozen=True, repr=False)
class Along(Compact):
    """Places on a straight line between two points, up to 1e-9 of the size of the body.

    Attributes:
        start, end: m.

    Raises:
        InputError: invalid points, or the same point twice.

    Example:
        >>> slope = la.Along(start=(0, 0), end=(4, 2))
        >>> slope(np.array([[2.0, 2.0], [1.0, 0.0]]))
        array([ True, False])
    """

    start: tuple[float, float]
    end: tuple[float, float]

    def __post_init__(self) -> None:
        for name in ("start", "end"):
            given = getattr(self, name)
            if not is_plane_vector(given):
                raise InputError(f"Along.{name}", given, "not a point", "give (x, y)")
            require_place(f"Along.{name}", given)
            object.__setattr__(self, name, tuple(map(float, given)))
        if self.start == self.end:
            raise InputError("Along.end", self.end, "where it starts", "give another point")

    @property
    def told(self) -> str:
        """Short text: ``(from (0, 0) to (1, 2) m)``."""
        ends = Quantity((*self.start, *self.end), "m", ".4g", "({}, {}) to ({}, {})")
        return text("(from {})", ends)

    def __call__(self, places: Floats) -> Bools:
        """Return which of the places of shape (2, n) lie on it, shape (n,)."""
        _require_plane("Along", places)
        slack = _slack(places)
        (x, y), (u, v) = self.start, (b - a for a, b in zip(self.start, self.end, strict=True))
        length = hypot(u, v)
        along = ((places[0] - x) * u + (places[1] - y) * v) / length
        off = ((places[1] - y) * u - (places[0] - x) * v) / length
        return np.asarray((np.abs(off) <= slack) & (along >= -slack) & (along <= length + slack))


@dataclass(frozen=True, repr=False)
class Beyond(Compact):
    """Places on a line, and on the side that its normal points to.

    Attributes:
        point: point on the line, m.
        normal: normal of any length.

    Raises:
        InputError: invalid vectors, or a normal without a direction.

    Example:
        >>> right = la.Beyond(point=(1, 0), normal=(1, 0))  # x >= 1
        >>> right(np.array([[0.0, 2.0], [0.0, 0.0]]))
        array([False,  True])
    """

    point: tuple[float, float]
    normal: tuple[float, float]

    def __post_init__(self) -> None:
        for name in ("point", "normal"):
            given = getattr(self, name)
            if not is_plane_vector(given):
                fix = "give two finite numbers"
                raise InputError(f"Beyond.{name}", given, "not a plane vector", fix)
            require_place(f"Beyond.{name}", given)
            object.__setattr__(self, name, tuple(map(float, given)))
        if not hypot(*self.normal):
            raise InputError("Beyond.normal", self.normal, "has no direction", "give one != 0")

    @property
    def told(self) -> str:
        """Short text: ``(beyond (0, 0) m along 1, 2)``."""
        u, v = self.normal
        return text(
            "(beyond {} along {}, {})", Quantity(self.point, "m", ".4g"), f"{u:.4g}", f"{v:.4g}"
        )

    def __call__(self, places: Floats) -> Bools:
        """Return which of the places of shape (2, n) lie there, shape (n,)."""
        _require_plane("Beyond", places)
        (x, y), (u, v) = self.point, self.normal
        away = ((places[0] - x) * u + (places[1] - y) * v) / hypot(u, v)
        return np.asarray(away >= -_slack(places))


def _said(extent: float | tuple[float, float]) -> Quantity:
    if isinstance(extent, tuple):
        return Quantity(extent, "m", ".4g", "{} to {}")
    return Quantity(float(extent), "m", ".4g")


def _require_plane(field: str, places: Floats) -> None:
    """Raise `InputError` for three-dimensional places, where these shapes differ."""
    if len(places) != 2:
        why = "states places in the plane, and the body is three-dimensional"
        fix = "give a function of coordinates (3, n): lambda x: x[2] == 0"
        raise InputError(field, None, why, fix)


def _slack(places: Floats) -> float:
    return _NEAR * float(np.abs(places).max(initial=0.0))


def _extent(field: str, given: object) -> float | tuple[float, float]:
    if is_number(given):
        require_place(field, given)
        return float(given)  # type: ignore[arg-type]
    ends = given if isinstance(given, tuple | list) else ()
    if len(ends) != 2 or not all(is_number(end) or end in (inf, -inf) for end in ends):
        raise InputError(field, given, "no extent", "give a number, or (least, greatest)")
    low, high = (float(end) for end in ends)
    if not low < high:
        raise InputError(field, given, "its ends are not in order", "give (least, greatest)")
    require_place(field, [end for end in (low, high) if abs(end) < inf])
    return low, high
