"""Contact interfaces and their friction laws (T2, T4).

Sign conventions. `n` is the unit normal from the master (obstacle) into the slave body; the
relative velocity is that of the slave against the master, ``u_n > 0`` opens. Tractions act on the
slave, ``t_n >= 0`` is compression.
"""

from dataclasses import dataclass
from math import inf, radians, tan

import numpy as np

from lacore.boundaries import Where, where_name
from lacore.errors import InputError, is_number, is_plane_vector, require_place, require_range
from lacore.showing import Compact

_DEGREES = (5.0, 90.0)  # bare numbers that look like angles: tan of 79 degrees is 5


@dataclass(frozen=True, repr=False)
class FrictionTerms(Compact):
    """A law as ``||t_t|| <= coefficient t_n + limit`` with ``u_n >= dilatancy ||u_t||``."""

    coefficient: float
    limit: float
    dilatancy: float


@dataclass(frozen=True, repr=False)
class Coulomb(Compact):
    """Unilateral Coulomb friction ``||t_t|| <= mu t_n`` (T2).

    Attributes:
        mu: friction coefficient, >= 0.
        associated: sliding dilates, ``u_n >= mu ||u_t||``, and dissipates nothing (T4).
    """

    mu: float
    associated: bool = False

    def __post_init__(self) -> None:
        if not (is_number(self.mu) and self.mu >= 0):
            raise InputError(
                "friction",
                self.mu,
                "not a friction coefficient",
                "give a finite mu >= 0 (0 or lacore.SMOOTH: none; lacore.STICK: no slip at all)",
            )

    def terms(self) -> FrictionTerms:
        """The law as coefficients of the program."""
        if self.associated:
            return FrictionTerms(0.0, 0.0, self.mu)
        return FrictionTerms(self.mu, 0.0, 0.0)


@dataclass(frozen=True, repr=False)
class Tresca(Compact):
    """Unilateral contact with a fixed bound on friction, ``||t_t|| <= limit``, in Pa.

    The bound holds wherever the body is, also where it lifts off.
    """

    limit: float

    def __post_init__(self) -> None:
        if not (is_number(self.limit) or self.limit == inf) or self.limit < 0:
            raise InputError(
                "Tresca.limit", self.limit, "not a friction stress", "give a stress >= 0 in Pa"
            )

    def terms(self) -> FrictionTerms:
        """The law as coefficients of the program."""
        return FrictionTerms(0.0, self.limit, 0.0)


SMOOTH = Tresca(0.0)
STICK = Tresca(inf)
Friction = Coulomb | Tresca


def friction_law(friction: float | Friction, field: str) -> Friction:
    """A friction law, a bare coefficient read as Coulomb friction.

    Raises:
        InputError: neither, a coefficient below 0 or NaN, or a bare one that looks like an angle in
            degrees; it names `field`.
    """
    if isinstance(friction, Coulomb | Tresca):
        return friction
    if not isinstance(friction, int | float | np.number):
        raise InputError(
            field,
            friction,
            "not a friction law",
            "give a coefficient, lacore.Coulomb, Tresca, SMOOTH or STICK",
        )
    if _DEGREES[0] <= friction < _DEGREES[1]:
        raise InputError(
            field,
            friction,
            f"an angle in degrees? The coefficient of {friction:g} degrees is"
            f" {tan(radians(friction)):.4g}",
            f"give the tangent of the angle, or lacore.Coulomb({friction:g}) if it is meant",
        )
    try:
        return Coulomb(friction)
    except InputError as wrong:
        raise InputError(field, friction, wrong.why, wrong.mend) from None


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
class Interface(Compact):
    """Contact between a boundary and a rigid obstacle, or between the boundaries of two bodies.

    Which of two bodies is called slave changes no result, only the signs of `LimitState.reactions`.

    Attributes:
        slave: ``(body name, where)``, see `lacore.boundaries.boundary_facets`.
        master: a `RigidObstacle`, or ``(body name, where)`` of another body. The two boundaries
            touch along straight parts; their meshes need not match.
        friction: coefficient of Coulomb friction, or `Coulomb`, `Tresca`, `SMOOTH`, `STICK`.
            STICK forbids slip wherever the body is, also where it lifts off, and opening is
            free: the limit mu -> infinity of associated friction, not of Coulomb friction. No
            body carries more shear than its strength: see `lacore.sticking` for corners.

    Raises:
        InputError: a negative or NaN friction, a master of another kind.
    """

    slave: tuple[str, Where]
    master: RigidObstacle | tuple[str, Where]
    friction: float | Friction

    def __post_init__(self) -> None:
        if not _is_boundary(self.slave):
            raise InputError(
                "Interface.slave", self.slave, "not a boundary", "give (body name, where)"
            )
        if not (isinstance(self.master, RigidObstacle) or _is_boundary(self.master)):
            raise InputError(
                "Interface.master",
                self.master,
                "not an obstacle or a boundary",
                "give lacore.RigidObstacle() or (body name, where)",
            )
        if not isinstance(self.master, RigidObstacle) and self.master[0] == self.slave[0]:
            raise InputError(
                "Interface.master",
                self.master[0],
                "a body in contact with itself",
                "make its parts bodies of their own (blocks of one assembly find their joints)",
            )
        object.__setattr__(self, "friction", self.law)

    @property
    def law(self) -> Friction:
        """The friction law, a bare coefficient read as Coulomb friction."""
        return friction_law(self.friction, "Interface.friction")

    @property
    def name(self) -> str:
        """Name in tables: ``block.bottom``, ``punch.base|soil.top``."""
        sides = [self.slave]
        if not isinstance(self.master, RigidObstacle):
            sides.append(self.master)
        return "|".join(f"{body}.{where_name(where)}" for body, where in sides)


def _is_boundary(side: object) -> bool:
    return isinstance(side, tuple) and len(side) == 2 and isinstance(side[0], str)
