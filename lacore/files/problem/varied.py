"""Varying number of a problem file, and the problem at each of its values."""

import re
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass, replace
from typing import Any

from lacore.files.problem.checking import checked
from lacore.files.problem.places import Path
from lacore.files.problem.reading import Stated, stated_by
from lacore.files.problem.source import Source, written
from lacore.model.problem.problem import Problem
from lacore.reporting.errors import InputError, suggest

_RANGE = re.compile(r"\s*(?P<name>[^=]+?)\s*=\s*(?P<low>[^:]+?)\s*:\s*(?P<high>[^:]+?)\s*")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?")
_AMOUNT = re.compile(rf"\s*{_NUMBER.pattern}\s*(?P<unit>.*?)\s*")
_WRITTEN = "write NAME=LOW:HIGH, such as arch.thickness='5 cm:20 cm', reference_loads[0].at[0]=0:6"


@dataclass(frozen=True)
class Varied:
    """Number of a file, and its range.

    Attributes:
        source: the file.
        path: path of the number in it.
        unit: SI unit of the range; ``deg`` for angles, empty without a unit.
        low, high: the range.
    """

    source: Source
    path: Path
    unit: str
    low: float
    high: float

    @property
    def name(self) -> str:
        """Name of the number: ``bodies.arch.thickness``."""
        return written(self.path)

    def stated(self, value: float) -> Stated:
        """Return the file with another value.

        Raises:
            InputError: the problem is invalid, with its line.
        """
        unit = f" {self.unit}" if self.unit else ""
        return stated_by(_with(self.source, self.path, f"{value!r}{unit}" if unit else value))

    def problem(self, value: float) -> Problem:
        """Return the problem for a value, see `stated`."""
        return self.stated(value).problem


def read_varied(source: Source, text: str, field: Path | str) -> Varied:
    """Return the number and the range of a text such as ``arch.thickness=5 cm:20 cm``.

    Args:
        source: the file that has the number. The end of its name in errors is sufficient if it is
            unique.
        text: with a unit for each end, one for both after the second, or none: then the range is in
            SI, with angles in degrees.
        field: origin of the text: a key of the file, or of the command line.

    Raises:
        InputError: no such number, no range, units that do not fit, or an invalid end.
    """
    match = _RANGE.fullmatch(text)
    if match is None:
        raise _error(source, field, text, "not a name and a range", _WRITTEN)
    path = _found(source, match["name"], text, field)
    low, high = match["low"], match["high"]
    last = _AMOUNT.fullmatch(high)
    if last is not None and last["unit"] and _NUMBER.fullmatch(low):
        low = f"{low} {last['unit']}"
    try:
        first, second = (_read(source, path, own) for own in (low, high))
    except InputError as error:
        if not isinstance(field, str):
            raise
        value = "" if error.value is None else f" = {error.value!r}"
        why = f"{error.field}{value}: {error.reason}"
        raise InputError(field, text, why, error.fix) from error
    if first[1] != second[1]:
        why = f"one end in {first[1] or 'no unit'}, the other in {second[1] or 'no unit'}"
        raise _error(source, field, text, why, "give both in units of one kind")
    if not first[0] < second[0]:
        raise _error(source, field, text, "LOW is not below HIGH", "give LOW:HIGH")
    return Varied(source, path, first[1], first[0], second[0])


def _found(source: Source, name: str, text: str, field: Path | str) -> Path:
    """Return the only number of a file whose name has this end."""
    known = {written(path): path for path in _numbers(source.data, ())}
    if name in known:
        return known[name]
    ends = [own for own in known if own.endswith(f".{name}")]
    if len(ends) == 1:
        return known[ends[0]]
    if ends:
        fix = f"write more of its name: {', '.join(sorted(ends)[:6])}"
        raise _error(source, field, text, f"{len(ends)} numbers of the file have this name", fix)
    fix = suggest(name, known)
    if not fix.endswith("?"):  # The end of the name may be meant.
        parts = {own[place:]: own for own in known for place in _ends(own)}
        close = suggest(name, parts)
        fix = close if close.endswith("?") else f"it has {', '.join(sorted(known)[:12])}"
    raise _error(source, field, text, "the file has no such number; a default value must be"
                 " written in the file to vary it", fix)  # fmt: skip


def _ends(name: str) -> Iterator[int]:
    yield from (place + 1 for place, letter in enumerate(name) if letter == ".")


def _numbers(own: Any, path: Path) -> Iterator[Path]:
    """Yield the paths of values that look like numbers, with or without a unit."""
    if isinstance(own, dict):
        for key, part in own.items():
            if path or key not in ("solve", "title"):
                yield from _numbers(part, (*path, key))
    elif isinstance(own, list):
        for place, part in enumerate(own):
            yield from _numbers(part, (*path, place))
    elif isinstance(own, str):
        if _AMOUNT.fullmatch(own) and not own.strip().isdigit():  # name of a block
            yield path
    elif isinstance(own, int | float) and not isinstance(own, bool):
        yield path


def _read(source: Source, path: Path, text: str) -> tuple[float, str]:
    """Return an end of a range as the value in the file, and its SI unit.

    Raises:
        InputError: the value is invalid there.
    """
    given: object = float(text) if _NUMBER.fullmatch(text) else text
    other = _with(source, path, given)
    _, amounts = checked(other)
    for one in amounts:
        if one.given is given:
            stated_by(other)
            return one.value, one.own
    why = "is a count or a choice, and cannot vary"
    raise source.error(path, None, why, "vary a length, an angle, a strength, a load, a ratio")


def _with(source: Source, path: Path, value: object) -> Source:
    data = deepcopy(dict(source.data))
    inside: Any = data
    for key in path[:-1]:
        inside = inside[key]
    inside[path[-1]] = value
    return replace(source, data=data)


def _error(source: Source, field: Path | str, text: str, why: str, fix: str) -> InputError:
    if isinstance(field, str):
        return InputError(field, text, why, fix)
    return source.error(field, text, why, fix)
