"""What a mesh was made by, to be written as it was given."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from lacore.files.problem.calls import Call, made, origin
from lacore.files.problem.script import way
from lacore.files.problem.statements import Table, plain

_SHAPES: Mapping[str, str] = {
    "la.meshes.rectangle": "rectangle",
    "la.meshes.quadrilaterals": "quadrilaterals",
    "la.meshes.fan": "fan",
    "la.meshes.quarter_ring": "quarter-ring",
    "la.meshes.patches": "patches",
    "la.meshes.layered": "layered",
}
_FILES = ("la.meshes.read", "la.meshes.load")


def recipe(mesh: Any, folder: Path) -> Table | None:
    """``mesh``, ``boundaries``, ``regions`` of a mesh that came of a problem file as it is now.

    None of others: what was changed since is not what the file said.
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
    """Whether two meshes are one, with their names."""
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
