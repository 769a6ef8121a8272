"""Varied parameters by name: those of a case, its mesh, the loop and the backends."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import MISSING, fields, replace
from types import NoneType
from typing import Any, get_args, get_type_hints

import lacore as la
from lacore.reporting.errors import InputError, suggest
from lacore.solvers.backend import load_backend
from lacore_verification.case import Case, Variant
from lacore_verification.harness.campaigns.axis import ALIASES, KINDS, Axis, read_value

Names = Mapping[str, Mapping[str, type]]
"""Names that can be varied, and their types, by case or backend."""
_TYPES = (bool, int, float, str)


def parameters(case: Case, variants: Iterable[Variant]) -> dict[str, type]:
    """Return the parameters that all of these variants have."""
    shared = [variant.parameters for variant in variants]
    return {
        name: _type(case.build, name, value)
        for name, value in shared[0].items()
        if all(name in one for one in shared)
    }


def sizes(case: Case) -> dict[str, type]:
    """Return the keywords that all mesh levels have, as far as they are numbers or text."""
    first, *others = case.meshes.values()
    return {
        name: _type(case.build, name, value)
        for name, value in first.items()
        if isinstance(value, _TYPES) and all(name in one for one in others)
    }


def settings() -> dict[str, type]:
    """Return the settings of the coupling loops."""
    from lacore.coupling.options import CouplingOptions

    return _fields(CouplingOptions)


def options(backend: str) -> dict[str, type]:
    """Return the options of a backend; none for a missing one, which its rows report."""
    with suppress(la.CapabilityError):
        return _fields(load_backend(backend).Options)
    return {}


def _fields(cls: type) -> dict[str, type]:
    return {
        entry.name: _type(cls, entry.name, None if entry.default is MISSING else entry.default)
        for entry in fields(cls)
    }


def _type(owner: Callable[..., Any], name: str, default: Any) -> type:
    """Return the type of a value, from its annotation or its default."""
    hints: dict[str, Any] = {}
    # Some names are known to type checkers only.
    with suppress(NameError, TypeError, AttributeError):
        hints = get_type_hints(owner)
    hint = hints.get(name)
    plain = [part for part in get_args(hint) or (hint,) if part is not NoneType]
    annotated = [kind for kind in _TYPES if plain == [kind]]
    return next(iter([*annotated, *(kind for kind in _TYPES if isinstance(default, kind))]), str)


def resolved(axis: Axis, known: Mapping[str, Names]) -> Axis:
    """Return an axis with its kind.

    Args:
        axis: possibly without a kind.
        known: by kind. Each case must have a parameter or a size; of backends one is enough.

    Raises:
        InputError: an unknown name, an ambiguous one, or one that a case does not have.
    """
    kinds = [axis.kind] if axis.kind else list(KINDS)
    having = [kind for kind in kinds if any(axis.name in names for names in known[kind].values())]
    if not having:
        there = {name for kind in kinds for names in known[kind].values() for name in names}
        if "option" in kinds:
            there |= {short for short, name in ALIASES.items() if name in there}
        raise InputError(axis.field, None, "unknown name", suggest(axis.name, there))
    if len(having) > 1:
        ways = " or ".join(f"{kind}.{axis.name}" for kind in having)
        raise InputError(axis.field, None, "the name is ambiguous", f"write {ways}")
    (kind,) = having
    without = [owner for owner, names in known[kind].items() if axis.name not in names]
    if without and kind in ("param", "size"):
        what = "parameter" if kind == "param" else "keyword of its mesh levels"
        raise InputError(
            axis.field,
            None,
            f"case {without[0]!r} has no such {what}",
            "sweep it by itself, without this axis",
        )
    return replace(axis, kind=kind)


def grid(axes: Sequence[Axis], types: Mapping[str, type]) -> list[dict[str, Any]]:
    """Return all combinations of the values of axes, the last changing fastest; one without axes.

    Axes whose name is not among the types are omitted.

    Raises:
        InputError: a value of another type, or one twice.
    """
    points: list[dict[str, Any]] = [{}]
    for axis in axes:
        if axis.name in types:
            values = [read_value(axis.field, text, types[axis.name]) for text in axis.values]
            for index, value in enumerate(values):
                if value in values[:index]:
                    raise InputError(axis.field, value, "is there twice", "give it once")
            points = [{**point, axis.name: value} for point in points for value in values]
    return points
