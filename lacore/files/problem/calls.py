"""Calls of lacore for a problem file, executed or written as Python.

Both use the same calls, so the script of a result always matches it. Only functions of `MAKERS` are
called, with numbers, texts and each other as arguments.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import Any

from lacore.files.problem.apart import require_apart
from lacore.files.problem.makers import MAKERS, NAMES
from lacore.files.problem.places import Path
from lacore.reporting.errors import InputError

_MESHES = {
    *("la.meshes.rectangle", "la.meshes.quadrilaterals", "la.meshes.fan"),
    *("la.meshes.quarter_ring", "la.meshes.patches", "la.meshes.layered", "la.meshes.named"),
    *("la.meshes.read", "la.meshes.load"),
}
_ORIGIN = "_lacore_origin"

Key = tuple[str, ...]
"""Key of something that several calls use: ``("facade",)``, ``("facade", "drawing")``."""


PROBLEM: Key = ("", "problem")
"""Key of the problem, for calls that use it."""


@dataclass(frozen=True)
class Name:
    """One of `NAMES`."""

    name: str


@dataclass(frozen=True)
class Call:
    """A function of lacore with its arguments.

    Attributes:
        maker: one of `MAKERS`.
        arguments: arguments by name; numbers, texts, paths of files, calls, and tuples, lists and
            dicts of
            them.
        at: its path in the file.
        places: paths in the file of arguments whose key differs from their name.
    """

    maker: str
    arguments: Mapping[str, Any]
    at: Path
    places: Mapping[str, Path] = field(default_factory=dict)


@dataclass(frozen=True)
class Own:
    """Use of something made before: itself, an attribute, or the result of a method.

    Attributes:
        thing: its key.
        name: name of an attribute or method; empty: itself.
        arguments: arguments of the method; None: it is not a method.
        at: its path in the file.
        entry: entry of the file that names the body.
        unless: reason and fix, if that body has no such thing.
    """

    thing: Key
    name: str = ""
    arguments: Mapping[str, Any] | None = None
    at: Path = ()
    entry: Path = ()
    unless: tuple[str, str] = ("", "")


@dataclass(frozen=True)
class Spread:
    """All entries of a list that was made before, in another list."""

    of: Own


@dataclass(frozen=True)
class Program:
    """Named things, and the call that uses them.

    Attributes:
        things: each may use those before it.
        call: the final call.
        path: the call of a path of the problem, if the file has one.
    """

    things: Mapping[Key, Any]
    call: Call
    path: Call | None = None

    def made(self) -> tuple[Any, Mapping[Key, Any]]:
        """Return the result of the call, and the things.

        Raises:
            MisfitError: lacore rejects some of them, or bodies overlap.
        """
        making = _Making()
        for key, node in self.things.items():
            making.add(key, node)
        arguments = {name: making.parts(node) for name, node in self.call.arguments.items()}
        if making.wrong:
            raise MisfitError(*making.wrong)
        try:
            require_apart(arguments["bodies"])
        except InputError as error:
            raise MisfitError((error, parts(error.field))) from error
        return _called(self.call, arguments, making.things), making.things


@dataclass
class _Making:
    """Results of calls; errors are collected, and everything that does not depend on them is made.

    Attributes:
        things: results by key.
        wrong: errors, each with its place in the file.
    """

    things: dict[Key, Any] = field(default_factory=dict)
    wrong: list[tuple[InputError, Path]] = field(default_factory=list)

    def add(self, key: Key, node: Any) -> None:
        """Make a thing that others may need."""
        for own in self._made(node):
            self.things[key] = own

    def parts(self, node: Any) -> Any:
        """Make an argument of the whole, its entries one by one."""
        match node:
            case dict():
                return {name: own for name, entry in node.items() for own in self._made(entry)}
            case list():
                return [own for entry in node for some in self._made([entry]) for own in some]
        return next(self._made(node), None)

    def _made(self, node: Any) -> Iterator[Any]:
        """Yield the result of a node; nothing if it, or one of its arguments, is wrong."""
        if any(own.thing not in self.things for own in owned(node)):
            return
        try:
            yield made(node, self.things)
        except MisfitError as misfit:
            self.wrong += misfit.found


class MisfitError(Exception):
    """Errors of lacore for a file, each with its place in the file."""

    def __init__(self, *found: tuple[InputError, Path]) -> None:
        self.found = found
        super().__init__("; ".join(str(error) for error, _ in found))


def made(node: Any, things: Mapping[Key, Any] = {}) -> Any:
    """Return the result of calls.

    Args:
        node: a call, a thing, a list or table of them, or a plain value.
        things: things that were made before.

    Raises:
        MisfitError: lacore rejects one of them.
    """
    match node:
        case Call():
            arguments = {name: made(own, things) for name, own in node.arguments.items()}
            return _called(node, arguments, things)
        case Name():
            return NAMES[node.name]
        case Own():
            return _own(node, things)
        case tuple() | list():
            return type(node)(_entries(node, things))
        case dict():
            return {name: made(own, things) for name, own in node.items()}
    return node


def _called(call: Call, arguments: Mapping[str, Any], things: Mapping[Key, Any]) -> Any:
    try:
        return _noted(MAKERS[call.maker](**arguments), call)
    except InputError as error:
        raise MisfitError((error, _place(call, error.field, things))) from error


def _entries(nodes: Sequence[Any], things: Mapping[Key, Any]) -> Iterator[Any]:
    for node in nodes:
        if isinstance(node, Spread):
            yield from things[node.of.thing]
        else:
            yield made(node, things)


def _own(node: Own, things: Mapping[Key, Any]) -> Any:
    thing = things[node.thing]
    found = getattr(thing, node.name) if node.name else thing
    if node.arguments is None:
        return found
    try:
        return found(**made(dict(node.arguments), things))
    except InputError as error:
        named = error.field in node.arguments and error.field != node.at[-1]
        at = (*node.entry, error.field) if named else node.at
        raise MisfitError((error, at)) from error


def owned(node: Any) -> Iterator[Own]:
    """Yield the things made before that calls use."""
    match node:
        case Own():
            yield node
            yield from owned(node.arguments)
        case Spread():
            yield from owned(node.of)
        case Call():
            yield from owned(node.arguments)
        case tuple() | list():
            yield from chain.from_iterable(map(owned, node))
        case dict():
            yield from owned([*node.values()])


def entry(nodes: Sequence[Any], place: int, things: Mapping[Key, Any]) -> int:
    """Return the entry of a list in the file that made an entry of the resulting list."""
    before = 0
    for number, node in enumerate(nodes):
        before += len(things[node.of.thing]) if isinstance(node, Spread) else 1
        if place < before:
            return number
    return place


def origin(mesh: object) -> Call | None:
    """Return the call that a mesh was made by; None for other objects."""
    call: Call | None = getattr(mesh, _ORIGIN, None)
    return call


def _noted(thing: Any, call: Call) -> Any:
    """Return a thing; a mesh with the call that made it, which copies by scikit-fem lose."""
    if call.maker in _MESHES:
        object.__setattr__(thing, _ORIGIN, call)
    return thing


def parts(text: str) -> Path:
    """Return ``Problem.bodies['a'].mesh`` as a path without its first name.

    ``("bodies", "a", "mesh")``.

    Numbers in brackets are places of a list, all else names.
    """
    found: list[str | int] = []
    rest = text.partition(" ")[0]  # The field is the first word of "field = value, coordinates".
    while rest:
        if rest[0] == "[":
            inside, _, rest = rest[1:].partition("]")
            found.append(int(inside) if inside.isdigit() else inside.strip("'\""))
        elif rest[0] == ".":
            rest = rest[1:]
        else:
            end = next((n for n, letter in enumerate(rest) if letter in ".["), len(rest))
            found.append(rest[:end])
            rest = rest[end:]
    return tuple(found)


def _place(call: Call, text: str, things: Mapping[Key, Any]) -> Path:
    """Return the place in the file of an argument of a call that an error names."""
    first, *_ = path = parts(text)
    own = path[1:] if first not in call.arguments and len(path) > 1 else path
    own = listed(call, own, things)
    if own[0] in call.places:
        return (*call.places[str(own[0])], *own[1:])
    return (*call.at, *own) if own[0] in call.arguments else call.at


def listed(call: Call, path: Path, things: Mapping[Key, Any]) -> Path:
    """Return a path into the arguments of a call, with list entries as counted in the file."""
    match path:
        case (str(name), int(place), *rest) if isinstance(call.arguments.get(name), list):
            return (name, entry(call.arguments[name], place, things), *rest)
    return path
