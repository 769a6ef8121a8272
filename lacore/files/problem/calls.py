"""What a problem file makes: calls of lacore, to be carried out or told as Python.

The two cannot differ: the script beside an answer says what was done. Only functions of `MAKERS`
are called, with numbers, texts and each other as arguments.
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
"""Of things that several calls take: ``("facade",)``, ``("facade", "drawing")``."""


PROBLEM: Key = ("", "problem")
"""Of the problem itself, for what is made of it."""


@dataclass(frozen=True)
class Name:
    """One of `NAMES`."""

    name: str


@dataclass(frozen=True)
class Call:
    """A function of lacore with its arguments.

    Attributes:
        maker: one of `MAKERS`.
        arguments: by name; numbers, texts, paths of files, calls, and tuples, lists and dicts of
            them.
        at: what of the file says it.
        places: what of the file says an argument, where it is not called like it.
    """

    maker: str
    arguments: Mapping[str, Any]
    at: Path
    places: Mapping[str, Path] = field(default_factory=dict)


@dataclass(frozen=True)
class Own:
    """A thing that was made before: itself, what it has, or what it says to arguments.

    Attributes:
        thing: its key.
        name: of what it has, or of a method of it; empty: itself.
        arguments: of the method; None: it is no method.
        at: what of the file says it.
        entry: the entry of the file that names the body that the thing is of.
        unless: why and fix, where that body has no such thing.
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
    """Things that have names, and the call that takes them.

    Attributes:
        things: each may take those before it.
        call: what all is for.
        path: what follows it along a path, if the file states one.
    """

    things: Mapping[Key, Any]
    call: Call
    path: Call | None = None

    def made(self) -> tuple[Any, Mapping[Key, Any]]:
        """What the call makes, and the things.

        Raises:
            MisfitError: lacore refuses some of them, or bodies overlap.
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
    """What is made of a file; what lacore refuses is kept, and all that does not need it is made.

    Attributes:
        things: what was made, by key.
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
        """Yield what a node makes: nothing where it, or what it needs, is wrong."""
        if any(own.thing not in self.things for own in owned(node)):
            return
        try:
            yield made(node, self.things)
        except MisfitError as misfit:
            self.wrong += misfit.found


class MisfitError(Exception):
    """What lacore refuses of a file: errors, each with the place in the file that it is about."""

    def __init__(self, *found: tuple[InputError, Path]) -> None:
        self.found = found
        super().__init__("; ".join(str(error) for error, _ in found))


def made(node: Any, things: Mapping[Key, Any] = {}) -> Any:
    """What calls make.

    Args:
        node: a call, a thing, a list or table of them, or what is no call.
        things: that were made before.

    Raises:
        MisfitError: lacore refuses one of them.
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
    """What calls take of things that were made before."""
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
    """Which entry of a list in the file made an entry of the list that came of it."""
    before = 0
    for number, node in enumerate(nodes):
        before += len(things[node.of.thing]) if isinstance(node, Spread) else 1
        if place < before:
            return number
    return place


def origin(mesh: object) -> Call | None:
    """The call that a mesh was made by; None of others."""
    call: Call | None = getattr(mesh, _ORIGIN, None)
    return call


def _noted(thing: Any, call: Call) -> Any:
    """A thing; a mesh that knows what it was made by, until scikit-fem makes another of it."""
    if call.maker in _MESHES:
        object.__setattr__(thing, _ORIGIN, call)
    return thing


def parts(text: str) -> Path:
    """``Problem.bodies['a'].mesh`` as a path, without its first name: ``("bodies", "a", "mesh")``.

    Numbers in brackets are places of a list, all else names.
    """
    found: list[str | int] = []
    rest = text.partition(" ")[0]  # of "field = value, coordinates" the field
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
    """Where an argument of a call that an error names is in the file."""
    first, *_ = path = parts(text)
    own = path[1:] if first not in call.arguments and len(path) > 1 else path
    own = listed(call, own, things)
    if own[0] in call.places:
        return (*call.places[str(own[0])], *own[1:])
    return (*call.at, *own) if own[0] in call.arguments else call.at


def listed(call: Call, path: Path, things: Mapping[Key, Any]) -> Path:
    """A path into the arguments of a call, with the entry of its list as the file counts them."""
    match path:
        case (str(name), int(place), *rest) if isinstance(call.arguments.get(name), list):
            return (name, entry(call.arguments[name], place, things), *rest)
    return path
