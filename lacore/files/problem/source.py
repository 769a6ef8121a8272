"""Source of a problem file, and errors with the line that they are about."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from numbers import Real
from pathlib import Path as File
from typing import Any

from lacore.files.problem.places import Path, lines
from lacore.files.problem.statements import plain
from lacore.reporting.errors import InputError, MultipleInputError
from lacore.reporting.text import Reader, render
from lacore.reporting.units import Units

_ENDING = ".toml"
_START = "`lacore new` prints problem files to start from"
_LARGEST = 10_000_000  # bytes

# messages of tomllib
_TWICE = re.compile(r"Cannot (mutate immutable namespace|overwrite a value).*")


@dataclass(frozen=True)
class Source:
    """Source of a problem file.

    Attributes:
        file: its path.
        data: its tables.
        lines: lines of its contents, see `lacore.files.problem.places.lines`.
    """

    file: File
    data: Mapping[str, Any]
    lines: Mapping[Path, int]

    @classmethod
    def of(cls, file: File) -> Source:
        """Read a file.

        Raises:
            InputError: it cannot be read, or is no TOML.
        """
        shown = str(file)
        raw = _contents(file)
        try:
            text = raw.decode("utf-8-sig")  # Editors on Windows add a mark before the text.
            data = tomllib.loads(text)
        except UnicodeDecodeError as error:
            line = raw.count(b"\n", 0, error.start) + 1
            fix = "save it as UTF-8"
            raise InputError(f"{shown}:{line}", None, "is not text in UTF-8", fix) from error
        except tomllib.TOMLDecodeError as error:
            raise _no_toml(shown, text, error) from error
        except RecursionError as error:
            raise InputError(
                shown, None, "brackets are nested too deeply", "remove some"
            ) from error
        return cls(file, data, lines(text))

    def error(
        self, path: Path, value: object, reason: str, fix: str, units: Units | None = None
    ) -> InputError:
        """Return an error of the value at a path, or of the nearest value around it.

        Args:
            path: Where the value is.
            value: The value, if it is not in the file.
            reason: Why it is wrong.
            fix: How to fix it.
            units: Units of the quantities in the message; None: SI.
        """
        reader = Reader(units, files=True)
        there, own = self._nearest(path)
        if own is not None and not isinstance(own, dict | list):
            value = own
        shown = _shown(render(value, reader) if isinstance(value, str) else value)
        field = written(there if there else path[:1])
        return InputError(
            f"{self.file}:{self.line(path)}: {field}".rstrip(": "),
            None if shown == [] else shown,
            render(reason, reader),
            render(fix, reader),
        )

    def errors(self, found: Sequence[tuple[Path, InputError]]) -> InputError:
        """Return errors of the values at some paths as one, in the order of the lines."""
        ordered = sorted(found, key=lambda own: self.line(own[0]))
        unlike = [*{str(error): error for _, error in ordered}.values()]
        return unlike[0] if len(unlike) == 1 else MultipleInputError(*unlike)

    def line(self, path: Path) -> int:
        """Return the line of a path, or of the nearest existing entry around it."""
        known = (path[:n] for n in range(len(path), 0, -1) if path[:n] in self.lines)
        return next((self.lines[own] for own in known), 1)

    def _nearest(self, path: Path) -> tuple[Path, Any]:
        own: Any = self.data
        for place, key in enumerate(path):
            if not has(own, key):
                return path[:place], own
            own = own[key]
        return path, own


def has(table: Any, key: str | int) -> bool:
    """Return whether a table, or a list, of a file has a key."""
    listed = isinstance(table, list) and isinstance(key, int) and key < len(table)
    return listed or (isinstance(table, dict) and key in table)


def written(path: Path) -> str:
    """Return a path as text: ``bodies.arch.thickness``, ``reference_loads[0].at``."""
    text = ""
    for key in path:
        if isinstance(key, int):
            text += f"[{key}]"
        else:
            plain = key.replace("_", "a").replace("-", "a").isalnum()
            text += f".{key}" if plain else f".{key!r}"
    return text.lstrip(".")


def _no_toml(shown: str, text: str, error: tomllib.TOMLDecodeError) -> InputError:
    """Return the error with the line at the front, as in all others."""
    why, _, rest = str(error).partition(" (at ")
    numbers = [int(word) for word in rest.rstrip(")").replace(",", "").split() if word.isdigit()]
    line = numbers[0] if numbers else text.count("\n") + 1
    found = text.splitlines()[line - 1 : line]
    value = found[0].strip() if found else None
    fix = "write key = value, tables as [name], and texts and numbers with units in quotes"
    why = _TWICE.sub("a key is given twice", why)
    said = f"is not valid TOML: {why[:1].lower()}{why[1:]}"
    return InputError(f"{shown}:{line}: line", value, said, fix)


def _shown(value: Any) -> Any:
    """Return a value in the notation of files, and None for a value that no file contains."""
    if isinstance(value, str | bool | None):
        return value
    if isinstance(value, Real):
        return plain(value)
    if isinstance(value, list | tuple):
        inner = [_shown(own) for own in value]
        return None if None in inner else inner
    return None


def _contents(file: File) -> bytes:
    """Read a problem file.

    Raises:
        InputError: The path is not that of a file, or the file is empty, too large or unreadable.
    """
    shown = str(file)
    try:
        raw = file.read_bytes() if file.stat().st_size <= _LARGEST else None
    except IsADirectoryError as error:
        raise InputError("path", shown, "is a folder, not a file", _inside(file)) from error
    except FileNotFoundError as error:
        raise InputError("path", shown, "there is no such file", _similar(file)) from error
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        why = getattr(error, "strerror", None) or str(error)
        fix = "give the path of a problem file"
        raise InputError("path", shown, f"cannot be read ({why})", fix) from error
    if raw is None:
        limit = f"is larger than {_LARGEST / 1e6:g} MB"
        raise InputError("path", shown, limit, "give the path of a problem file")
    if not raw.strip():
        raise InputError("path", shown, "is empty", _START)
    return raw


def _inside(folder: File) -> str:
    found = _files(folder)
    return f"did you mean {str(found[0])!r}?" if found else "give the path of a problem file"


def _similar(file: File) -> str:
    """Return how to fix the path of a missing file."""
    names = {own.stem: own for own in _files(file.parent)}
    close = get_close_matches(file.stem, names, n=1)
    if close:
        return f"did you mean {str(names[close[0]])!r}?"
    return f"give the path of a problem file; {_START}"


def _files(folder: File) -> list[File]:
    try:
        return sorted(own for own in folder.iterdir() if own.suffix == _ENDING and own.is_file())
    except OSError:
        return []
