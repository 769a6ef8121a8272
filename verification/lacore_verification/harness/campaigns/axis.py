"""One axis of a grid: the parameter and its values, as text.

``NAME=START:STOP:N`` are N values at equal distances, ``NAME=START:STOP:N:log`` at equal ratios,
``NAME=a,b,c`` these. Values stay text until the parameter defines their type.
"""

from dataclasses import dataclass
from math import isfinite

import numpy as np

from lacore.reporting.errors import InputError, require_known

KINDS = ("param", "size", "setting", "option")
"""Prefixes for the case, its mesh level, the loop and the backend, as in ``option.r``."""
ALIASES = {"K_c": "bulk", "K_n": "normal", "K_t": "tangential"}
"""Penalties as the theory calls them, and as the backends do."""
_MOST = 10_000  # Largest number of values of one axis: more is a typing error.
_DIGITS = 12  # Digits of values in between: 0.3, not 0.30000000000000004.
_FORM = "write NAME=START:STOP:N, NAME=START:STOP:N:log or NAME=a,b,c"


@dataclass(frozen=True)
class Axis:
    """A varied parameter with its values.

    Attributes:
        kind: one of `KINDS`; empty where only the name was given.
        name: without its prefix.
        values: as text, in the order given; at least one.
    """

    kind: str
    name: str
    values: tuple[str, ...]

    @property
    def field(self) -> str:
        """For errors."""
        return f"--vary {self.kind}.{self.name}" if self.kind else f"--vary {self.name}"


def read_axis(text: str) -> Axis:
    """Return an axis from text.

    Raises:
        InputError: it does not have this form, has no value, or has invalid ends.
    """
    given, equals, written = (part.strip() for part in text.partition("="))
    if not (given and equals):
        raise InputError("--vary", text, "does not say what to vary", _FORM)
    first, dot, rest = given.partition(".")
    kind, name = (first, rest) if dot else ("", first)
    if dot:
        require_known("--vary, prefix", kind, KINDS)
    if name in ALIASES and kind in ("", "option"):
        kind, name = "option", ALIASES[name]
    field = f"--vary {given}"
    values = _range(field, written) if ":" in written else _list(field, written)
    return Axis(kind, name, values)


def _list(field: str, written: str) -> tuple[str, ...]:
    values = tuple(part.strip() for part in written.split(","))
    if not all(values):
        why = "a value is missing" if any(values) else "no value, so the grid is empty"
        raise InputError(field, written, why, _FORM)
    return values


def _range(field: str, written: str) -> tuple[str, ...]:
    start, stop, *rest = (part.strip() for part in written.split(":"))
    if not rest or rest[1:] not in ([], ["log"]):
        raise InputError(field, written, "not a range", _FORM)
    count = _count(field, rest[0])
    ends = _end(field, "START", start), _end(field, "STOP", stop)
    if not rest[1:]:
        values = np.linspace(*ends, count)
    elif min(ends) > 0:
        values = np.geomspace(*ends, count)
    else:
        raise InputError(
            field, written, "equal ratios need ends above 0", "give such ends, or leave out :log"
        )
    return tuple(f"{value:.{_DIGITS}g}" for value in values)


def _count(field: str, text: str) -> int:
    if not (text.isascii() and text.isdigit() and 1 <= int(text) <= _MOST):
        raise InputError(
            f"{field}, N", text, "not a number of values", f"give a whole number from 1 to {_MOST}"
        )
    return int(text)


def _end(field: str, which: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        raise InputError(f"{field}, {which}", text, "not a finite number", "give one, as in 1e-3")
    return value


def read_value(field: str, text: str, kind: type) -> float | int | bool | str:
    """Return a value of an axis with the type of what it replaces.

    Args:
        field: for errors.
        text: as given.
        kind: float, int, bool or str.

    Raises:
        InputError: it is none, or not finite.
    """
    if kind is str:
        return text
    if kind is bool:
        if text.lower() not in ("true", "false"):
            raise InputError(field, text, "neither true nor false", "give true,false")
        return text.lower() == "true"
    try:
        value = float(text)
    except ValueError:
        raise InputError(field, text, "not a number", "give numbers") from None
    if not isfinite(value):
        raise InputError(field, text, "not a finite number", "give numbers, as in 1e-3")
    if kind is int:
        if not value.is_integer():
            raise InputError(
                field, text, "not a whole number", "give whole ones, as in 4,8,16 or 4:16:4"
            )
        return int(value)
    return value
