"""Curves of solutions of ``R(z, s) = 0``, followed by their length, around folds too (Keller 1977).

What is solved at each s is the same system, smoothed by ``exp(s)``; a curve is followed to ever
smaller s. Which way is onward is told by the sign of the determinant of ``dR/dz``, which changes
at each fold (Chow, Mallet-Paret & Yorke 1978), so that a curve is never followed back.
"""

from collections.abc import Iterator
from math import exp
from typing import Protocol

import numpy as np

from lacore.arrays import Floats
from lacore.numerics.linear_algebra import SingularError

_NEAR = 1e-2  # residual of places on the curve, of the smoothing
_WEIGHT = 0.1  # of s in the length of the curve
_FIRST, _LONGEST, _SHORTEST = 0.05, 2.0, 1e-8  # steps; the longest by s
_STEEP = 0.01  # least share of s in the longest step
_TURN = 0.3  # cosine between tangents of neighbouring places
_LEAP = 3.0  # of s, in one iteration
_STEP, _DAMPED = 7, 40  # Newton iterations of a step, and of the first place
_QUICK, _SLOW = 2, 5  # of a step, so that the next one is longer or shorter
_LONGER, _SHORTER, _AGAIN = 1.8, 0.7, 0.35
_FALL = 0.1  # of the residual, per step of damped iterations
_LEAST = 1e-3  # damping


class Linear(Protocol):
    """``dR/dz``, factorised."""

    @property
    def sign(self) -> float:
        """Of its determinant, but for a factor that is the same at all places."""

    def solve(self, right: Floats) -> Floats:
        """``(dR/dz)^-1 right``."""


class Local(Protocol):
    """The system at a place."""

    @property
    def residual(self) -> Floats:
        """R."""

    @property
    def change(self) -> Floats:
        """dR/ds."""

    def linear(self) -> Linear:
        """The derivative by z; raises `SingularError`."""


class System(Protocol):
    """What a curve solves."""

    def at(self, place: Floats, s: float) -> Local:
        """The system at a place."""


def begun(system: System, place: Floats, s: float) -> Floats | None:
    """A solution at s by damped Newton iterations from a place; None where they get to none."""
    local = system.at(place, s)
    size = np.linalg.norm(local.residual)
    for _ in range(_DAMPED):
        if size <= _NEAR * exp(s):
            return place
        try:
            step = local.linear().solve(-local.residual)
        except SingularError:
            return None
        damping = 1.0
        while True:
            local = system.at(place + damping * step, s)
            new = np.linalg.norm(local.residual)
            if new <= (1 - _FALL * damping) * size or damping < _LEAST:
                break
            damping /= 2
        place, size = place + damping * step, new
    return None


def followed(system: System, place: Floats, s: float) -> Iterator[tuple[Floats, float]]:
    """Places on the curve through a solution at s, and their s; until steps get too short."""
    linear = system.at(place, s).linear()
    first = linear.sign
    tangent = -_tangent(system, place, s, linear)
    length = _FIRST
    while length >= _SHORTEST:
        found = _corrected(system, place, s, tangent, length)
        if found is not None:
            new, at, iterations, linear = found
            onward = -first * linear.sign * _tangent(system, new, at, linear)
            if _product(onward, tangent) < _TURN:
                found = None
        if found is None:
            length *= _AGAIN
            continue
        place, s, tangent = new, at, onward
        yield place, s
        if iterations <= _QUICK:
            length = min(_LONGER * length, _LONGEST / max(abs(tangent[-1]), _STEEP))
        elif iterations >= _SLOW:
            length *= _SHORTER


def _corrected(
    system: System, place: Floats, s: float, tangent: Floats, length: float
) -> tuple[Floats, float, int, Linear] | None:
    """The place on the curve that is a length away, by Newton iterations across the tangent."""
    new, at, last = place + length * tangent[:-1], s + length * tangent[-1], np.inf
    for iteration in range(_STEP + 1):
        local = system.at(new, at)
        size = float(np.linalg.norm(local.residual))
        if not size <= 2 * last:
            return None
        try:
            linear = local.linear()
            if size <= _NEAR * exp(at):
                return new, at, iteration, linear
            step, slope = linear.solve(-local.residual), linear.solve(-local.change)
        except SingularError:
            return None
        ahead = tangent[:-1] @ (new - place) + _WEIGHT**2 * tangent[-1] * (at - s) - length
        leap = -(tangent[:-1] @ step + ahead) / (tangent[:-1] @ slope + _WEIGHT**2 * tangent[-1])
        if not abs(leap) <= _LEAP:
            return None
        new, at, last = new + step + leap * slope, at + leap, size
    return None


def _tangent(system: System, place: Floats, s: float, linear: Linear) -> Floats:
    """Along the curve, of length 1, s growing; its share of s last."""
    slope = np.append(linear.solve(-system.at(place, s).change), 1.0)
    return np.asarray(slope / np.sqrt(_product(slope, slope)))


def _product(one: Floats, other: Floats) -> float:
    return float(one[:-1] @ other[:-1] + _WEIGHT**2 * one[-1] * other[-1])
