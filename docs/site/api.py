"""Pages of the API reference: public names grouped by package as in `lacore/__init__.pyi`."""

import ast
from collections.abc import Mapping
from importlib import import_module
from importlib.util import find_spec
from inspect import cleandoc
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import lacore as la
from pages import ROOT

_STUB = ROOT / "lacore" / "__init__.pyi"


def by_room() -> dict[str, list[str]]:
    """Return the public names by the package that defines them, in the order of the stub."""
    found: dict[str, list[str]] = {}
    for node in ast.parse(_STUB.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom):
            for alias in node.names:
                own = alias.name if isinstance(getattr(la, alias.name), ModuleType) else ""
                room = own or _room(node.module or alias.name)
                found.setdefault(room, []).append(alias.name)
    return found


def _room(module: str) -> str:
    """Return the package of a module: below `model` one of its parts, such as ``materials``."""
    first, *others = module.split(".")
    return others[0] if first == "model" else first


def pages() -> Mapping[str, str]:
    """Return one page per package, and one that leads to them."""
    rooms = by_room()
    found = {f"api/{room}.md": _page(room, names) for room, names in rooms.items()}
    said = "All public names by package. Examples assume `import lacore as la`"
    lines = ["# API reference", "", f"{said} and `import numpy as np`.", ""]
    for room, names in rooms.items():
        shown = ", ".join(f"{{any}}`{name} <lacore.{name}>`" for name in names)
        if isinstance(getattr(la, room, None), ModuleType) and names == [room]:
            shown = ", ".join(
                f"{{py:obj}}`{name} <lacore.{room}.{name}>`" for name in public(getattr(la, room))
            )
        lines += [f"[{_title(room)}]({room}.md)", f": {shown}", ""]
    lines += [":::{toctree}", ":hidden:", *rooms, ":::", ""]
    return found | {"api/index.md": "\n".join(lines)}


def public(module: ModuleType) -> list[str]:
    """Return the public names of a module: those in `__all__`, or else those defined in it."""
    listed = getattr(module, "__all__", None)
    own = (name for name, thing in vars(module).items() if _of(thing) == module.__name__)
    return list(listed) if listed else [name for name in own if not name.startswith("_")]


def _of(thing: object) -> str:
    return str(getattr(thing, "__module__", ""))


def _title(room: str) -> str:
    module = getattr(la, room, None)
    if isinstance(module, ModuleType) and room in dir(la):
        return f"la.{room}"
    return room


def _page(room: str, names: list[str]) -> str:
    lines = [f"# {_title(room)}", "", _first_line(room, names), "", "```{eval-rst}"]
    for name in names:
        thing = getattr(la, name)
        if isinstance(thing, ModuleType):
            lines += [f".. module:: lacore.{name}", ""]
            told = aliases() if thing is la.types else {}
            for own in public(thing):
                alias = told.get(own)
                lines += [alias or _directive(f"lacore.{name}.{own}", getattr(thing, own)), ""]
        else:
            lines += [_directive(f"lacore.{name}", thing), ""]
    return "\n".join([*lines, "```", ""])


def aliases() -> dict[str, str]:
    """Return definition and docstring of each name of `lacore.types`, as in its own file."""
    stated = ast.parse(Path(str(la.types.__file__)).read_text(encoding="utf-8")).body
    homes = {
        a.name: node.module
        for node in stated
        if isinstance(node, ast.ImportFrom)
        for a in node.names
    }
    return {name: _alias(name, str(homes[name])) for name in public(la.types)}


def _alias(name: str, home: str) -> str:
    body = ast.parse((ROOT / f"{home.replace('.', '/')}.py").read_text(encoding="utf-8")).body
    for node, after in pairwise(body):
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == name:
            if not (isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)):
                raise ValueError(f"{home}.{name} has no docstring")
            text = cleandoc(str(after.value.value)).replace("\n", "\n   ")
            stands = " ".join(ast.unparse(node.value).split())
            return f".. py:type:: {name}\n   :canonical: {stands}\n\n   {text}\n"
    raise ValueError(f"{home} has no {name}")


def _first_line(room: str, names: list[str]) -> str:
    thing = getattr(la, names[0])
    module = thing if isinstance(thing, ModuleType) else import_module(_package(room))
    return (module.__doc__ or "").strip().partition("\n\n")[0].replace("\n", " ")


def _package(room: str) -> str:
    inside = f"lacore.model.{room}"
    return inside if find_spec(inside) else f"lacore.{room}"


def _directive(name: str, thing: object) -> str:
    if isinstance(thing, type):
        return f".. autoclass:: {name}"
    return f".. autofunction:: {name}" if callable(thing) else f".. autodata:: {name}"
