"""`write_problem`: a problem as a TOML file that states the same one."""

from __future__ import annotations

from functools import singledispatch
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from lacore.bodies.blocks.block_assembly import BlockAssembly
from lacore.bodies.continuum.body import Body
from lacore.bodies.frames.frame import Frame
from lacore.errors import InputError, typed
from lacore.files.problem import statements
from lacore.files.problem.recipes import recipe
from lacore.files.problem.statements import Table
from lacore.meshes.archive import save
from lacore.problem.problem import Problem


@typed()
def write_problem(problem: Problem, path: str | PathLike[str], title: str = "") -> None:
    """Write a problem as TOML, in SI units: `read_problem` gives the same one.

    Meshes that came of a problem file are written as they were given there, others beside the file
    as ``NAME-1.npz``, ... Walls, arches and drawings are written as polygons.

    Args:
        problem: whose boundaries are names, or places by numbers: `lacore.Within`, `lacore.Along`,
            `lacore.Beyond`.
        path: of the file, ending in .toml.
        title: of the page that shows its answer.

    Raises:
        InputError: what no file can state: functions of places, laws of hardening, criteria and
            obstacles of your own, bodies in space; a file that cannot be written.

    Example:
        >>> la.write_problem(la.examples.column(friction=0.3), "column.toml")
        >>> round(la.solve(la.read_problem("column.toml")).load_factor, 3)
        0.3
    """
    from lacore.files.problem.layout import toml  # here: tomlkit is for writing alone

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
    """The table of a body; a mesh that it needs a file for is added to `meshes`."""
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
    mesh = recipe(body.mesh, file.parent)
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
