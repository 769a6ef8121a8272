"""Functions of place by numbers, which a file can contain instead of Python functions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Bools, Floats
from lacore.reporting.errors import InputError, is_number, is_vector, require_place, require_range
from lacore.reporting.showing import Compact

_ROUND_OFF = 1e-12  # by the largest level: places closer to a level are on it


@dataclass(frozen=True, repr=False)
class Linear(Compact):
    """Linear function ``value + gradient . (x - at)``, such as a strength that grows with depth.

    Attributes:
        value: value at the place `at`, Pa.
        gradient: derivatives by x and y, in three dimensions also z, Pa/m.
        at: m; the origin by default.

    Raises:
        InputError: invalid numbers, or a different number of both; places of another dimension.

    Example:
        >>> deeper = la.Linear(10e3, gradient=(0.0, -2e3))  # Pa, at y < 0
        >>> clay = la.VonMises(shear_strength=la.Field(deeper))
    """

    value: float
    gradient: tuple[float, ...]
    at: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if not is_number(self.value):
            raise InputError("Linear.value", self.value, "not a number", "give a finite number")
        fix = "give two finite numbers, in three dimensions three"
        if not is_vector(self.gradient):
            raise InputError("Linear.gradient", self.gradient, "not a vector", fix)
        if isinstance(self.at, tuple) and not self.at:
            object.__setattr__(self, "at", (0.0,) * len(self.gradient))
        if not (is_vector(self.at) and len(self.at) == len(self.gradient)):
            raise InputError("Linear.at", self.at, "not a place of the space of gradient", fix)
        require_range("Linear", self.value, self.gradient)
        require_place("Linear.at", self.at)

    def __call__(self, x: Floats) -> Floats:
        """Return the values at places of shape (d, n), shape (n,)."""
        if len(x) != len(self.gradient):
            why = f"{len(self.gradient)} numbers, where places have {len(x)}"
            raise InputError("Linear.gradient", self.gradient, why, "give as many, of `at` too")
        values = self.value + np.zeros(x.shape[1:])
        for slope, own, start in zip(self.gradient, x, self.at, strict=True):
            values = values + slope * (own - start)
        return np.asarray(values)


@dataclass(frozen=True, repr=False)
class ByLevel(Compact):
    """Table by height: linear between values at levels, and constant beyond the last ones.

    If levels run through elements of a mesh, it is not linear in them: let its edges follow them,
    or give its `steepest` slope to `lacore.Field`.

    Attributes:
        levels: heights, m, each once, in any order, at least two: y, or z in three dimensions.
        values: values at the levels.

    Raises:
        InputError: invalid numbers, a repeated level, or a different number of both.

    Example:
        >>> measured = la.ByLevel(levels=(-10.0, 0.0), values=(30e3, 10e3))  # m and Pa
        >>> clay = la.VonMises(shear_strength=la.Field(measured))
    """

    levels: Sequence[float]
    values: Sequence[float]

    def __post_init__(self) -> None:
        for name in ("levels", "values"):
            given = getattr(self, name)
            if not isinstance(given, Sequence | np.ndarray) or not all(map(is_number, given)):
                fix = "give a list of finite numbers"
                raise InputError(f"ByLevel.{name}", given, "not numbers", fix)
            require_range(f"ByLevel.{name}", given)
        if len(self.levels) != len(self.values) or len(self.levels) < 2:
            why = f"{len(self.levels)} levels and {len(self.values)} values"
            raise InputError(
                "ByLevel.values", self.values, why, "give two or more, as many of both"
            )
        if len(set(self.levels)) < len(self.levels):
            fix = "give each once; what jumps makes regions"
            raise InputError("ByLevel.levels", self.levels, "a level is there twice", fix)
        order = np.argsort(self.levels)
        for name in ("levels", "values"):
            given = getattr(self, name)
            object.__setattr__(self, name, tuple(float(given[n]) for n in order))

    @property
    def steepest(self) -> float:
        """The largest slope, per m."""
        return float(np.max(np.abs(np.diff(self.values) / np.diff(self.levels))))

    def bends(self, low: Floats, high: Floats) -> Bools:
        """Return where it bends, see `lacore.model.materials.fields.Bending`."""
        level = np.array(self.levels)[:, None]
        room = _ROUND_OFF * float(np.abs(level).max())
        return np.asarray(((level > low[-1] + room) & (level < high[-1] - room)).any(axis=0))

    def __call__(self, x: Floats) -> Floats:
        """Return the values at places of shape (d, n), shape (n,)."""
        return np.asarray(np.interp(x[-1], self.levels, self.values))
