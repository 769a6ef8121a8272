"""Python script for the problem of a file."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from json import dumps
from keyword import iskeyword
from math import isinf
from pathlib import Path
from typing import Any

from lacore.files.problem.calls import PROBLEM, Call, Key, Name, Own, Program, Spread

_WIDTH = 96
_TAKEN = ("la", "Path", "problem", "state", "path")  # used in scripts for other objects


def script(program: Program, folder: Path) -> str:
    """Return the Python lines that make a problem, ending with ``problem = ...``.

    Args:
        program: calls of the problem.
        folder: folder of the script, to which paths are relative.
    """
    writer = _Writer(folder, {**_variables(program.things), PROBLEM: "problem"})
    lines = [(writer.variables[key], node) for key, node in program.things.items()]
    lines.append(("problem", program.call))
    return "".join(f"{name} = {writer.told(node, 0, len(name) + 3)}\n" for name, node in lines)


def path_script(program: Program, folder: Path, more: Mapping[str, Any]) -> str:
    """Return the Python lines for the path after the problem of a `script`: ``path = ...``.

    Args:
        program: program with a path.
        folder: folder of the script.
        more: arguments that are not in the file.
    """
    assert program.path is not None
    writer = _Writer(folder, {**_variables(program.things), PROBLEM: "problem"})
    call = replace(program.path, arguments={**program.path.arguments, **more})
    return f"path = {writer.told(call, 0, len('path = '))}\n"


def _variables(keys: Iterable[Key]) -> dict[Key, str]:
    """Return a Python name for each thing."""
    found: dict[Key, str] = {}
    for key in keys:
        plain = re.sub(r"\W", "_", "_".join(key))
        if not plain.isidentifier() or iskeyword(plain):
            plain = f"body_{plain}"
        while plain in _TAKEN or plain in found.values():
            plain += "_"
        found[key] = plain
    return found


@dataclass(frozen=True)
class _Writer:
    """Calls as Python.

    Attributes:
        folder: folder of the script.
        variables: names of things.
    """

    folder: Path
    variables: Mapping[Key, str]

    def told(self, node: Any, indent: int = 0, used: int = 0) -> str:
        """Return calls as Python.

        Args:
            node: see `lacore.files.problem.calls.made`.
            indent: indentation of the lines after the first.
            used: number of letters before it on the first line.
        """
        match node:
            case Call():
                return self._called(node.maker, node.arguments, indent, used)
            case Own():
                name = ".".join(filter(None, (self.variables[node.thing], node.name)))
                if node.arguments is None:
                    return name
                return self._called(name, node.arguments, indent, used)
            case Spread():
                return f"*{self.variables[node.of.thing]}"
            case Name():
                return node.name
            case dict():
                pairs = [(f"{self.told(key)}: ", own) for key, own in node.items()]
                return self._listed("{", pairs, "}", indent, used)
            case list():
                return self._listed("[", [("", own) for own in node], "]", indent, used)
            case tuple():
                end = ",)" if len(node) == 1 else ")"
                return self._listed("(", [("", own) for own in node], end, indent, used)
            case Path():
                return f"Path(__file__).parent / {dumps(way(node, self.folder))}"
            case float() if isinf(node):
                return f'float("{node}")'
            case str():
                return dumps(node, ensure_ascii=False)
        return repr(node)

    def _called(self, name: str, arguments: Mapping[str, Any], indent: int, used: int) -> str:
        given = [(f"{key}=", own) for key, own in arguments.items()]
        return self._listed(f"{name}(", given, ")", indent, used)

    def _listed(
        self, begin: str, items: Sequence[tuple[str, Any]], end: str, indent: int, used: int
    ) -> str:
        """Return items on one line if they fit, else one item per line."""
        line = ", ".join(f"{head}{self.told(own)}" for head, own in items)
        if indent + used + len(begin + line + end) < _WIDTH and "\n" not in line:
            return f"{begin}{line}{end}"
        deeper = indent + 4
        inner = [
            f"{' ' * deeper}{head}{self.told(own, deeper, len(head))},\n" for head, own in items
        ]
        return f"{begin}\n{''.join(inner)}{' ' * indent}{end.lstrip(',')}"


def way(file: Path, folder: Path) -> str:
    """Return the path from a folder to a file, with / on every system."""
    place, start = file.resolve(), folder.resolve()
    for up, parent in enumerate((start, *start.parents)):
        if place.is_relative_to(parent):
            return "/".join([*[".."] * up, *place.relative_to(parent).parts])
    return place.as_posix()  # on another drive
