"""`write_problem`: write a problem as an equivalent TOML file."""

from __future__ import annotations

from collections.abc import Mapping
from functools import singledispatch
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit
from tomlkit.items import Item

from lacore.files.problem import statements
from lacore.files.problem.calls import Call, made, origin
from lacore.files.problem.script import way
from lacore.files.problem.statements import Table, plain
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.frames.frame import Frame
from lacore.model.meshes.archive import save
from lacore.model.problem.problem import Problem
from lacore.reporting.errors import InputError, typed

_SHAPES: Mapping[str, str] = {
    "la.meshes.rectangle": "rectangle",
    "la.meshes.quadrilaterals": "quadrilaterals",
    "la.meshes.fan": "fan",
    "la.meshes.quarter_ring": "quarter-ring",
    "la.meshes.patches": "patches",
    "la.meshes.layered": "layered",
}
_FILES = ("la.meshes.read", "la.meshes.load")

_WIDTH = 90


@typed()
def write_problem(problem: Problem, path: str | PathLike[str], title: str = "") -> None:
    """Write a problem as TOML in SI units, such that `read_problem` returns an equivalent one.

    Meshes from a problem file are written as given there, others in files next to it,
    ``NAME-1.npz``, ... Walls, arches and drawings are written as polygons.

    Args:
        problem: problem whose boundaries are names, or places by numbers: `lacore.Within`,
            `lacore.Along`, `lacore.Beyond`.
        path: path of the file, ending in .toml.
        title: title of the page of its results.

    Raises:
        InputError: a feature that files do not support: functions of places, laws of hardening,
            user-defined criteria and obstacles, three-dimensional bodies; or a file that cannot be
            written.

    Example:
        >>> la.write_problem(la.examples.column(friction=0.3), "column.toml")
        >>> round(la.solve(la.read_problem("column.toml")).load_factor, 3)
        0.3
    """
    place = Path(fspath(path))
    if place.suffix.lower() != ".toml":
        raise InputError("path", str(place), "not the name of a TOML file", "use the ending .toml")
    document: Table = {"title": title} if title else {}
    meshes: dict[Path, Any] = {}
    document["bodies"] = {
        name: _stated(body, f"Problem.bodies[{name!r}]", place.with_name(f"{place.stem}-{n}.npz"),
                      meshes)
        for n, (name, body) in enumerate(problem.bodies.items(), 1)
    }  # fmt: skip
    lists = {
        "supports": [*map(statements.support, *_with_fields("supports", problem.supports))],
        "interfaces": [*map(statements.interface, *_with_fields("interfaces", problem.interfaces))],
        **{
            name: [*map(statements.tagged, *_with_fields(name, getattr(problem, name)))]
            for name in ("reference_loads", "dead_loads")
        },
    }
    document |= {name: own for name, own in lists.items() if own}
    try:
        for file, mesh in meshes.items():
            save(mesh, file)
        place.write_text(toml(document), encoding="utf-8")
    except OSError as error:
        why = f"cannot be written ({error.strerror or error})"
        raise InputError("path", str(place), why, "free space, or name another place") from error


def _with_fields(name: str, things: Any) -> tuple[Any, list[str]]:
    return things, [f"Problem.{name}[{n}]" for n in range(len(things))]


@singledispatch
def _stated(body: Any, field: str, file: Path, meshes: dict[Path, Any]) -> Table:
    """Return the table of a body; a mesh that needs a file is added to `meshes`."""
    return statements.other(body, field)


@_stated.register
def _(body: BlockAssembly, field: str, file: Path, meshes: dict[Path, Any]) -> Table:
    return statements.blocks(body)


@_stated.register
def _(body: Frame, field: str, file: Path, meshes: dict[Path, Any]) -> Table:
    return statements.frame(body)


