"""Rigid footings and plates: the body under them moves with them, and loads act on their motion."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import hypot
from typing import ClassVar, Self

import numpy as np

from lacore.model.conditions.where import Where, where_name
from lacore.numerics.arrays import Floats
from lacore.reporting import terms
from lacore.reporting.errors import InputError, is_number, is_vector, require_place, require_range
from lacore.reporting.showing import Compact, short
from lacore.reporting.text import Quantity, text

TURNS = ("x", "y", "z", "xy", "xz", "yz", "xyz")


def check_vector(field: str, vector: Sequence[float], unit: str) -> None:
    """Raise `InputError` where a value is no vector of the plane or of space."""
    if not is_vector(vector):
        fix = f"give two finite numbers in {unit}, in three dimensions three"
        raise InputError(field, vector, "not a vector", fix)
    require_range(field, vector)


def check_size(field: str, value: float, unit: str) -> None:
    """Raise `InputError` if a value is not a number."""
    if not is_number(value):
        raise InputError(field, value, "not a number", f"give a finite value in {unit}")
    require_range(field, value)


class Footing(Compact):
    """Support of a part of the boundary of a body that moves with a few speeds.

    Its load drives the first speed; all others are free.
    """

    body: str
    where: Where
    point: ClassVar[None] = None

    @property
    def boundary(self) -> Where:
        """The part of the boundary under it."""
        return self.where

    @property
    def name(self) -> str:
        """For messages: ``soil: footing``."""
        return text("{}: {}", self.body, where_name(self.where))

    @property
    def speeds(self) -> int:
        """Number of speeds."""
        return 1

    @property
    def unloaded(self) -> Self:
        """Footing without its load, equal for footings with different loads."""
        raise NotImplementedError

    def driven_by(self, area: float) -> float:
        """Return the force, or torque, on the first speed of a footing over an area."""
        raise NotImplementedError

    def motion(self, places: Floats, speed: int = 0) -> Floats:
        """Return the velocity per one of its speeds at places of shape (d, ...), of that shape."""
        raise NotImplementedError

    def held(self, outward: Floats) -> tuple[Floats, ...]:
        """Return the held directions of faces with outward normals (e, 3), (e, 3) each."""
        raise NotImplementedError


@dataclass(frozen=True, repr=False)
class RigidFooting(Footing):
    """Rigid footing that moves along `direction`, and loads the body under it.

    The load is a force of mean pressure `pressure` [Pa] along `direction`, so that the load factor
    is the mean footing pressure in units of `pressure`.

    Attributes:
        body, where: the part of the boundary under the footing; its ends are at vertices.
        direction: direction of motion and force; normalised.
        pressure: mean pressure, force divided by the area of `where` (of the whole ring or disc if
            the body is axisymmetric; then it moves along z).
        rough: the body sticks to the footing; else it slides along it without friction. In either
            case it does not lift off.
        turning: for three-dimensional bodies, axes about which it rotates freely: ``x``, ``xy``,
            ...; for a symmetric half those that keep its plane. None: it does not rotate.
        through: point where its force acts and these axes meet, m; required if it rotates. A
            footing that does not rotate carries a force at any point.

    Example:
        >>> under = la.Within(x=(0, 1), y=0)
        >>> footing = la.RigidFooting("soil", under, direction=(0, -1), pressure=1e3)  # Pa
    """

    body: str
    where: Where
    direction: tuple[float, ...]
    pressure: float = 1.0
    rough: bool = True
    turning: str | None = None
    through: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        check_vector("RigidFooting.direction", self.direction, "any unit")
        check_size("RigidFooting.pressure", self.pressure, "Pa")
        for name, given in (("direction", self.direction), ("pressure", self.pressure)):
            if not np.any(given):
                raise InputError(
                    f"RigidFooting.{name}",
                    given,
                    text(
                        "is zero: a footing is driven by its load, and held by a {}", terms.SUPPORT
                    ),
                    f"give a {name} != 0",
                )
        if self.turning is not None and self.turning not in TURNS:
            raise InputError(
                "RigidFooting.turning", self.turning, "no axes", f"give one of {', '.join(TURNS)}"
            )
        if (self.turning is None) != (self.through is None):
            raise InputError(
                "RigidFooting.through",
                self.through,
                "a footing that turns has a place where its force acts, and no other asks for one",
                "give both turning='xy' and through=(x, y, z), or none",
            )
        if self.through is not None:
            _check_place("RigidFooting.through", self.through)
            if len(self.direction) != len(self.through):
                raise InputError(
                    "RigidFooting.through",
                    self.through,
                    "of another space than direction: footings turn in three dimensions only",
                    text(
                        "give three numbers each; in the plane bond a {} to the body ({}) and load"
                        " that",
                        terms.RIGID_BLOCK,
                        terms.BOND,
                    ),
                )
            object.__setattr__(self, "through", tuple(map(float, self.through)))
        # Footings are compared by value, so a direction given as a list must be made hashable.
        length = hypot(*self.direction)
        object.__setattr__(self, "direction", tuple(float(c / length) for c in self.direction))

    @property
    def speeds(self) -> int:
        """Along its direction, then about its axes."""
        return 1 + len(self.turning or "")

    @property
    def unloaded(self) -> RigidFooting:
        """See `Footing`."""
        return replace(self, pressure=1.0)

    @property
    def size(self) -> float:
        """Mean pressure >= 0, in Pa."""
        return abs(self.pressure)

    def times(self, factor: float) -> Self:
        """Return the same footing with another size of its load."""
        return replace(self, pressure=factor * self.pressure)

    def driven_by(self, area: float) -> float:
        """Return the force along its direction, N/m, in three dimensions N."""
        return self.pressure * area

    def motion(self, places: Floats, speed: int = 0) -> Floats:
        """Return the velocity, see `Footing`; rotations in rad/s."""
        if speed == 0:
            direction = np.reshape(self.direction, (-1, *(1,) * (places.ndim - 1)))
            return np.broadcast_to(direction, places.shape)
        assert self.turning is not None
        assert self.through is not None
        axis = np.eye(3)["xyz".index(self.turning[speed - 1])]
        return about(axis, self.through, places)

    def held(self, outward: Floats) -> tuple[Floats, ...]:
        """Return the held directions, see `Footing`."""
        if not self.rough:
            return (outward,)
        return tuple(np.broadcast_to(axis, outward.shape) for axis in np.eye(3))

    @property
    def told(self) -> str:
        """Short text."""
        turns = f", turning about {self.turning} at {short(self.through)}" if self.turning else ""
        return text(
            "footing on {}.{} along {}, {}{}",
            self.body,
            where_name(self.where),
            short(self.direction),
            Quantity(self.pressure, "Pa", ".7g"),
            turns,
        )


@dataclass(frozen=True, repr=False)
class Twist(Footing):
    """Rigid plate that rotates about an axis, and twists the three-dimensional body under it.

    The load is the torque `torque` about the axis, so that the load factor is the capacity of the
    plate in units of it.

    Attributes:
        body, where: the part of the boundary under the plate.
        axis: axis of rotation, by the right-hand rule; normalised.
        through: a point on it, m.
        torque: N m.
        warping: the body under the plate is free to move across it, as at the end of a long bar;
            else it sticks to the plate completely.

    Example:
        >>> plate = la.Twist("bar", "zmax", axis=(0, 0, 1), through=(0.5, 0.5, 0))
    """

    body: str
    where: Where
    axis: tuple[float, ...]
    through: tuple[float, ...] = (0.0, 0.0, 0.0)
    torque: float = 1.0
    warping: bool = True

    def __post_init__(self) -> None:
        check_size("Twist.torque", self.torque, "N m")
        for name, given in (("axis", self.axis), ("torque", self.torque)):
            if name == "axis":
                _check_place("Twist.axis", self.axis)
            if not np.any(given):
                fix = f"give {'an' if name == 'axis' else 'a'} {name} != 0"
                raise InputError(f"Twist.{name}", given, "is zero: nothing would turn", fix)
        _check_place("Twist.through", self.through)
        length = hypot(*self.axis)
        object.__setattr__(self, "axis", tuple(float(c / length) for c in self.axis))
        object.__setattr__(self, "through", tuple(map(float, self.through)))

    @property
    def unloaded(self) -> Twist:
        """See `Footing`."""
        return replace(self, torque=1.0)

    @property
    def size(self) -> float:
        """Torque >= 0, in N m."""
        return abs(self.torque)

    def times(self, factor: float) -> Self:
        """Return the same plate with another size of its torque."""
        return replace(self, torque=factor * self.torque)

    def driven_by(self, area: float) -> float:
        """Return the torque, N m."""
        return self.torque

    def motion(self, places: Floats, speed: int = 0) -> Floats:
        """Return the velocity, see `Footing`; in rad/s."""
        return about(np.array(self.axis), self.through, places)

    def held(self, outward: Floats) -> tuple[Floats, ...]:
        """Return the held directions, see `Footing`."""
        if not self.warping:
            return tuple(np.broadcast_to(axis, outward.shape) for axis in np.eye(3))
        least = np.eye(3)[np.argmin(np.abs(outward), axis=1)]
        along = np.cross(outward, least)
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        return along, np.cross(outward, along)

    @property
    def told(self) -> str:
        """Short text."""
        return text(
            "torque {} about {} on {}.{}",
            Quantity(self.torque, "N m", ".7g"),
            short(self.axis),
            self.body,
            where_name(self.where),
        )


def about(axis: Floats, through: Sequence[float], places: Floats) -> Floats:
    """Return the velocity of a rotation of 1 rad/s about an axis at places (3, ...)."""
    shape = (3, *(1,) * (places.ndim - 1))
    arm = places - np.reshape(through, shape)
    return np.asarray(np.cross(np.broadcast_to(axis.reshape(shape), arm.shape), arm, axis=0))


def footings(loads: Iterable[object]) -> tuple[Footing, ...]:
    """Return the rigid footings and plates among loads, which are also supports."""
    return tuple(load for load in loads if isinstance(load, Footing))


def _check_place(field: str, place: Sequence[float]) -> None:
    if not (is_vector(place) and len(place) == 3):
        raise InputError(field, place, "not three finite numbers", "give (x, y, z)")
    require_place(field, place)
