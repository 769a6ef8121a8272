"""Friction laws of interfaces and joints (T2, T4)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, radians, tan

import numpy as np

from lacore.reporting import terms
from lacore.reporting.errors import InputError, is_number
from lacore.reporting.showing import Compact, rounded_down, short
from lacore.reporting.text import Quantity, Term, text

_DEGREES = (5.0, 90.0)  # bare numbers that look like angles: tan of 79 degrees is 5
_ROUND_OFF = 1e-12  # by the adhesion, within which a tension is that of the apex


@dataclass(frozen=True, repr=False)
class FrictionTerms(Compact):
    """Law ``||t_t|| <= (coefficient + dilatancy) t + limit``, ``u_n >= dilatancy ||u_t||``.

    Here ``t = t_n + tension >= 0`` (T66).
    """

    coefficient: float
    limit: float
    dilatancy: float
    tension: float = 0.0

    @property
    def slope(self) -> float:
        """Increase of the shear strength by pressure; sliding may dilate."""
        return self.coefficient + self.dilatancy

    def within(self, other: FrictionTerms) -> bool:
        """Return whether a law carries no more than another one, at any pressure."""
        if self.tension > other.tension or self.slope > other.slope:
            return False
        return self.limit <= other.limit + other.slope * (other.tension - self.tension)


@dataclass(frozen=True, repr=False)
class Coulomb(Compact):
    """Unilateral Coulomb friction ``||t_t|| <= adhesion + mu t_n``, ``t_n >= -tension`` (T2, T66).

    Adhesion is plastic: adhesion and tension are kept while the contact slips and opens. (An
    interface that breaks at first slip has neither where it slips; also compute it without them.)

    Attributes:
        mu: friction coefficient, >= 0.
        associated: with sliding dilates, ``u_n >= mu ||u_t||``, and friction dissipates nothing
            (T4).
        adhesion: shear strength at zero pressure, for a wall next to soil c_a, Pa, >= 0; for nodes
            of frames in N, like their tractions.
        tension: strength in tension, in the same unit, >= 0; at most ``adhesion/mu``, where the
            cone ends.

    Raises:
        InputError: a negative number or NaN; a tension beyond the apex of the cone.

    Example:
        >>> joint = la.Coulomb(0.6)
        >>> wall = la.Coulomb(0.3, adhesion=5e3)  # Pa
    """

    mu: float
    associated: bool = False
    adhesion: float = 0.0
    tension: float = 0.0

    def __post_init__(self) -> None:
        if not (is_number(self.mu) and self.mu >= 0):
            raise InputError(
                "friction",
                self.mu,
                "not a friction coefficient",
                text(
                    "give a {} >= 0, or {} (no friction) or {} (no slip)",
                    Term("finite mu", "number"),
                    terms.SMOOTH,
                    terms.STICK,
                ),
            )
        for name in ("adhesion", "tension"):
            value = getattr(self, name)
            if not (is_number(value) and value >= 0):
                raise InputError(
                    f"Coulomb.{name}", value, "not a strength", "give a finite stress >= 0 in Pa"
                )
        if self.mu * self.tension > self.adhesion * (1 + _ROUND_OFF):
            raise InputError(
                "Coulomb.tension",
                self.tension,
                text(
                    "beyond the apex of the cone, adhesion/mu = {}",
                    Quantity(self.adhesion / self.mu, "Pa", ".6g"),
                ),
                text(
                    "give at most {}, or a larger adhesion",
                    Quantity(rounded_down(self.adhesion / self.mu), "Pa"),
                ),
            )

    def __repr__(self) -> str:
        """Return the expression, without strengths that are zero."""
        told = f"Coulomb(mu={short(self.mu)}, associated={self.associated}"
        if self.adhesion or self.tension:
            told += f", adhesion={short(self.adhesion)}, tension={short(self.tension)}"
        return f"{told})"

    def terms(self) -> FrictionTerms:
        """Return the law as coefficients of the program."""
        limit = max(self.adhesion - self.mu * self.tension, 0.0)
        if self.associated:
            return FrictionTerms(0.0, limit, self.mu, self.tension)
        return FrictionTerms(self.mu, limit, 0.0, self.tension)

    def frictionless(self) -> Friction:
        """Return the strength at any pressure, a cylinder in its cone (T14); SMOOTH without any."""
        limit = max(self.adhesion - self.mu * self.tension, 0.0)
        return replace(self, mu=0.0, adhesion=limit) if limit or self.tension else SMOOTH

    def dilating(self) -> Coulomb:
        """Return the same cone with associated flow, which carries no less (T14)."""
        return replace(self, associated=True)

    def divided(self, factor: float) -> Coulomb:
        """Return the law with strengths divided by a factor, and tension limited to the apex."""
        mu, adhesion, tension = (part / factor for part in (self.mu, self.adhesion, self.tension))
        if mu > 0:
            tension = min(tension, adhesion / mu)
        return replace(self, mu=mu, adhesion=adhesion, tension=tension)


@dataclass(frozen=True, repr=False)
class Tresca(Compact):
    """Unilateral contact with a fixed bound on friction, ``||t_t|| <= limit``, in Pa.

    The bound applies at any opening, also after lift-off.

    Example:
        >>> film = la.Tresca(limit=10e3)  # Pa
    """

    limit: float

    def __post_init__(self) -> None:
        if not (is_number(self.limit) or self.limit == inf) or self.limit < 0:
            raise InputError(
                "Tresca.limit", self.limit, "not a friction stress", "give a stress >= 0 in Pa"
            )

    def __repr__(self) -> str:
        """Return the expression: its name if it has one."""
        return {0.0: "SMOOTH", inf: "STICK"}.get(self.limit) or super().__repr__()

    def terms(self) -> FrictionTerms:
        """Return the law as coefficients of the program."""
        return FrictionTerms(0.0, self.limit, 0.0)

    def frictionless(self) -> Tresca:
        """Return the same law, because it does not depend on pressure."""
        return self

    def dilating(self) -> Tresca:
        """Return the same law, because its flow is associated."""
        return self

    def divided(self, factor: float) -> Tresca:
        """Return the law with its limit divided by a factor."""
        return Tresca(self.limit / factor)


SMOOTH = Tresca(0.0)


STICK = Tresca(inf)
"""No slip, at any opening; but it opens freely: `BOND` also carries tension."""


@dataclass(frozen=True, repr=False)
class Bonded(Compact):
    """Neither slip nor opening, up to the strength of the weaker side, as in one body."""

    def __repr__(self) -> str:
        """Return the expression."""
        return "BOND"

    def terms(self) -> FrictionTerms:
        """Return the terms of sticking, as opening is not part of friction."""
        return FrictionTerms(0.0, inf, 0.0)

    def frictionless(self) -> Bonded:
        """Return the same law, because it does not depend on pressure."""
        return self

    def dilating(self) -> Bonded:
        """Return the same law, because its flow is associated."""
        return self

    def divided(self, factor: float) -> Bonded:
        """Return the same law, because its strength is that of the bodies."""
        return self


BOND = Bonded()
"""Interface that transfers all that the weaker side can carry."""


Friction = Coulomb | Tresca | Bonded
"""Law of friction; arguments also accept a number, the coefficient of `lacore.Coulomb`."""


def in_degrees(friction: float) -> bool:
    """Return whether a bare coefficient looks like an angle in degrees."""
    return _DEGREES[0] <= friction < _DEGREES[1]


def friction_law(friction: float | Friction, field: str) -> Friction:
    """Return a friction law; a bare coefficient means Coulomb friction.

    Raises:
        InputError: neither, a coefficient below 0 or NaN, or a bare one that looks like an angle in
            degrees; it names `field`.
    """
    if isinstance(friction, Friction):
        return friction
    if not isinstance(friction, int | float | np.number):
        raise InputError(
            field,
            friction,
            "not a friction law",
            "give a coefficient, lacore.Coulomb, Tresca, SMOOTH, STICK or BOND",
        )
    if in_degrees(friction):
        raise InputError(
            field,
            friction,
            f"an angle in degrees? The coefficient of {friction:g} degrees is"
            f" {tan(radians(friction)):.4g}",
            text(
                "give the tangent of the angle, {} if that is meant",
                Term(
                    f"or lacore.Coulomb({friction:g})",
                    f'{{ angle = "{friction:g} deg" }}, or {{ mu = {friction:g} }}',
                ),
            ),
        )
    try:
        return Coulomb(friction)
    except InputError as wrong:
        raise InputError(field, friction, wrong.reason, wrong.fix) from None
