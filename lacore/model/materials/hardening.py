"""Hardening laws: the yield stress over the equivalent plastic strain, and its slope (T29)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError, is_number, require_positive
from lacore.reporting.showing import Compact

if TYPE_CHECKING:
    from scipy.interpolate import PchipInterpolator, PPoly

__all__ = ["HardeningLaw", "Linear", "Perfect", "Swift", "Table", "Voce"]

_SAMPLES = np.concatenate([[0.0], np.geomspace(1e-6, 10.0, 71)])
_KINKS = 0.25  # share of the samples that may lie at corners of a law


@runtime_checkable
class HardeningLaw(Protocol):
    """Isotropic law. A user-defined law needs these two methods, for arrays of any shape.

    `VonMises` samples it from 0 to 10 and rejects a law that softens.
    """

    def stress(self, strain: Floats) -> Floats:
        """Yield stress in tension, Pa, > 0, at equivalent plastic strains >= 0."""
        ...

    def modulus(self, strain: Floats) -> Floats:
        """Return the derivative of `stress`, Pa, >= 0."""
        ...


@dataclass(frozen=True, repr=False)
class Perfect(Compact):
    """No hardening: the yield stress is constant.

    Attributes:
        yield_stress: yield stress in tension, Pa.

    Raises:
        InputError: not a positive finite number.

    Example:
        >>> la.hardening.Perfect(yield_stress=235e6).stress(np.array([0.0, 0.1])).tolist()
        [235000000.0, 235000000.0]
    """

    yield_stress: float

    def __post_init__(self) -> None:
        require_positive("Perfect.yield_stress", self.yield_stress)

    def stress(self, strain: Floats) -> Floats:
        """Yield stress, Pa."""
        return np.full(np.shape(strain), float(self.yield_stress))

    def modulus(self, strain: Floats) -> Floats:
        """Return zero."""
        return np.zeros(np.shape(strain))


@dataclass(frozen=True, repr=False)
class Linear(Compact):
    """``sigma_Y = yield_stress + slope eb``.

    Attributes:
        yield_stress: initial yield stress in tension, Pa.
        slope: hardening modulus, Pa, >= 0.

    Raises:
        InputError: a yield stress that is not positive, or a negative slope.

    Example:
        >>> la.hardening.Linear(yield_stress=235e6, slope=1e9).stress(np.array([0.0, 0.1])).tolist()
        [235000000.0, 335000000.0]
    """

    yield_stress: float
    slope: float

    def __post_init__(self) -> None:
        require_positive("Linear.yield_stress", self.yield_stress)
        if not is_number(self.slope):
            raise InputError("Linear.slope", self.slope, "not a finite number", "give one >= 0")
        if self.slope < 0:
            raise _softening("Linear.slope", self.slope, "give a slope >= 0")

    def stress(self, strain: Floats) -> Floats:
        """Yield stress, Pa."""
        return np.asarray(self.yield_stress + self.slope * np.asarray(strain))

    def modulus(self, strain: Floats) -> Floats:
        """Return the slope, Pa."""
        return np.full(np.shape(strain), float(self.slope))


@dataclass(frozen=True, repr=False)
class Voce(Compact):
    """``sigma_Y = saturation - (saturation - yield_stress) exp(-rate eb)``: hardening to a limit.

    Attributes:
        yield_stress: initial yield stress in tension, Pa.
        saturation: yield stress at large strains, Pa, >= yield_stress.
        rate: rate of the approach, > 0.

    Raises:
        InputError: a number that is not positive, a saturation below the yield stress.

    Example:
        >>> law = la.hardening.Voce(yield_stress=200e6, saturation=400e6, rate=10.0)
        >>> (law.stress(np.array([0.0, 0.1])) / 1e6).round(1).tolist()  # MPa
        [200.0, 326.4]
    """

    yield_stress: float
    saturation: float
    rate: float

    def __post_init__(self) -> None:
        require_positive("Voce.yield_stress", self.yield_stress)
        require_positive("Voce.saturation", self.saturation)
        require_positive("Voce.rate", self.rate)
        if self.saturation < self.yield_stress:
            raise _softening(
                "Voce.saturation",
                self.saturation,
                f"give at least the yield_stress, {self.yield_stress!r}",
            )

    def stress(self, strain: Floats) -> Floats:
        """Yield stress, Pa."""
        rise = -np.expm1(-self.rate * np.asarray(strain))  # exactly 0 at 0
        return np.asarray(self.yield_stress + (self.saturation - self.yield_stress) * rise)

    def modulus(self, strain: Floats) -> Floats:
        """Return its derivative, Pa."""
        left = np.exp(-self.rate * np.asarray(strain))
        return np.asarray((self.saturation - self.yield_stress) * self.rate * left)


@dataclass(frozen=True, repr=False)
class Swift(Compact):
    """``sigma_Y = strength (offset + eb)^exponent``: a power law that starts at a yield stress.

    Attributes:
        strength: yield stress at ``offset + eb = 1``, Pa.
        offset: previous strain of the material, > 0.
        exponent: hardening exponent, from 0 to 1.

    Raises:
        InputError: a strength or offset that is not positive, an exponent out of its range.

    Example:
        >>> law = la.hardening.Swift(strength=600e6, offset=0.01, exponent=0.2)
        >>> (law.stress(np.array([0.0, 0.1])) / 1e6).round(1).tolist()  # MPa
        [238.9, 385.9]
    """

    strength: float
    offset: float
    exponent: float

    def __post_init__(self) -> None:
        require_positive("Swift.strength", self.strength)
        require_positive("Swift.offset", self.offset)
        fix = "give an exponent from 0 (perfect) to 1 (linear)"
        if not is_number(self.exponent) or self.exponent > 1:
            raise InputError("Swift.exponent", self.exponent, "not a number that is at most 1", fix)
        if self.exponent < 0:
            raise _softening("Swift.exponent", self.exponent, fix)

    def stress(self, strain: Floats) -> Floats:
        """Yield stress, Pa."""
        return np.asarray(self.strength * (self.offset + np.asarray(strain)) ** self.exponent)

    def modulus(self, strain: Floats) -> Floats:
        """Return its derivative, Pa."""
        total = self.offset + np.asarray(strain)
        return np.asarray(self.strength * self.exponent * total ** (self.exponent - 1))


@dataclass(frozen=True, repr=False)
class Table(Compact):
    """Measured points with the monotone cubic interpolation of Fritsch & Carlson (1980).

    Beyond the last point the yield stress is constant, because a load must not rely on a strength
    that was not measured. The modulus may jump to zero there.

    Attributes:
        strains: equivalent plastic strains, increasing from 0; any sequence, stored as a tuple.
        stresses: yield stresses in tension there, Pa, nowhere decreasing.

    Raises:
        InputError: fewer than two points, not as many stresses as strains, numbers that are not
            finite, not positive or not in order.

    Example:
        >>> law = la.hardening.Table(strains=(0.0, 0.1, 0.3), stresses=(200e6, 300e6, 350e6))
        >>> (law.stress(np.array([0.0, 0.1])) / 1e6).round(1).tolist()  # MPa
        [200.0, 300.0]
    """

    strains: Sequence[float]
    stresses: Sequence[float]

    def __post_init__(self) -> None:
        for name in ("strains", "stresses"):
            # A frozen class also accepts arrays and lists, and must be hashable.
            object.__setattr__(self, name, _numbers(f"Table.{name}", getattr(self, name)))
        if len(self.strains) != len(self.stresses):
            raise InputError(
                "Table.stresses",
                None,
                f"{len(self.stresses)} stresses at {len(self.strains)} strains",
                "give as many of both",
            )
        if len(self.strains) < 2:
            raise InputError(
                "Table.strains", self.strains, "fewer than two points", "give more, or Perfect"
            )
        _check_order(self.strains, self.stresses)

    def stress(self, strain: Floats) -> Floats:
        """Yield stress, Pa."""
        return np.asarray(self._curve(np.clip(strain, 0.0, self.strains[-1])))

    def modulus(self, strain: Floats) -> Floats:
        """Return its derivative, Pa; at the last point that of the curve before it."""
        # The derivative of a monotone cubic may be negative by round-off.
        slopes = np.maximum(self._slope(np.clip(strain, 0.0, self.strains[-1])), 0.0)
        return np.asarray(np.where(np.asarray(strain) > self.strains[-1], 0.0, slopes))

    @cached_property
    def _curve(self) -> PchipInterpolator:
        # Import it here, because it takes half a second to load and only tables use it.
        from scipy.interpolate import PchipInterpolator

        return PchipInterpolator(self.strains, self.stresses)

    @cached_property
    def _slope(self) -> PPoly:
        return self._curve.derivative()


def require_hardening_law(field: str, law: HardeningLaw) -> None:
    """Raise `InputError` unless a law is valid, and does not soften at samples from 0 to 10."""
    if isinstance(law, type) or not isinstance(law, HardeningLaw):
        raise InputError(
            field, law, "not a hardening law", "give lacore.hardening.Voce(...) or another of them"
        )
    with np.errstate(all="ignore"):  # Overflow is rejected below.
        found = {"stress": law.stress(_SAMPLES), "modulus": law.modulus(_SAMPLES)}
    for name, values in found.items():
        if np.shape(values) != _SAMPLES.shape:
            raise InputError(
                f"{field}.{name}",
                None,
                f"returns shape {np.shape(values)} for strains of shape {_SAMPLES.shape}",
                "return a value for each strain",
            )
        if not np.all(np.isfinite(values)):
            at = _SAMPLES[~np.isfinite(values)][0]
            raise InputError(
                f"{field}.{name}", law, f"not finite at a strain of {at:.3g}", "check its numbers"
            )
    if np.any(found["stress"] <= 0):
        raise InputError(f"{field}.stress", law, "not positive everywhere", "give a law above 0 Pa")
    rounding = 4 * np.finfo(float).eps * found["stress"][1:]
    if np.any(found["modulus"] < 0) or np.any(np.diff(found["stress"]) < -rounding):
        raise _softening(field, law, "give a law that nowhere falls")
    _require_slope(field, law)


def _require_slope(field: str, law: HardeningLaw) -> None:
    """Raise `InputError` where the modulus is not the slope of the stress, but for some kinks."""
    at, step = _SAMPLES[1:], 1e-3 * _SAMPLES[1:]
    before, after = law.stress(at - step), law.stress(at + step)
    slope, modulus = (after - before) / (2 * step), law.modulus(at)
    rounding = 4 * np.finfo(float).eps * after / step
    wrong = np.abs(slope - modulus) > 1e-2 * np.maximum(slope, modulus) + rounding
    if np.mean(wrong) > _KINKS:
        place = int(np.flatnonzero(wrong)[-1])
        raise InputError(
            f"{field}.modulus",
            law,
            f"not the slope of the stress: {modulus[place]:.6g} against {slope[place]:.6g} at a"
            f" strain of {at[place]:.3g}",
            "return the derivative of stress by strain",
        )


def _softening(field: str, value: object, fix: str) -> InputError:
    why = "softens, which makes a step of sequential limit analysis non-convex (T29)"
    return InputError(field, value, why, fix)


def _numbers(field: str, values: Sequence[float]) -> tuple[float, ...]:
    fix = "give a sequence of finite numbers"
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise InputError(field, values, "not a sequence", fix)
    listed = tuple(values)
    for place, value in enumerate(listed):
        if not is_number(value):
            raise InputError(f"{field}[{place}]", value, "not a finite number", fix)
    return tuple(map(float, listed))


def _check_order(strains: Sequence[float], stresses: Sequence[float]) -> None:
    if abs(strains[0]) > 0:
        raise InputError(
            "Table.strains[0]", strains[0], "not 0", "start with the yield stress at strain 0"
        )
    require_positive("Table.stresses[0]", stresses[0])
    for place, (before, after) in enumerate(pairwise(strains), 1):
        if after <= before:
            raise InputError(
                f"Table.strains[{place}]",
                after,
                f"not above the strain before it, {before!r}",
                "give increasing strains, each once",
            )
    for place, (before, after) in enumerate(pairwise(stresses), 1):
        if after < before:
            raise _softening(
                f"Table.stresses[{place}]", after, f"give at least the one before it, {before!r}"
            )
