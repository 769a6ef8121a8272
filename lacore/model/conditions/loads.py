"""Supports and loads. Forces are per unit thickness; every load is integrated exactly.

In three dimensions vectors and places have three numbers, and forces are in N instead of N/m. For
axisymmetric bodies x is the radius and y the axis: a vector (r, z) acts all around, and forces are
those of the whole circumference, in N.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import singledispatch
from typing import ClassVar, Self

import numpy as np

from lacore.model.conditions.body_forces import BodyForce, acting
from lacore.model.conditions.footings import RigidFooting, Twist, check_size, check_vector
from lacore.model.conditions.water import PorePressure, StandingWater
from lacore.model.conditions.where import Where, where_name
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import (
    InputError,
    is_vector,
    require_known,
    require_place,
)
from lacore.reporting.showing import Compact, short
from lacore.reporting.text import Quantity, text

_ALL = {2: "xy", 3: "xyz"}
COMPONENTS = {
    2: ("x", "y", "xy", "normal", "tangential", "rotation", "clamped"),
    3: ("x", "y", "z", "xz", "yz", "xyz", "normal"),
}
"""Components that a support may hold, by the dimension of its body."""
_NAMED = tuple(dict.fromkeys((*COMPONENTS[2], *COMPONENTS[3], "all")))


@dataclass(frozen=True, repr=False)
class Fix(Compact):
    """Velocity components held at zero on a part of the boundary.

    Attributes:
        body: name of the body.
        where: the part, see `lacore.types.Where`, which ends at vertices; for a frame its nodes.
        components: ``all`` directions, which a problem reads as ``xy``, or ``xyz`` in three
            dimensions; or
            ``x``, ``y``, ``xy``, or ``normal`` / ``tangential`` to the boundary; for nodes of a
            frame also ``rotation``, and ``clamped`` for all three, but not ``normal`` or
            ``tangential``. In three dimensions ``x``, ``y``, ``z``, two of them such as ``xy``,
            ``xyz``, or ``normal``.

    Example:
        >>> clamped, roller = la.Fix("soil", "bottom"), la.Fix("soil", "left", "x")
    """

    body: str
    where: Where
    components: str = "all"

    def __post_init__(self) -> None:
        require_known("Fix.components", self.components, _NAMED)

    def of(self, dimension: int) -> Fix:
        """Return the support with ``all`` directions named."""
        return replace(self, components=_ALL[dimension]) if self.components == "all" else self

    @property
    def boundary(self) -> Where:
        """The part of the boundary that it holds."""
        return self.where

    @property
    def told(self) -> str:
        """Short text."""
        return text("{} of {}.{}", self.components, self.body, where_name(self.where))


def require_no_rotation(support: Fix, field: str) -> None:
    """Raise `InputError` where a support holds a rotation, which only nodes of a frame have."""
    if support.components in ("rotation", "clamped"):
        raise InputError(
            f"{field}.components",
            support.components,
            "only nodes of a frame have a rotation to hold",
            "hold x and y along an edge",
        )


@dataclass(frozen=True, repr=False)
class SurfaceLoad(Compact, ABC):
    """The base class of loads that are a stress on a part of the boundary.

    Deformable bodies and rigid blocks support every subclass.
    """

    body: str
    where: Where
    point: ClassVar[None] = None

    @property
    def boundary(self) -> Where:
        """The part of the boundary, or the member of a frame, that it acts on."""
        return self.where

    @property
    @abstractmethod
    def told(self) -> str:
        """Short text."""

    @property
    @abstractmethod
    def size(self) -> float:
        """Size >= 0, in Pa."""

    @abstractmethod
    def times(self, factor: float) -> Self:
        """Return the same load with another size."""

    @abstractmethod
    def on(self, normal: Floats) -> Floats:
        """Return the traction at outward normals of shape (d, ...), Pa, of that shape."""


@dataclass(frozen=True, repr=False)
class Traction(SurfaceLoad):
    """Uniform traction `vector` [Pa] on a part of the boundary.

    On a frame `where` names a member, and the vector is a force per length of it.

    Example:
        >>> pushed = la.Traction("soil", "top", (0.0, -1e3))  # Pa
    """

    vector: tuple[float, ...]

    def __post_init__(self) -> None:
        check_vector("Traction.vector", self.vector, "Pa")

    @property
    def told(self) -> str:
        """Short text."""
        own = Quantity(tuple(self.vector), "Pa", ".7g")
        return text("{} on {}.{}", own, self.body, where_name(self.where))

    @property
    def size(self) -> float:
        """See `SurfaceLoad.size`."""
        return float(np.linalg.norm(self.vector))

    def times(self, factor: float) -> Self:
        """Return the load with another size, see `SurfaceLoad.times`."""
        return replace(self, vector=tuple(factor * own for own in self.vector))

    def on(self, normal: Floats) -> Floats:
        """Return the traction, see `SurfaceLoad.on`."""
        vector = np.reshape(self.vector, (-1, *(1,) * (normal.ndim - 1)))
        return np.broadcast_to(vector, normal.shape)


@dataclass(frozen=True, repr=False)
class Pressure(SurfaceLoad):
    """Uniform pressure `value` [Pa] against the outward normal of a part of the boundary.

    Example:
        >>> inside = la.Pressure("tube", "left", value=1e6)  # Pa
    """

    value: float = 1.0

    def __post_init__(self) -> None:
        check_size("Pressure.value", self.value, "Pa")

    @property
    def told(self) -> str:
        """Short text."""
        own = Quantity(self.value, "Pa", ".7g")
        return text("pressure {} on {}.{}", own, self.body, where_name(self.where))

    @property
    def size(self) -> float:
        """See `SurfaceLoad.size`."""
        return abs(self.value)

    def times(self, factor: float) -> Self:
        """Return the load with another size, see `SurfaceLoad.times`."""
        return replace(self, value=factor * self.value)

    def on(self, normal: Floats) -> Floats:
        """Return the traction, see `SurfaceLoad.on`."""
        return np.asarray(-self.value * normal)


@dataclass(frozen=True, repr=False)
class PointForce(Compact):
    """A single force.

    Attributes:
        body: name of the body. A continuum yields under it, so the result depends on the mesh.
        at: a mesh vertex of a continuum, a point of a block, or the name of a block (at its
            centroid) or of a node of a frame, or a place on a member of one, where a node is added.
        vector: N/m, in three dimensions N; on an axisymmetric body the sum around the ring through
            `at`, N.
        where: the block that carries it, if `at` lies on several, or on none: a rigid arm.

    Example:
        >>> wind = la.PointForce("frame", "B", (10e3, 0.0))  # N
    """

    body: str
    at: tuple[float, ...] | str
    vector: tuple[float, ...]
    where: str | None = None
    boundary: ClassVar[None] = None

    def __post_init__(self) -> None:
        check_vector("PointForce.vector", self.vector, "N/m")
        if not (isinstance(self.at, str) or is_vector(self.at)):
            fix = "give (x, y), in three dimensions (x, y, z), or a name"
            raise InputError("PointForce.at", self.at, "not a point", fix)
        if not isinstance(self.at, str):
            require_place("PointForce.at", self.at)

    @property
    def point(self) -> tuple[float, ...] | None:
        """Place where it acts, m; None if `at` is a name."""
        return None if isinstance(self.at, str) else self.at

    @property
    def told(self) -> str:
        """Short text."""
        own = Quantity(tuple(self.vector), "N/m" if len(self.vector) == 2 else "N", ".7g")
        at = short(self.at) if self.point is None else Quantity(tuple(self.point), "m", ".7g")
        return text("{} at {} of {}", own, at, self.body)

    @property
    def size(self) -> float:
        """Size >= 0, in N/m, in three dimensions and on axisymmetric bodies in N."""
        return float(np.linalg.norm(self.vector))

    def times(self, factor: float) -> Self:
        """Return the same force with another size."""
        return replace(self, vector=tuple(factor * own for own in self.vector))


Load = SurfaceLoad | BodyForce | PointForce | RigidFooting | Twist | PorePressure | StandingWater
"""Reference load that drives a problem, or dead load.

Each has a `boundary`, None if it acts on none, and a `point`, None if it acts on none.
"""


@singledispatch
def acts(load: Load) -> bool:
    """Return whether a load is not zero; a zero dead load has no effect."""
    return True


@acts.register(SurfaceLoad)
@acts.register(PointForce)
def _of_size(load: SurfaceLoad | PointForce) -> bool:
    return load.size > 0


@acts.register(BodyForce)
def _anywhere(load: BodyForce) -> bool:
    return any(map(acting, load.vector))
