"""Forces per volume: own weight, earthquakes, uniform or varying with place."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from lacore.model.conditions.where import where_name
from lacore.model.materials.fields import Field, called
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError, is_number, require_range
from lacore.reporting.showing import Compact
from lacore.reporting.text import Quantity, text

Component = float | Sequence[float] | Callable[[Floats], Floats] | Field
"""N/m^3, a value for each element of a mesh or each block, or a function of place."""


@dataclass(frozen=True, repr=False)
class BodyForce(Compact):
    """Force per volume [N/m^3], uniform or varying with place.

    A function is evaluated within each element, and may jump between elements: let edges of the
    mesh follow its jumps and kinks. If it is linear in each element, loads are exact, and bounds
    are as strict as for a uniform load (T86). If it is not, `lacore.solve` integrates it
    approximately, and bounds reject it. On rigid blocks it must be linear in each.

    Attributes:
        body: name of the body.
        vector: components along x and y, in three dimensions also z, N/m^3: each a number, a
            function of coordinates of shape (d, n) that returns n values (`lacore.Linear`,
            `lacore.ByLevel`), a `lacore.Field`, or one value for each element of the mesh (for an
            assembly each block), for any `where`.
        where: the block (or blocks) of an assembly that it acts on, or the region (or regions) of a
            continuum, by the names of ``mesh.subdomains``; None: on all of the body.

    Raises:
        InputError: an invalid component, or a field with a steepest slope.

    Example:
        >>> weight = la.BodyForce("soil", (0.0, -20e3))  # N/m^3
    """

    body: str
    vector: tuple[Component, ...]
    where: str | tuple[str, ...] | None = None
    boundary: ClassVar[None] = None
    point: ClassVar[None] = None

    def __post_init__(self) -> None:
        given = self.vector
        if not isinstance(given, Sequence | np.ndarray) or len(given) not in (2, 3):
            fix = (
                "give two components, in three dimensions three, each a number in N/m^3 or a"
                " function of coordinates"
            )
            raise InputError("BodyForce.vector", given, "not a vector", fix)
        own = tuple(_taken(f"BodyForce.vector[{axis}]", one) for axis, one in enumerate(given))
        # Check all components together, since rotating a frame may turn a zero into a tiny number.
        require_range("BodyForce.vector", np.concatenate([_numbers(one) for one in own]))
        object.__setattr__(self, "vector", own)

    @property
    def uniform(self) -> bool:
        """Whether it is the same at all places."""
        return all(map(is_number, self.vector))

    @property
    def piecewise_uniform(self) -> bool:
        """Whether it is given as uniform in each element, or block."""
        return not any(_function(one) for one in self.vector)

    @property
    def by_elements(self) -> bool:
        """Whether a component has a value for each element, or each block."""
        return any(_values(one) is not None for one in self.vector)

    @property
    def told(self) -> str:
        """Short text."""
        part = "" if self.where is None else f".{where_name(self.where)}"
        own = Quantity(tuple(map(_told, self.vector)), "N/m^3", ".7g")
        return text("{} in {}{}", own, self.body, part)

    @property
    def size(self) -> float:
        """Size >= 0, in N/m^3; 1 if it varies from place to place: a factor of all of it."""
        if not self.uniform:
            return 1.0
        return float(np.linalg.norm(np.asarray(self.vector, dtype=np.float64)))

    def times(self, factor: float) -> BodyForce:
        """Return the same load with another size."""
        return replace(self, vector=tuple(_times(one, factor) for one in self.vector))

    def changed(self, change: Callable[[tuple[float, ...]], Component]) -> BodyForce:
        """Return the load with its components by elements, including the factor, changed."""

        def new(one: Component) -> Component:
            values = _values(one)
            return one if values is None else change(tuple(values.tolist()))

        return replace(self, vector=tuple(map(new, self.vector)))

    def at(self, places: Floats, parts: Ints, count: int, field: str) -> Floats:
        """Return the values at places of shape (d, n), N/m^3, shape (d, n).

        Args:
            places: m.
            parts: number of the element or block of each place, shape (n,).
            count: number of elements or blocks.
            field: name of the load in messages.

        Raises:
            InputError: a function that fails there or does not return n finite numbers, or values
                for other elements.
        """
        found = []
        for axis, own in enumerate(self.vector):
            place = f"{field}.vector[{axis}]"
            values = _values(own)
            if values is not None:
                if len(values) != count:
                    why = f"there are {count} elements or blocks"
                    fix = "give one for each, whatever `where`"
                    raise InputError(place, f"{len(values)} values", why, fix)
                found.append(values[parts])
            elif callable(own):
                found.append(_called(place, own, places))
            elif isinstance(own, Field):
                assert callable(own.values)
                found.append(own.factor * _called(place, own.values, places))
            else:
                found.append(np.full(places.shape[1], own, dtype=np.float64))
        return np.stack(found)


def acting(component: Component) -> bool:
    """Return whether a component is not zero."""
    values = _values(component)
    return bool(np.any(values)) if values is not None else callable(component) or bool(component)


def _called(field: str, function: Callable[[Floats], Floats], places: Floats) -> Floats:
    return called(field, function, places, (places.shape[1],), least=-np.inf)


def _taken(field: str, given: object) -> Component:
    """Return a number, a function or a field unchanged, and values of elements as a tuple."""
    if is_number(given):
        return given  # type: ignore[return-value]  # a number
    if isinstance(given, Field):
        if given.steepest is not None:
            why = "bounds take a body force as it is: it has to be linear in each element"
            raise InputError(f"{field}.steepest", given.steepest, why, "leave it out")
        if np.ndim(given.values) > 1:  # type: ignore[arg-type]  # of a function 0
            why = "values at the points of elements"
            raise InputError(field, np.shape(given.values), why, "give one for each element")  # type: ignore[arg-type]
        return given
    if callable(given):
        return given
    try:
        values = np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        values = np.zeros(0)
    if isinstance(given, str) or values.ndim != 1 or not values.size:
        raise InputError(
            field,
            given,
            "neither a number nor a function nor a value for each element",
            "give a finite number in N/m^3, a function of coordinates (2, n), or an array of shape"
            " (elements,)",
        )
    wrong = np.flatnonzero(~np.isfinite(values))
    if wrong.size:
        why = f"of element {wrong[0]}: not a finite number"
        raise InputError(field, float(values[wrong[0]]), why, "give finite values in N/m^3")
    return tuple(values.tolist())


def _numbers(component: Component) -> Floats:
    """Return the number, or those of elements; none for a function."""
    values = _values(component)
    if values is None:
        values = np.array([component] if is_number(component) else [], dtype=np.float64)
    return values


def _values(component: Component) -> Floats | None:
    """Return the values of each element; None for other components."""
    if isinstance(component, Field):
        listed = not callable(component.values)
        return component.factor * np.asarray(component.values) if listed else None
    return np.asarray(component) if isinstance(component, tuple) else None


def _times(component: Component, factor: float) -> Component:
    if callable(component):
        return Field(component) * factor
    values = _values(component)
    return component * factor if values is None else tuple((factor * values).tolist())  # type: ignore[operator]  # a number or a field


def _function(component: Component) -> bool:
    return callable(component.values if isinstance(component, Field) else component)


def _told(component: Component) -> float | str:
    return component if is_number(component) else "varies"  # type: ignore[return-value]
