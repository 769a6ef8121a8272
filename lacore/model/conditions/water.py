"""Water in the pores of a body, and standing on its boundary (T64)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lacore.model.conditions.where import Where, where_name
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError, is_number, require_positive, require_range
from lacore.reporting.showing import Compact
from lacore.reporting.text import Quantity, Term, text

WATER = 9.81e3
"""Unit weight of fresh water, N/m^3."""
_ROUND_OFF = 1e-12  # by the largest pressure: smaller negative values are not suction


@dataclass(frozen=True, repr=False)
class WaterTable(Compact):
    """Water at rest below a height: ``u = unit_weight (height - y)`` there, and 0 above it.

    Attributes:
        height: height y of its surface (z for axisymmetric bodies), m.
        unit_weight: N/m^3.

    Raises:
        InputError: an invalid height, or a weight that is not positive.

    Example:
        >>> table = la.WaterTable(height=-1.0)
        >>> table(np.array([[0.0, 0.0], [0.0, -2.0]])).tolist()  # Pa
        [0.0, 9810.0]
    """

    height: float
    unit_weight: float = WATER

    def __post_init__(self) -> None:
        if not is_number(self.height):
            raise InputError(
                "WaterTable.height", self.height, "not a number", "give the y of its surface in m"
            )
        require_positive("WaterTable.unit_weight", self.unit_weight)

    def __call__(self, x: Floats) -> Floats:
        """Return the pressure at places of shape (2, n), Pa, shape (n,)."""
        return np.asarray(self.unit_weight * np.maximum(self.height - x[1], 0.0))

    @property
    def told(self) -> str:
        """Short text."""
        return text("water at rest below y = {}", Quantity(self.height, "m", ".7g"))


@dataclass(frozen=True, repr=False)
class PiezometricLine(Compact):
    """Water below a line of points: ``u = unit_weight (h(x) - y)`` there, and 0 above it.

    The level h(x) is linear between the points, and constant beyond the first and the last one. In
    elements and edges that the line crosses, the pressure is linear between their vertices.

    Attributes:
        points: (x, y) with increasing x, m.
        unit_weight: N/m^3.

    Raises:
        InputError: fewer than two points, values that are not finite, or x that does not increase.

    Example:
        >>> line = la.PiezometricLine([(0, 4), (10, 2)], unit_weight=10e3)
        >>> line(np.array([[5.0, 20.0], [0.0, 0.0]])).tolist()  # Pa
        [30000.0, 20000.0]
    """

    points: Sequence[Sequence[float]]
    unit_weight: float = WATER

    def __post_init__(self) -> None:
        field = "PiezometricLine.points"
        fix = "give [(x, y), ...] from left to right, at least two"
        try:
            points = np.array(self.points, dtype=np.float64)
        except (TypeError, ValueError):
            raise InputError(field, None, "not a list of points", fix) from None
        if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2:
            raise InputError(field, None, "not a list of points", fix)
        if not np.isfinite(points).all():
            raise InputError(field, None, "has points that are not finite", fix)
        back = np.flatnonzero(np.diff(points[:, 0]) <= 0)
        if back.size:
            x = float(points[back[0] + 1, 0])
            raise InputError(f"{field}[{back[0] + 1}]", x, "x does not increase", fix)
        object.__setattr__(self, "points", tuple(map(tuple, points.tolist())))
        require_positive("PiezometricLine.unit_weight", self.unit_weight)

    def __call__(self, x: Floats) -> Floats:
        """Return the pressure at places of shape (2, n), Pa, shape (n,)."""
        level = np.interp(x[0], *np.transpose(self.points))
        return np.asarray(self.unit_weight * np.maximum(level - x[1], 0.0))

    @property
    def told(self) -> str:
        """Short text."""
        return f"water below a line of {len(self.points)} points"


@dataclass(frozen=True, repr=False)
class PorePressure(Compact):
    """Pressure u >= 0 of the pore water in a body; its criterion applies to ``sigma + u I``.

    Stresses of a program are therefore effective ones, and results give both (T64). In each element
    u is linear (bilinear on quadrilaterals) between its values at the vertices, and this problem is
    solved and bounded: let edges of the mesh follow a water table. Materials without friction are
    not affected. Water also presses in contacts with obstacles, whose friction depends on the
    remaining pressure. A body under free water is also loaded by it: `StandingWater`.

    Attributes:
        body: name of the body.
        pressure: u in Pa: a `WaterTable`, a function of coordinates of shape (2, n) that returns n
            values, the values at the vertices of the mesh, or one number for all of the body.

    Raises:
        InputError: suction, or an invalid pressure.

    Example:
        >>> wet = la.PorePressure("soil", la.WaterTable(height=-1.0))
    """

    body: str
    pressure: float | Sequence[float] | Callable[[Floats], Floats]
    boundary: ClassVar[None] = None
    point: ClassVar[None] = None

    def __post_init__(self) -> None:
        field, given = "PorePressure.pressure", self.pressure
        if callable(given):
            return
        if isinstance(given, Sequence | np.ndarray) and not isinstance(given, str):
            values = _values(field, np.shape(given)[:1], given)
            object.__setattr__(self, "pressure", tuple(values.tolist()))
        elif is_number(given):
            _values(field, (1,), [given])
        else:
            raise InputError(
                field,
                given,
                "no pressure",
                text(
                    "give {}, or a number, in Pa",
                    Term(
                        "a lacore.WaterTable, a function of coordinates (2, n), the values at the"
                        " vertices of the mesh",
                        "{ height = ... }",
                    ),
                ),
            )

    @property
    def told(self) -> str:
        """Short text."""
        return text("{} in the pores of {}", _told(self.pressure), self.body)

    def at(self, vertices: Floats, field: str) -> Floats:
        """Return the values at all vertices of the body's mesh, of shape (2, n), Pa, shape (n,).

        Raises:
            InputError: suction, NaN, or values of another mesh; it names the `field` of the load.
        """
        count = vertices.shape[1]
        if isinstance(self.pressure, tuple):
            return _values(f"{field}.pressure", (count,), self.pressure)
        if callable(self.pressure):
            return _called(f"{field}.pressure", self.pressure, vertices)
        return np.full(count, self.pressure, dtype=np.float64)


@dataclass(frozen=True, repr=False)
class StandingWater(Compact):
    """Pressure of free water on a part of the boundary, against its outward normal.

    It is linear along each edge between the values at its ends.

    Attributes:
        body, where: the part of the boundary.
        pressure: a `WaterTable`, or a function of coordinates of shape (2, n) that returns n
            pressures in Pa.

    Raises:
        InputError: an invalid function.

    Example:
        >>> lake = la.StandingWater("dam", "left", la.WaterTable(height=5.0))
    """

    body: str
    where: Where
    pressure: Callable[[Floats], Floats]
    point: ClassVar[None] = None

    def __post_init__(self) -> None:
        if not callable(self.pressure):
            raise InputError(
                "StandingWater.pressure",
                self.pressure,
                "not a function of coordinates",
                text(
                    "give {}; what is uniform is {}",
                    Term("a lacore.WaterTable(height)", "{ height = ... }"),
                    Term("a lacore.Pressure", 'load = "pressure"'),
                ),
            )

    @property
    def boundary(self) -> Where:
        """The part of the boundary that it acts on."""
        return self.where

    @property
    def told(self) -> str:
        """Short text."""
        return text("{} on {}.{}", _told(self.pressure), self.body, where_name(self.where))

    def at(self, places: Floats, field: str) -> Floats:
        """Return the values at places of shape (2, n), Pa, shape (n,).

        Raises:
            InputError: suction, NaN, or another shape; it names the `field` of the load.
        """
        return _called(f"{field}.pressure", self.pressure, places)


def _told(pressure: float | Sequence[float] | Callable[[Floats], Floats]) -> str:
    if isinstance(pressure, WaterTable | PiezometricLine):
        return pressure.told
    if callable(pressure):
        return "water pressure of a function"
    if isinstance(pressure, Sequence):
        return text("water of up to {}", Quantity(max(pressure), "Pa", ".7g"))
    return text("water of {}", Quantity(pressure, "Pa", ".7g"))


def _called(field: str, pressure: Callable[[Floats], Floats], places: Floats) -> Floats:
    try:
        given = pressure(places)
    except Exception as error:  # functions of users
        raise InputError(
            field,
            None,
            f"the function fails for coordinates (2, n): {type(error).__name__}: {error}",
            "it takes one array x, whose rows are x[0] and x[1], and returns n pressures in Pa",
        ) from error
    return _values(field, places.shape[1:], given)


def _values(field: str, shape: tuple[int, ...], given: object) -> Floats:
    """Return pressures of a shape; raises `InputError` for others."""
    try:
        values = np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(
            field, type(given).__name__, "no numbers", "give pressures in Pa"
        ) from None
    if values.shape != shape:
        raise InputError(
            field,
            values.shape,
            f"there are {shape[0]} places, and as many pressures are needed",
            "give one a vertex of the mesh, or a function of coordinates x of shape (2, n) that"
            " returns n",
        )
    if not np.isfinite(values).all():
        raise InputError(
            field, values[~np.isfinite(values)][0], "not a pressure", "give finite values in Pa"
        )
    largest, least = float(values.max(initial=0.0)), float(values.min(initial=0.0))
    if least < -_ROUND_OFF * largest:
        raise InputError(
            field,
            least,
            "suction, which lends a strength that a little rain takes away",
            "give pressures >= 0, np.maximum(u, 0); a strength meant to last is cohesion",
        )
    require_range(field, largest)
    return np.maximum(values, 0.0)
