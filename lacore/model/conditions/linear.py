"""Functions of place by numbers: what a file can state in place of a function in Python."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Bools, Floats
from lacore.reporting.errors import InputError, is_number, is_vector, require_place, require_range
from lacore.reporting.showing import Compact

_ROUND_OFF = 1e-12  # of the largest level: nearer to an edge one lies on it


@dataclass(frozen=True, repr=False)
class Linear(Compact):
    """``value + gradient . (x - at)``: strength or water pressure that grows with depth, say.

    Attributes:
        value: at the place `at`, Pa.
        gradient: by x and y, in space z too, Pa/m.
        at: m; the origin if it is left out.

    Raises:
        InputError: what are no numbers, as many of both; places of another space than they are of.

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
        fix = "give two finite numbers, in space three"
        if not is_vector(self.gradient):
            raise InputError("Linear.gradient", self.gradient, "not a vector", fix)
        if isinstance(self.at, tuple) and not self.at:
            object.__setattr__(self, "at", (0.0,) * len(self.gradient))
        if not (is_vector(self.at) and len(self.at) == len(self.gradient)):
            raise InputError("Linear.at", self.at, "not a place of the space of gradient", fix)
        require_range("Linear", self.value, self.gradient)
        require_place("Linear.at", self.at)

    def __call__(self, x: Floats) -> Floats:
        """Values at places of shape (d, n), shape (n,)."""
        if len(x) != len(self.gradient):
            why = f"{len(self.gradient)} numbers, where places have {len(x)}"
            raise InputError("Linear.gradient", self.gradient, why, "give as many, of `at` too")
        values = self.value + np.zeros(x.shape[1:])
        for slope, own, start in zip(self.gradient, x, self.at, strict=True):
            values = values + slope * (own - start)
        return np.asarray(values)


@dataclass(frozen=True, repr=False)
class ByLevel(Compact):
    """Linear by height between values at levels, and as at the last one beyond: a table by depth.

    Where levels run through elements of a mesh it is not linear in them: let its edges follow
    them, or give its `steepest` slope to `lacore.Field`.

    Attributes:
        levels: heights, m, each once, in any order; two at least: of y, in space of z.
        values: there.

    Raises:
        InputError: what are no numbers, a level that is there twice, not as many of both.

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
        """See `lacore.model.materials.fields.Bending`."""
        level = np.array(self.levels)[:, None]
        room = _ROUND_OFF * float(np.abs(level).max())
        return np.asarray(((level > low[-1] + room) & (level < high[-1] - room)).any(axis=0))

    def __call__(self, x: Floats) -> Floats:
        """Values at places of shape (d, n), shape (n,)."""
        return np.asarray(np.interp(x[-1], self.levels, self.values))
