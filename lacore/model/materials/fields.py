"""Varying strengths: functions of coordinates, or a value in each element."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np

from lacore.numerics.arrays import Bools, Floats
from lacore.reporting.errors import InputError, is_number, require_positive, require_range
from lacore.reporting.showing import Compact, placed, short
from lacore.reporting.text import Quantity, Symbol, text

Given = float | Sequence[float] | Callable[[Floats], Floats]
"""Argument for a strength: Pa, one value for each element of a mesh, or a function."""


@runtime_checkable
class Bending(Protocol):
    """Function of place that knows where it bends; elsewhere it is linear."""

    def bends(self, low: Floats, high: Floats) -> Bools:
        """Return whether it bends within boxes, by their corners of shape (d, n), shape (n,)."""
        ...


@dataclass(frozen=True, repr=False, eq=False)
class Field(Compact):
    """Varying strength, or friction angle, as argument of criteria instead of a number.

    A function is evaluated within each element, and may jump between elements: let edges of the
    mesh follow its jumps. If it is linear in each element, which is checked at 15 places of it to
    1e-12 of its size, bounds are strict without further data. Otherwise give `steepest`, and in
    each element bounds use the smallest and largest value that it can have there, for any values at
    those places, unless the function knows where it bends, as `lacore.ByLevel` does.

    Attributes:
        values: a function of coordinates of shape (2, n), in three dimensions (3, n), that returns
            n values in Pa, or one value for each element of the mesh, shape (elements,). Along a
            path also by strain points, shape (elements, q).
        steepest: largest slope of the function anywhere within an element, Pa/m; None: unknown.
        factor: factor of all values; for the strengths of a form also one for each element,
            (elements,).

    Raises:
        InputError: other values, invalid or negative numbers, or a slope that is not positive.

    Example:
        >>> deeper = la.Field(lambda x: 10e3 - 2e3 * x[1])  # Pa, at y < 0
        >>> clay = la.VonMises(shear_strength=deeper)
    """

    values: Callable[[Floats], Floats] | Floats
    steepest: float | None = None
    factor: float | Floats = 1.0
    __array_ufunc__: ClassVar[None] = None  # An array times a field is a field, too.

    def __post_init__(self) -> None:
        if self.steepest is not None:
            require_positive("Field.steepest", self.steepest)
        if not callable(self.values):
            object.__setattr__(self, "values", _array("Field.values", self.values))

    def __mul__(self, factor: float | Floats) -> Field:
        """Return all values times a factor, Pa."""
        return self._scaled(self.factor * factor)

    __rmul__ = __mul__

    def __truediv__(self, divisor: float | Floats) -> Field:
        """Return all values divided, Pa."""
        return self * (1 / divisor)

    def __sub__(self, other: Field) -> Field:
        """Return the field minus a multiple of itself, Pa."""
        if other.values is not self.values:
            raise ValueError("a field less another one is no multiple of it")
        return self._scaled(self.factor - other.factor)

    def _scaled(self, factor: float | Floats) -> Field:
        """Return the field with another factor, and the same values object, which identifies it."""
        scaled = replace(self, factor=factor)
        object.__setattr__(scaled, "values", self.values)
        return scaled

    @property
    def told(self) -> str:
        """Short text: ``varies``."""
        return "varies" if callable(self.values) else "of each element"

    def told_in(self, unit: str) -> Quantity | str:
        """Return the text in a unit if values are known, else the short text."""
        return self.told

    def at(self, places: Floats, field: str) -> Floats:
        """Return the values of a function at places (d, n), without the factor, Pa, shape (n,).

        Raises:
            InputError: it fails there, or does not return n finite numbers >= 0.
        """
        assert callable(self.values)
        return np.asarray(called(field, self.values, places, (places.shape[1],)))


@dataclass(frozen=True, repr=False, eq=False)
class Ranged(Field):
    """Field with a known range of values, for texts.

    Attributes:
        ends: smallest and largest value, without the factor.
    """

    ends: tuple[float, float] = (0.0, 0.0)

    def told_in(self, unit: str) -> Quantity | str:
        """Return a text such as ``10000 to 16000 Pa``."""
        low, high = sorted(float(np.max(self.factor)) * end for end in self.ends)
        return Quantity((low, high), unit, ".4g", "{} to {}")


Strength = float | Field
"""Strength as stored in criteria."""
Strengths = float | Floats | Field
"""Strength as stored in forms, also one for each element, shape (elements,)."""


def taken(field: str, given: Given | Field | None) -> Any:
    """Return a number or None unchanged, and functions and values of elements as a `Field`.

    Raises:
        InputError: values of elements that are not strengths.
    """
    if isinstance(given, Field) or given is None or is_number(given):
        return given
    if callable(given):
        return Field(given)
    if isinstance(given, Sequence | np.ndarray) and not isinstance(given, str):
        return Field(_array(field, given))
    return given  # for the check of a number


def varying(criterion: object) -> dict[str, Field]:
    """Return the fields of a criterion, by the names of their arguments."""
    if not is_dataclass(criterion):
        return {}
    given = {entry.name: getattr(criterion, entry.name) for entry in fields(criterion)}
    return {name: own for name, own in given.items() if isinstance(own, Field)}


def with_fields(criterion: Any, change: Callable[[Field], Field]) -> Any:
    """Return a criterion with each of its fields changed."""
    found = varying(criterion)
    if not found:
        return criterion
    return replace(criterion, **{name: change(own) for name, own in found.items()})


def number_told(name: str | Symbol, value: Strength, unit: str = "Pa") -> str:
    """Return a text such as ``k = 1 Pa``, or ``k varies``."""
    told = value.told_in(unit) if isinstance(value, Field) else Quantity(value, unit, ".4g")
    return text("{} {}" if isinstance(told, str) else "{} = {}", name, told)


def called(
    field: str,
    function: Callable[[Floats], Floats],
    places: Floats,
    shape: tuple[int, ...],
    least: float = 0.0,
) -> Floats:
    """Return the values of a function at places of shape (d, n), checked.

    Raises:
        InputError: it fails, or does not return finite numbers of a shape, at least `least`.
    """
    try:
        values = np.asarray(function(places), dtype=np.float64)
    except Exception as error:  # functions of users
        raise InputError(
            field,
            None,
            f"the function fails for coordinates ({len(places)}, n):"
            f" {type(error).__name__}: {error}",
            "compute with arrays: x[1] holds the heights of all places",
        ) from error
    if values.shape not in (shape, shape[:-1], ()):
        raise InputError(
            field,
            values.shape,
            f"the function does not return an array of shape {shape}",
            f"return one value a place for coordinates of shape ({len(places)}, n)",
        )
    missing = len(shape) - values.ndim
    values = np.broadcast_to(values.reshape(values.shape + (1,) * missing), shape)
    wrong = ~(np.isfinite(values) & (values >= least))
    if wrong.any():
        place = np.flatnonzero(wrong.reshape(-1, shape[-1]).any(axis=0))[0]
        found = [float(f"{value:.4g}") for value in np.atleast_1d(values[..., place])]
        raise InputError(
            field,
            found if len(found) > 1 else found[0],
            f"at {placed(places[:, place])}: "
            + ("negative" if min(found) < 0 else "not a finite number"),
            "let it return finite values >= 0 in all of the body"
            if least == 0.0
            else "let it return finite numbers in all of the body",
        )
    require_range(field, values)
    return values


def _array(field: str, given: object) -> Floats:
    try:
        values = np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        values = np.zeros(0)
    if values.ndim not in (1, 2) or not values.size:
        raise InputError(
            field,
            short(given),
            "neither a number nor a function nor a value for each element",
            "give a number in Pa, a function of coordinates (2, n), or an array of shape"
            " (elements,)",
        )
    wrong = np.flatnonzero(~(np.isfinite(values) & (values >= 0)).reshape(len(values), -1).all(1))
    if wrong.size:
        raise InputError(
            field,
            short(values[wrong[0]].tolist()),
            f"of element {wrong[0]}: negative, or no number",
            "give finite strengths >= 0 in Pa",
        )
    require_range(field, values)
    values.flags.writeable = False
    return values
