"""`read_problem`: from a TOML file to the problem that it states, without running any of it."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path as File
from typing import TYPE_CHECKING, Any

from lacore.errors import InputError, typed
from lacore.files.contents import contents
from lacore.files.problem.calls import Key, MisfitError, Program, entry, listed, parts
from lacore.files.problem.places import Path, lines
from lacore.files.problem.units import chosen
from lacore.files.problem.wording import in_words_of_files, value_of_files
from lacore.numerics.quantities import Units
from lacore.problem.problem import Problem

if TYPE_CHECKING:
    from lacore.files.problem.schema.document import Asked

_TWICE = re.compile(r"Cannot (mutate immutable namespace|overwrite a value).*")  # of tomllib


@dataclass(frozen=True)
class Stated:
    """What a problem file states.

    Attributes:
        source: of the file, to say where something stands.
        problem: the problem.
        program: what makes it.
        things: what it made before.
        title: of it; the name of the file, if it gives none.
        asked: what is to be found.
        cases: reference loads by the name of their case, as places in the list of the problem.
        units: that answers are told in.
    """

    source: Source
    problem: Problem
    program: Program
    things: Mapping[Key, Any]
    title: str
    asked: Asked
    cases: Mapping[str, Sequence[int]]
    units: Units

    @contextmanager
    def locating(self) -> Iterator[None]:
        """Say of what lacore refuses of the problem where it stands in the file."""
        try:
            yield
        except InputError as error:
            own = listed(self.program.call, self._inside(parts(error.field)), self.things)
            if not own and error.field.startswith("--"):
                raise  # of the command line
            raise self.source.error(own, error.value, error.why, error.mend) from error

    def _inside(self, path: Path) -> Path:
        """Where in the file is what an error of the problem is about."""
        if path[:1] == ("Problem",):
            return path[1:]
        kind = [where for where, own in self.problem.loads.items() if type(own).__name__ == path[0]]
        return (*parts(kind[0])[1:], *path[1:]) if len(kind) == 1 else ()


@typed()
def read_problem(path: str | PathLike[str]) -> Problem:
    """The problem that a TOML file states.

    Nothing in the file is run: it has numbers, names and units. Meshes that it names are found from
    its folder. See docs/guide/problem-file.md, and ``lacore new`` for files to begin with.

    Raises:
        InputError: no such file, no TOML, keys, values, units or names that cannot be right; it
            says the file, the line, the field, the value, and what to do.

    Example:
        >>> la.write_problem(la.examples.beam(), "beam.toml", title="A beam")
        >>> list(la.read_problem("beam.toml").bodies)
        ['beam']
    """
    return read(path).problem


def read(path: str | PathLike[str]) -> Stated:
    """As `read_problem`, with what else is in the file."""
    return stated_by(Source.of(File(fspath(path))))


def stated_by(source: Source) -> Stated:
    """What a file states that has been read; errors as of `read_problem`."""
    from lacore.files.problem.checking import checked  # here: pydantic takes a while to load

    stated, amounts = checked(source)
    try:
        program = stated.program()
        problem, things = program.made()
    except MisfitError as misfit:
        error = misfit.error
        raise source.error(misfit.at, error.value, error.why, error.mend) from error
    title = stated.title or source.file.stem
    cases: dict[str, list[int]] = {}
    nodes = program.call.arguments["reference_loads"]
    for place in range(len(problem.reference_loads)):
        case = stated.reference_loads[entry(nodes, place, things)].case
        if case is not None:
            cases.setdefault(case, []).append(place)
    units = chosen(amounts, problem.sizes, stated.solve.units.given)
    return Stated(source, problem, program, things, title, stated.solve, cases, units)


@dataclass(frozen=True)
class Source:
    """A problem file as it is written.

    Attributes:
        file: its path.
        data: its tables.
        lines: of all that is in it, see `lacore.files.problem.places.lines`.
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
        raw = contents(file)
        try:
            text = raw.decode("utf-8-sig")  # editors of Windows put a mark before it
            data = tomllib.loads(text)
        except UnicodeDecodeError as error:
            line = raw.count(b"\n", 0, error.start) + 1
            mend = "save it as UTF-8"
            raise InputError(f"{shown}:{line}", None, "is not text in UTF-8", mend) from error
        except tomllib.TOMLDecodeError as error:
            raise _no_toml(shown, text, error) from error
        except RecursionError as error:
            raise InputError(
                shown, None, "brackets are nested too deeply", "remove some"
            ) from error
        return cls(file, data, lines(text))

    def error(self, path: Path, value: object, why: str, mend: str) -> InputError:
        """An error of what is at a path, or of the nearest thing around it that is there."""
        there, own = self._nearest(path)
        if own is not None and not isinstance(own, dict | list):
            value = own
        shown = value_of_files(value)
        field = written(there if there else path[:1])
        return InputError(
            f"{self.file}:{self.line(path)}: {field}".rstrip(": "),
            None if shown == [] else shown,
            in_words_of_files(why),
            in_words_of_files(mend),
        )

    def line(self, path: Path) -> int:
        """Where a path, or the nearest thing around it that is there, is written."""
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
    """Whether a table, or a list, of a file has a key."""
    listed = isinstance(table, list) and isinstance(key, int) and key < len(table)
    return listed or (isinstance(table, dict) and key in table)


def written(path: Path) -> str:
    """``bodies.arch.thickness``, ``reference_loads[0].at``."""
    text = ""
    for key in path:
        if isinstance(key, int):
            text += f"[{key}]"
        else:
            plain = key.replace("_", "a").replace("-", "a").isalnum()
            text += f".{key}" if plain else f".{key!r}"
    return text.lstrip(".")


def _no_toml(shown: str, text: str, error: tomllib.TOMLDecodeError) -> InputError:
    """With the line at the front, as all others."""
    why, _, rest = str(error).partition(" (at ")
    numbers = [int(word) for word in rest.rstrip(")").replace(",", "").split() if word.isdigit()]
    line = numbers[0] if numbers else text.count("\n") + 1
    found = text.splitlines()[line - 1 : line]
    value = found[0].strip() if found else None
    mend = "write key = value, tables as [name], and texts and numbers with units in quotes"
    why = _TWICE.sub("a key is given twice", why)
    said = f"is not valid TOML: {why[:1].lower()}{why[1:]}"
    return InputError(f"{shown}:{line}: line", value, said, mend)
