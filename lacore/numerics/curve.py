"""Curves of solutions of ``F(z) = theta F(z0)`` from theta = 1 on, followed around their folds.

Some of z must remain positive, or within cones. A curve is therefore followed by its length in
relative changes of those parts and in log(theta), and not by theta, which may grow for a while:
Newton's steps from a tangent, in the plane across it (Keller 1977; Allgower & Georg 1990, ch. 10).
The direction follows from the sign of the determinant of ``dF/dz``, which changes at each fold
(Chow, Mallet-Paret & Yorke 1978), so that a curve is never followed back. Cosines to the last
direction would fail where both ends of a hairpin are close to each other.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.numerics.linear_algebra import SingularError

_FIRST = 0.3  # length of the first step
_NEAR, _CLOSE = 0.6, 0.1  # distance from the curve after one correction, and after more
_BOUNDARY = 0.9  # share of the way to the boundary
_FALL, _RISE = 0.8, 2.5  # limits of relative changes of positive parts in a predicted step
_LEAP = 1.0  # limit of log(theta) in a correction
# factor of the next step by the number of corrections in the last one
_LONGER = (2.0, 1.0, 2 / 3, 2 / 3)
_TRIALS, _SHORTER, _RECENTRED = 6, 1 / 3, 3


class Linear(Protocol):
    """``dF/dz``, factorised."""

    @property
    def sign(self) -> float:
        """Sign of its determinant, up to a factor that is the same at all places."""

    def solve(self, right: Floats) -> Floats:
        """Return ``(dF/dz)^-1 right``."""


@dataclass(frozen=True)
class Change:
    """Change of z relative to the parts that must remain positive.

    Attributes:
        vector: vector whose length is that of the change.
        least, most: relative changes of eigenvalues of positive parts: -1 reaches the boundary.
    """

    vector: Floats
    least: float
    most: float


class System(Protocol):
    """Equations of a curve."""

    def residual(self, z: Floats) -> Floats:
        """Return F."""

    def linear(self, z: Floats) -> Linear:
        """Return its derivative; raises `SingularError`."""

    def changes(self, z: Floats, dz: Floats) -> Change:
        """Return a change, relative to z."""

    def off(self, z: Floats, aim: Floats) -> float:
        """Return the distance of z from F = `aim`, 0 on the curve.

        Inf outside of positive parts.
        """


@dataclass(frozen=True)
class Place:
    """Place near the curve, log(theta) there, and the number of factorisations used."""

    z: Floats
    level: float
    count: int


@dataclass(frozen=True)
class _Aim:
    """Place that is corrected across a direction, or at constant theta without one."""

    z: Floats
    level: float
    along: tuple[Floats, float] | None = None


@dataclass(frozen=True)
class _Curve:
    """System, the residual of its equations at the start, and the sign of the determinant."""

    system: System
    left: Floats
    sign: float

    def linear(self, z: Floats) -> "_Tangent":
        linear = self.system.linear(z)
        return _Tangent(linear, linear.solve(self.left))

    def off(self, aim: _Aim) -> float:
        return self.system.off(aim.z, np.exp(aim.level) * self.left)


@dataclass(frozen=True)
class _Tangent:
    """Derivative at a place, and dz/dtheta of a curve there."""

    linear: Linear
    slope: Floats


def followed(system: System, start: Floats) -> Iterator[Place]:
    """Yield places along the curve, including the start, until no next one is found.

    Args:
        system: the equations.
        start: place inside all parts that must remain positive.
    """
    place, length, lost = Place(start, 0.0, 1), _FIRST, False
    try:
        first, left = system.linear(start), system.residual(start)
        curve, tangent = _Curve(system, left, first.sign), _Tangent(first, first.solve(left))
        yield place
        while True:
            found, length, count, tangent = _step(curve, place, length, tangent)
            if found is not None:
                place, lost = replace(found, count=place.count + count), False
                yield place
            elif lost:
                return
            else:  # The tangent was that of a point away from the curve.
                aim, lost = _Aim(place.z, place.level), True
                for _ in range(_RECENTRED):
                    aim = _corrected(curve, aim, curve.linear(aim.z))
                place = Place(aim.z, aim.level, place.count + count + _RECENTRED + 1)
                tangent = curve.linear(place.z)
    except SingularError:
        return


def _step(
    curve: _Curve, place: Place, length: float, tangent: _Tangent
) -> tuple[Place | None, float, int, _Tangent]:
    """Return the next place or None, next length, number of factorisations, and last tangent."""
    move = np.exp(place.level) * tangent.slope
    change, onward = curve.system.changes(place.z, move), -tangent.linear.sign * curve.sign
    share = onward / float(np.hypot(np.linalg.norm(change.vector), 1.0))
    along = share * change.vector, share
    rates = share * change.least, share * change.most
    longest = 1 / max(-min(rates) / _FALL, max(rates) / _RISE, float(np.finfo(float).tiny))
    count = 0
    for _ in range(_TRIALS):
        length = min(length, longest)
        aim = _Aim(place.z + length * share * move, place.level + length * share, along)
        for corrections, longer in enumerate(_LONGER):
            count += 1
            try:
                tangent = curve.linear(aim.z)
            except SingularError:
                break
            aim = _corrected(curve, aim, tangent)
            if curve.off(aim) < (_CLOSE if corrections else _NEAR):
                return Place(aim.z, aim.level, count), longer * length, count, tangent
        length *= _SHORTER
    return None, length, count, tangent


def _corrected(curve: _Curve, aim: _Aim, tangent: _Tangent) -> _Aim:
    """Return a Newton step across the direction of the curve; at constant theta without one."""
    system, theta, rise = curve.system, np.exp(aim.level), 0.0
    move = theta * tangent.slope
    step = tangent.linear.solve(theta * curve.left - system.residual(aim.z))
    if aim.along is not None:
        ahead, up = aim.along
        of_step, of_move = (system.changes(aim.z, one).vector for one in (step, move))
        rise = -float(of_step @ ahead) / float(of_move @ ahead + up)
    step = step + rise * move
    fall = -system.changes(aim.z, step).least
    share = min(1.0, _BOUNDARY / fall) if fall > 0 else 1.0
    level = aim.level + float(np.clip(share * rise, -_LEAP, _LEAP))
    return replace(aim, z=aim.z + share * step, level=level)
