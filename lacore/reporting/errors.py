"""Errors that name the field, the value and the fix."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from difflib import get_close_matches
from functools import cache, wraps
from inspect import signature
from math import isfinite
from numbers import Integral, Real
from os import PathLike
from types import NoneType, UnionType
from typing import Any, ParamSpec, TypeVar, get_args, get_origin, get_type_hints
from warnings import warn

import numpy as np

from lacore.reporting.text import join, text

Given = ParamSpec("Given")
Answer = TypeVar("Answer")
DISTRIBUTION = "lacore-limit-analysis"
"""Name under which lacore is installed; `lacore` on the public index is another project."""
_MOST = 2**31 - 1
_JUDGED = ("lacore", "skfem")  # packages whose classes are checked
_LONGEST = 300  # characters of a value in a message
_RANGE = (1e-60, 1e60)  # Products of five such numbers, areas times strengths, are still finite.


class LacoreError(Exception):
    """Base of every error that lacore raises on purpose."""

    @property
    def text(self) -> str:
        """The message, with its quantities and names as values."""
        return str(self)


class InputError(LacoreError, ValueError):
    """Invalid input; raised before any solve.

    The message reads ``field = value: reason; fix``. A reason or a fix that contains quantities or
    names is a `lacore.reporting.text.Text`, which readers of problem files see in their units and
    with their keys.

    Attributes:
        field: Name of the argument or attribute, such as ``Problem.interfaces[0].friction``.
        value: Its value; None if the value is missing or too long to be shown.
        reason: Why the value is wrong.
        fix: How to fix it.
    """

    def __init__(self, field: str, value: object, reason: str, fix: str) -> None:
        self.field, self.value, self.reason, self.fix = field, value, reason, fix
        super().__init__(str(self.text))

    @property
    def errors(self) -> tuple[InputError, ...]:
        """The errors that were found together; only this one, if there is no other."""
        return (self,)

    @property
    def text(self) -> str:
        """The message, with its quantities and names as values."""
        shown = "" if self.value is None else f" = {_short(self.value)}"
        return text("{}{}: {}; {}", self.field, shown, self.reason, self.fix)

    @property
    def why(self) -> str:
        """The reason, by the name of this attribute until 0.4."""
        warn("InputError.why is now InputError.reason", DeprecationWarning, stacklevel=2)
        return self.reason

    def __reduce__(self) -> tuple[type, tuple[object, ...]]:
        """Pickle by the arguments: the message alone would not build it again."""
        return type(self), (self.field, self.value, self.reason, self.fix)


class MultipleInputError(InputError):
    """Several errors of one problem file; the message has a line for each of them.

    Field, value, reason and fix are those of the first error.
    """

    def __init__(self, *errors: InputError) -> None:
        self._errors = errors
        first = errors[0]
        super().__init__(first.field, first.value, first.reason, first.fix)

    def __reduce__(self) -> tuple[type, tuple[object, ...]]:
        """Pickle by the errors."""
        return type(self), self._errors

    @property
    def errors(self) -> tuple[InputError, ...]:
        """The errors, in the order of the file."""
        return self._errors

    @property
    def text(self) -> str:
        """The messages, each on its line."""
        return join("\n", [own.text for own in self._errors])


def install_command(extra: str) -> str:
    """Return the command that installs lacore with a group of optional dependencies.

    Args:
        extra: Name of the group in pyproject.toml, such as ``dask``.
    """
    return f"pip install '{DISTRIBUTION}[{extra}]'"


def _short(value: object) -> str:
    """Return a value as text, or only its type if it is very long."""
    written = repr(value)
    return (
        written if len(written) <= _LONGEST and "\n" not in written else f"<{type(value).__name__}>"
    )


class CapabilityError(LacoreError):
    """Raised if a backend does not support a program; the message gives the reason and the fix."""


class BackendError(LacoreError):
    """Raised for an error of a backend in a separate process, or an unreadable answer."""


class SolveError(LacoreError):
    """Raised for a solve without a certified load factor (``throw=True``); contains the state."""

    def __init__(self, message: str, state: object) -> None:
        self.state = state
        super().__init__(message)


_KINDS: dict[Any, tuple[str, str]] = {
    Callable: ("cannot be called", "give a function"),
    Mapping: ("no mapping", "give {'name': ...}"),
    PathLike: ("no path", "give a path"),
}
"""Checked types of other packages, with the fix for other arguments."""


def renamed_argument(
    old: str, new: str
) -> Callable[[Callable[Given, Answer]], Callable[Given, Answer]]:
    """Let a function take an argument by its former name, with a warning."""

    def decorate(function: Callable[Given, Answer]) -> Callable[Given, Answer]:
        @wraps(function)
        def call(*args: Given.args, **kwargs: Given.kwargs) -> Answer:
            if old in kwargs:
                name = function.__name__
                warn(f"{name}({old}=) is now {name}({new}=)", DeprecationWarning, stacklevel=2)
                kwargs[new] = kwargs.pop(old)
            return function(*args, **kwargs)

        return call

    return decorate


def typed(**fixes: str) -> Callable[[Callable[Given, Answer]], Callable[Given, Answer]]:
    """Return a decorator that raises `InputError` for arguments of the wrong type.

    Only types of objects are checked: classes of lacore, meshes, functions, mappings and paths, and
    None in unions with them. Numbers, names and arrays are checked by value when they are read.

    Args:
        fixes: fixes for arguments that need more than the name of their type.
    """

    def asking(asked: Callable[Given, Answer]) -> Callable[Given, Answer]:
        names = list(signature(asked).parameters)

        @cache
        def judged() -> dict[str, tuple[type, ...]]:  # All names in annotations are known by now.
            return {name: kinds_of(hint) for name, hint in get_type_hints(asked).items()}

        @wraps(asked)
        def answer(*args: Given.args, **kwargs: Given.kwargs) -> Answer:
            kinds = judged()
            for name, value in (dict(zip(names, args, strict=False)) | kwargs).items():
                if kinds.get(name) and not isinstance(value, kinds[name]):
                    raise _wrong_kind(name, value, kinds[name], fixes.get(name))
            return asked(*args, **kwargs)

        return answer

    return asking


def kinds_of(hint: object) -> tuple[type, ...]:
    """Return the classes that an annotation accepts; empty if it is not checked."""
    options = get_args(hint) if isinstance(hint, UnionType) else (hint,)
    kinds = tuple(get_origin(option) or option for option in options)
    classes = tuple(kind for kind in kinds if isinstance(kind, type))
    judged = [kind for kind in classes if kind not in (str, NoneType)]
    return classes if judged and len(classes) == len(kinds) and all(map(_tells, judged)) else ()


def _tells(kind: type) -> bool:
    """Return whether a class is checked: other classes accept numbers and arrays."""
    ours = _package(kind) in _JUDGED and not getattr(kind, "_is_protocol", False)
    return ours or issubclass(kind, tuple(_KINDS))


def _package(kind: type) -> str:
    return kind.__module__.partition(".")[0]


def _wrong_kind(field: str, value: object, kinds: Sequence[type], fix: str | None) -> InputError:
    asked = [kind for kind in kinds if kind not in (str, NoneType)]
    if isinstance(value, type) and issubclass(value, tuple(asked)):
        return InputError(field, value.__name__, "the class itself", f"give {value.__name__}(...)")
    names = [kind.__name__.removesuffix("1") for kind in asked]  # MeshTri1 is shown as MeshTri.
    why, give = f"no {' or '.join(names)}", f"give a {_package(asked[0])}.{names[0]}"
    give = f"{give}; that of a body is body.mesh" if hasattr(value, "mesh") else give
    why, give = next((_KINDS[kind] for kind in _KINDS if issubclass(asked[0], kind)), (why, give))
    why = f"None: {why}" if value is None else why
    give = f"{give}, or leave it out" if NoneType in kinds else give
    return InputError(field, value, why, fix or give)


def suggest(name: str, known: Iterable[str]) -> str:
    """Return advice for an unknown name: "did you mean ..." or the list of known names."""
    names = sorted(known)
    alike = 0.5 if len(name) < 4 else 0.6  # In a name of three letters, one or two are half of it.
    close = get_close_matches(name, names, n=1, cutoff=alike)
    if close:
        return f"did you mean {close[0]!r}?"
    return f"known names: {', '.join(names)}" if names else "none is known"


def suggest_all(name: str, known: Iterable[str]) -> str:
    """Return `suggest` with the list of known names in any case, for names chosen by others."""
    names = sorted(known)
    nearest = suggest(name, names)
    return f"{nearest} known names: {', '.join(names)}" if nearest.endswith("?") else nearest


def require_known(field: str, name: str, known: Iterable[str]) -> None:
    """Raise `InputError` unless `name` is one of `known`."""
    names = list(known)
    if not isinstance(name, str) or name not in names:
        raise InputError(field, name, "unknown name", suggest(str(name), names))


def is_number(value: object) -> bool:
    """Return whether a value is a finite real number (not True or False)."""
    if not isinstance(value, Real) or isinstance(value, bool | np.bool_):
        return False
    try:
        return isfinite(value)
    except OverflowError:  # whole numbers that no float can hold
        return False


def is_plane_vector(value: object) -> bool:
    """Return whether a value is two finite real numbers."""
    return (
        isinstance(value, Sequence | np.ndarray) and len(value) == 2 and all(map(is_number, value))
    )


def is_vector(value: object) -> bool:
    """Return whether a value consists of two or three finite real numbers."""
    return (
        isinstance(value, Sequence | np.ndarray)
        and len(value) in (2, 3)
        and all(map(is_number, value))
    )


def require_range(field: str, *values: object) -> None:
    """Raise `InputError` where numbers are too large, or all of them too small, to be multiplied.

    Args:
        field: named in the message.
        values: numbers or arrays of them, finite; zeros and infinite strengths pass.
    """
    for value in values:
        size = np.abs(np.asarray(value, dtype=np.float64))
        largest = float(np.max(size, where=np.isfinite(size), initial=0.0))
        if largest > 0 and not _RANGE[0] <= largest <= _RANGE[1]:
            raise InputError(
                field,
                largest,
                f"outside of {_RANGE[0]:g} to {_RANGE[1]:g}: products of such numbers overflow,"
                " or vanish",
                "fix it, or give everything in other units",
            )


def require_place(field: str, place: object) -> None:
    """Raise `InputError` if coordinates are too large to be multiplied.

    Small ones are places near the origin, such as zeros after a rotation.
    """
    size = np.abs(np.asarray(place, dtype=np.float64))
    require_range(field, np.where(size < 1, 0.0, size))


def require_count(field: str, value: int) -> None:
    """Raise `InputError` unless `value` is a positive whole number that solvers can count to."""
    if not (isinstance(value, Integral) and not isinstance(value, bool) and value > 0):
        raise InputError(field, value, "not a positive whole number", "give a whole number > 0")
    if value > _MOST:
        raise InputError(field, value, "more than solvers count to", f"give at most {_MOST}")


def require_whole(field: str, value: int) -> None:
    """Raise `InputError` unless `value` is a whole number from 0 on."""
    if not (isinstance(value, Integral) and not isinstance(value, bool) and value >= 0):
        raise InputError(field, value, "not a whole number", "give 0, 1, 2, ...")


def require_positive(field: str, value: float) -> None:
    """Raise `InputError` unless `value` is a positive finite number."""
    if not (is_number(value) and value > 0):
        raise InputError(field, value, "not a positive number", "give a finite value > 0")
    require_range(field, value)


def require_width(field: str, value: float) -> None:
    """Raise `InputError` unless `value` is the width of a bracket as a share of its load factor."""
    require_positive(field, value)
    if value >= 1:
        raise InputError(field, value, "not a share of the load factor", "give 0.05 for 5 %")
