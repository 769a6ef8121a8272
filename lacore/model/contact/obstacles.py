"""Rigid obstacles: their shapes, and the parts of bodies that may touch them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from lacore.model.bodies.touching import TOUCH
from lacore.model.materials.friction import FrictionTerms
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError, is_vector, require_place, require_range
from lacore.reporting.showing import Compact
from lacore.reporting.text import Term, text

# by the size of the body: closer to an obstacle, solvers cannot distinguish it from contact
_NEAR = 1e-6


@runtime_checkable
class Shape(Protocol):
    """Shape of an obstacle. User-defined shapes need these members.

    Contact is enforced at control values (`lacore.paths.contact.approach`): everywhere along an
    edge for a plane, and for a curved face as far as its distance is linear within a step.
    """

    def distance(self, places: Floats) -> Floats:
        """Return the distance of places (2, n) from its face, m, (n,); negative behind it."""
        ...

    def normal(self, places: Floats) -> Floats:
        """Return unit normals towards the bodies, at the closest points of its face, (2, n)."""
        ...

    def outline(self, low: Floats, high: Floats) -> Floats:
        """Return its face across the box between two corners, as polyline (2, k), k >= 2."""
        ...


@dataclass(frozen=True, repr=False)
class Plane(Compact):
    """Plane, or a line in two dimensions.

    Attributes:
        point: point on it, m.
        direction: its unit normal, towards the bodies.
    """

    point: tuple[float, ...]
    direction: tuple[float, ...]

    @property
    def reference(self) -> tuple[float, ...]:
        """Its point."""
        return self.point

    @classmethod
    def through(cls, point: Floats, normal: Floats) -> Plane:
        """Return the plane through a point with a normal of any length, shape (d,) each."""
        unit = normal / np.linalg.norm(normal)
        return cls(tuple(map(float, point)), tuple(map(float, unit)))

    def distance(self, places: Floats) -> Floats:
        """Return the distance, see `Shape`."""
        return np.asarray(np.array(self.direction) @ (places - np.reshape(self.point, (-1, 1))))

    def normal(self, places: Floats) -> Floats:
        """Return the normals, see `Shape`."""
        return np.repeat(np.reshape(self.direction, (-1, 1)), places.shape[1], axis=1)

    def outline(self, low: Floats, high: Floats) -> Floats:
        """Return the face, see `Shape`; as long as the box is wide, to either side."""
        normal, middle = np.array(self.direction), (low + high) / 2
        foot = middle - normal * (normal @ (middle - self.point))
        along = float(np.linalg.norm(high - low)) * np.array([-normal[1], normal[0]])
        return np.stack([foot - along, foot + along], axis=1)


@dataclass(frozen=True, repr=False)
class RigidObstacle(Compact):
    """Rigid obstacle at rest.

    Attributes:
        point, normal: a plane through `point` whose `normal` points out of the obstacle, towards
            the body; with two or three numbers each. Without them the obstacle has the shape of the
            boundary that touches it.
        shape: shape of any other face, instead of a plane.

    Raises:
        InputError: a point without a normal, invalid vectors, or a plane and another shape.

    Example:
        >>> floor = la.RigidObstacle(point=(0, 0), normal=(0, 1))
    """

    point: tuple[float, ...] | None = None
    normal: tuple[float, ...] | None = None
    shape: Shape | None = None

    def __post_init__(self) -> None:
        if self.shape is not None and not isinstance(self.shape, Shape):
            raise InputError(
                "RigidObstacle.shape",
                self.shape,
                "not a shape",
                "give an object with distance, normal and outline"
                " (lacore.model.contact.obstacles.Shape)",
            )
        if self.shape is not None and (self.point is not None or self.normal is not None):
            raise InputError(
                "RigidObstacle", None, "a plane and another shape", "give one of the two"
            )
        if (self.point is None) != (self.normal is None):
            raise InputError(
                "RigidObstacle", None, "a plane needs both point and normal", "give both or none"
            )
        if self.point is not None and self.normal is not None:
            both = is_vector(self.point) and is_vector(self.normal)
            if not (both and len(self.point) == len(self.normal)):
                raise InputError(
                    "RigidObstacle",
                    (self.point, self.normal),
                    "not two vectors of one space",
                    text(
                        "give {}, in three dimensions three numbers each",
                        Term("point=(x, y), normal=(nx, ny)", "point = [x, y], normal = [nx, ny]"),
                    ),
                )
            if not np.any(self.normal):
                raise InputError(
                    "RigidObstacle.normal", self.normal, "has no direction", "give a vector != 0"
                )
            require_place("RigidObstacle.point", self.point)
            require_range("RigidObstacle.normal", self.normal)

    @property
    def face(self) -> Shape | None:
        """Shape; None if it follows the boundary that touches it."""
        if self.point is None or self.normal is None:
            return self.shape
        return Plane.through(np.array(self.point), np.array(self.normal))


@dataclass(frozen=True, repr=False)
class Obstacle(Compact):
    """Rigid face, at rest or moved by a tool, and the part of a body that may touch it.

    Attributes:
        name: name of the interface.
        body: name of the body.
        where: name of the part of its boundary.
        facets: facets of its mesh.
        shape: shape of the face.
        law: friction law.
        size: size of the body, m.
        carrier: name of the tool that moves it; None for a face at rest.
    """

    name: str
    body: str
    where: str
    facets: Ints
    shape: Shape
    law: FrictionTerms
    size: float
    carrier: str | None = None

    @property
    def touch(self) -> float:
        """Distance up to which a point that is placed there counts as touching, m."""
        return TOUCH * self.size

    @property
    def near(self) -> float:
        """Distance up to which a point that has moved there counts as touching, m."""
        return _NEAR * self.size
