"""Rigid obstacles: where the side of an interface that is no body stands, and how it moves."""

from dataclasses import dataclass

import numpy as np

from lacore.arrays import Floats, Ints
from lacore.bodies.touching import TOUCH
from lacore.errors import InputError, is_plane_vector, require_place, require_range
from lacore.materials.friction import FrictionTerms
from lacore.showing import Compact

_NEAR = 1e-6  # of the body size: closer to an obstacle, solvers cannot tell from touching


@dataclass(frozen=True, repr=False)
class RigidObstacle(Compact):
    """A rigid obstacle at rest.

    Attributes:
        point, normal: a plane through `point` whose `normal` points out of the obstacle, towards
            the body. Without them the obstacle has the shape of the boundary that touches it.
    """

    point: tuple[float, float] | None = None
    normal: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if (self.point is None) != (self.normal is None):
            raise InputError(
                "RigidObstacle", None, "a plane needs both point and normal", "give both or none"
            )
        if self.point is not None and self.normal is not None:
            if not (is_plane_vector(self.point) and is_plane_vector(self.normal)):
                raise InputError(
                    "RigidObstacle",
                    (self.point, self.normal),
                    "not two plane vectors",
                    "give point=(x, y), normal=(nx, ny)",
                )
            if not np.any(self.normal):
                raise InputError(
                    "RigidObstacle.normal", self.normal, "has no direction", "give a vector != 0"
                )
            require_place("RigidObstacle.point", self.point)
            require_range("RigidObstacle.normal", self.normal)


@dataclass(frozen=True, repr=False)
class Obstacle(Compact):
    """A plane that does not move, and the part of a body that may come to it.

    Attributes:
        name: of the interface.
        body: name.
        where: name of the part of its boundary.
        facets: of its mesh.
        point, normal: of the plane, shape (2,); the unit normal points towards the body.
        law: friction.
        size: of the body, m.
    """

    name: str
    body: str
    where: str
    facets: Ints
    point: Floats
    normal: Floats
    law: FrictionTerms
    size: float

    @property
    def touch(self) -> float:
        """Distance up to which a point that is placed there counts as touching, m."""
        return TOUCH * self.size

    @property
    def near(self) -> float:
        """Distance up to which a point that came there counts as touching, m."""
        return _NEAR * self.size

    def distance(self, places: Floats) -> Floats:
        """Of places of shape (2, n) from the plane, m; negative behind it."""
        return np.asarray(self.normal @ (places - self.point[:, None]))
