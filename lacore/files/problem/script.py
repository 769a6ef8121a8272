"""A problem of a file as the Python that makes the same one."""

from collections.abc import Sequence
from json import dumps
from math import isinf
from pathlib import Path
from typing import Any

from lacore.files.problem.calls import Call, Name

_WIDTH = 96


def told(node: Any, folder: Path, indent: int = 0, used: int = 0) -> str:
    """What calls make, as Python.

    Args:
        node: see `lacore.files.problem.calls.made`.
        folder: of the script, from which it finds files.
        indent: of the lines after the first.
        used: letters before it on the first.
    """
    match node:
        case Call():
            named = [(f"{name}=", own) for name, own in node.arguments.items()]
            return _listed(f"{node.maker}(", named, ")", folder, indent, used)
        case Name():
            return node.name
        case dict():
            pairs = [(f"{told(key, folder)}: ", own) for key, own in node.items()]
            return _listed("{", pairs, "}", folder, indent, used)
        case list():
            return _listed("[", [("", own) for own in node], "]", folder, indent, used)
        case tuple():
            end = ",)" if len(node) == 1 else ")"
            return _listed("(", [("", own) for own in node], end, folder, indent, used)
        case Path():
            return f"Path(__file__).parent / {dumps(way(node, folder))}"
        case float() if isinf(node):
            return f'float("{node}")'
        case str():
            return dumps(node, ensure_ascii=False)
    return repr(node)


def _listed(
    begin: str, items: Sequence[tuple[str, Any]], end: str, folder: Path, indent: int, used: int
) -> str:
    """On one line where there is room, else an item a line."""
    line = ", ".join(f"{head}{told(own, folder)}" for head, own in items)
    if indent + used + len(begin + line + end) < _WIDTH and "\n" not in line:
        return f"{begin}{line}{end}"
    deeper = indent + 4
    inner = [
        f"{' ' * deeper}{head}{told(own, folder, deeper, len(head))},\n" for head, own in items
    ]
    return f"{begin}\n{''.join(inner)}{' ' * indent}{end.lstrip(',')}"


def way(file: Path, folder: Path) -> str:
    """From a folder to a file, with / on every system."""
    place, start = file.resolve(), folder.resolve()
    for up, parent in enumerate((start, *start.parents)):
        if place.is_relative_to(parent):
            return "/".join([*[".."] * up, *place.relative_to(parent).parts])
    return place.as_posix()  # on another drive
