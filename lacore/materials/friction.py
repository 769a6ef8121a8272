"""Friction laws of interfaces and joints (T2, T4)."""

from dataclasses import dataclass
from math import inf, radians, tan

import numpy as np

from lacore.errors import InputError, is_number
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

    def __repr__(self) -> str:
        """As it is written: by its name, where it has one."""
        return {0.0: "SMOOTH", inf: "STICK"}.get(self.limit) or super().__repr__()

    def terms(self) -> FrictionTerms:
        """The law as coefficients of the program."""
        return FrictionTerms(0.0, self.limit, 0.0)


SMOOTH = Tresca(0.0)


STICK = Tresca(inf)
"""No slip, wherever the bodies are; but it opens freely: what carries tension, too, is `BOND`."""


@dataclass(frozen=True, repr=False)
class Bonded(Compact):
    """Neither slip nor opening, up to the strength of the weaker side: as if both were one."""

    def __repr__(self) -> str:
        """As it is written."""
        return "BOND"

    def terms(self) -> FrictionTerms:
        """That of sticking: what opens is no matter of friction."""
        return FrictionTerms(0.0, inf, 0.0)


BOND = Bonded()
"""What an interface is that transfers all that the weaker side can carry."""


Friction = Coulomb | Tresca | Bonded


def friction_law(friction: float | Friction, field: str) -> Friction:
    """A friction law, a bare coefficient read as Coulomb friction.

    Raises:
        InputError: neither, a coefficient below 0 or NaN, or a bare one that looks like an angle in
            degrees; it names `field`.
    """
    if isinstance(friction, Coulomb | Tresca | Bonded):
        return friction
    if not isinstance(friction, int | float | np.number):
        raise InputError(
            field,
            friction,
            "not a friction law",
            "give a coefficient, lacore.Coulomb, Tresca, SMOOTH, STICK or BOND",
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