@_stated.register
def _(body: Body, field: str, file: Path, meshes: dict[Path, Any]) -> Table:
    if body.dimension == 3:
        why, fix = "problem files describe plane problems only", "keep this problem in Python"
        raise InputError(f"{field}.kinematics", body.kinematics, why, fix)
    mesh = _recipe(body.mesh, file.parent)
    if mesh is None:
        meshes[file] = body.mesh
        mesh = {"mesh": {"file": file.name}}
    return {
        "kind": "continuum",
        "kinematics": body.kinematics,
        "space": body.space,
        "geometry": body.geometry,
        **mesh,
        "material": statements.criteria(body.criterion, f"{field}.criterion"),
    }


def toml(document: Mapping[str, Any]) -> str:
    """Return a document of tables, lists, texts and numbers as TOML."""
    made = tomlkit.document()
    for name, own in document.items():
        made.add(name, _item(own))
    return tomlkit.dumps(made)


def _item(value: Any) -> Item:
    if isinstance(value, Mapping):
        return _table(value)
    if isinstance(value, list) and value and all(isinstance(own, Mapping) for own in value):
        tables = tomlkit.aot()
        for own in value:
            tables.append(_table(own))
        return tables
    found: Item = _inline(value)
    return found


def _table(value: Mapping[str, Any]) -> Item:
    """Return a table with short values first, as keys after a sub-table would belong to it."""
    table, after = tomlkit.table(), {}
    for name, own in value.items():
        line = _inline(own)
        if isinstance(own, Mapping) and len(f"{name} = {line.as_string()}") > _WIDTH:
            after[name] = own
        else:
            table.add(name, line)
    for name, own in after.items():
        table.add(name, _table(own))
    return table


def _inline(value: Any) -> Any:
    if isinstance(value, Mapping):
        table = tomlkit.inline_table()
        for name, own in value.items():
            table.append(name, _inline(own))
        return table
    if isinstance(value, list):
        array = tomlkit.array()
        for own in value:
            array.append(_inline(own))
        return array
    return tomlkit.item(value)


def _recipe(mesh: Any, folder: Path) -> Table | None:
    """Return ``mesh``, ``boundaries``, ``regions`` of an unchanged mesh from a problem file.

    The result is None for others, including meshes that were changed.
    """
    call = origin(mesh)
    if call is None or not _same(made(call), mesh):
        return None
    table: Table = {}
    if call.maker == "la.meshes.named":
        for what in ("boundaries", "regions"):
            own = call.arguments.get(what, {})
            table |= {what: {name: _place(where) for name, where in own.items()}} if own else {}
        call = call.arguments["mesh"]
    if call.maker in _FILES:
        given = dict(call.arguments)
        file = way(given.pop("path"), folder)
        return {"mesh": {"file": file, **given}, **table}
    shape = {"shape": _SHAPES[call.maker], **_plain(call.arguments)}
    return {"mesh": shape, **table}


def _place(call: Call) -> Any:
    own = _plain(call.arguments)
    return own if call.maker != "la.Along" else {"from": own["start"], "to": own["end"]}


def _plain(value: Any) -> Any:
    if isinstance(value, Call):
        return _plain(value.arguments)
    if isinstance(value, Mapping):
        return {name: _plain(own) for name, own in value.items()}
    if isinstance(value, tuple | list):
        return [_plain(own) for own in value]
    return plain(value)


def _same(one: Any, other: Any) -> bool:
    """Return whether two meshes are equal, including their names."""
    if type(one) is not type(other):
        return False
    arrays = np.array_equal(one.doflocs, other.doflocs) and np.array_equal(one.t, other.t)
    return arrays and all(
        _named(getattr(one, what), getattr(other, what)) for what in ("boundaries", "subdomains")
    )


def _named(one: Mapping[str, Any] | None, other: Mapping[str, Any] | None) -> bool:
    mine, theirs = one or {}, other or {}
    return mine.keys() == theirs.keys() and all(
        np.array_equal(own, theirs[name]) for name, own in mine.items()
    )
