"""`read_problem`: read a problem from a TOML file, without running any code of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path as File
from typing import TYPE_CHECKING, Any

from lacore.files.problem.calls import (
    PROBLEM,
    Key,
    MisfitError,
    Program,
    entry,
    listed,
    made,
    parts,
)
from lacore.files.problem.places import Path
from lacore.files.problem.source import Source
from lacore.files.problem.units import chosen
from lacore.model.problem.problem import Problem
from lacore.paths.path import Path as FollowedPath
from lacore.paths.sequential import sequential
from lacore.reporting.errors import InputError, typed
from lacore.reporting.units import Units

if TYPE_CHECKING:
    from lacore.files.problem.schema.document import Asked


@dataclass(frozen=True)
class Stated:
    """Contents of a problem file.

    Attributes:
        source: source of the file, for the places of errors.
        problem: the problem.
        program: calls that make it.
        things: things that were made for it.
        title: its title, or the name of the file.
        asked: the requested results.
        cases: reference loads by the name of their case, as places in the list of the problem.
        units: units of results.
        path: arguments of `lacore.sequential`, if the file has a path.
        animated: whether an animation of it is requested.
    """

    source: Source
    problem: Problem
    program: Program
    things: Mapping[Key, Any]
    title: str
    asked: Asked
    cases: Mapping[str, Sequence[int]]
    units: Units
    path: Mapping[str, Any] | None = None
    animated: bool = False

    def followed(self, **more: Any) -> FollowedPath:
        """Return the path of the file, see `lacore.sequential`; the file must have one.

        Args:
            more: arguments that are not in the file.

        Raises:
            InputError: the path cannot be followed, with its line in the file.
        """
        assert self.path is not None
        with self.locating():
            return sequential(**self.path, **more)

    @contextmanager
    def locating(self) -> Iterator[None]:
        """Add the place in the file to errors of the problem."""
        try:
            yield
        except InputError as error:
            own = listed(self.program.call, self._inside(parts(error.field)), self.things)
            if not own and error.field.startswith("--"):
                raise  # errors of the command line
            value = None if error.field == "control" else error.value  # a Python class
            raise self.source.error(own, value, error.reason, error.fix, self.units) from error

    def _inside(self, path: Path) -> Path:
        """Return the path in the file of an error of the problem."""
        if path[:1] == ("Problem",):
            return path[1:]
        if self.program.path is not None:
            if path[0] in ("backend", "coupling"):
                return ("solve", *path)
            if path[0] == "tools":
                return path
            if path[0] == "control" or path[0] in self.program.path.arguments:
                return ("path", *listed(self.program.path, path, self.things))
            if str(path[0]).endswith("Travel"):
                return ("path", "control", *path[1:])
        kind = [where for where, own in self.problem.loads.items() if type(own).__name__ == path[0]]
        return (*parts(kind[0])[1:], *path[1:]) if len(kind) == 1 else ()


@typed()
def read_problem(path: str | PathLike[str]) -> Problem:
    """Read a problem from a TOML file.

    No code in the file is run: it contains numbers, names and units. Paths of meshes are relative
    to its folder. See docs/guide/problem-file.md, and ``lacore new`` for example files.

    Raises:
        InputError: no such file, invalid TOML, or invalid keys, values, units or names; it states
            the file, the line, the field, the value, and the fix.

    Example:
        >>> la.write_problem(la.examples.beam(), "beam.toml", title="A beam")
        >>> list(la.read_problem("beam.toml").bodies)
        ['beam']
    """
    return read(path).problem


def read(path: str | PathLike[str]) -> Stated:
    """Read a file as `read_problem`, with all of its other contents."""
    return stated_by(Source.of(File(fspath(path))))


def stated_by(source: Source) -> Stated:
    """Return the contents of a file that has been read; raises errors as `read_problem`."""
    # imported here because pydantic takes a while to load
    from lacore.files.problem.checking import checked

    stated, amounts = checked(source)
    asked = stated.solve.units.given
    try:
        program = stated.program()
        problem, things = program.made()
        path = None
        if program.path is not None:
            path = made(dict(program.path.arguments), {**things, PROBLEM: problem})
    except MisfitError as misfit:
        units = chosen(amounts, [], asked)
        found = [
            (at, source.error(at, error.value, error.reason, error.fix, units))
            for error, at in misfit.found
        ]
        raise source.errors(found) from misfit
    title = stated.title or source.file.stem
    cases: dict[str, list[int]] = {}
    nodes = program.call.arguments.get("reference_loads", [])
    for place in range(len(problem.reference_loads)):
        case = stated.reference_loads[entry(nodes, place, things)].case
        if case is not None:
            cases.setdefault(case, []).append(place)
    units = chosen(amounts, problem.sizes, asked)
    animated = stated.path is not None and stated.path.animation
    return Stated(
        source, problem, program, things, title, stated.solve, cases, units, path, animated
    )
