"""Commands that repeat a run and that export its optimisation program."""

import shlex
from collections.abc import Mapping
from typing import Any

from lacore_verification.case import Variant
from lacore_verification.case.band import BRACKET
from lacore_verification.case.case import RANGE
from lacore_verification.runs.run import Run, canonical

INSTANCES = "instances"
"""Folder of programs as files, next to the report of a comparison."""
_PLAIN = (bool, int, float, str)
_RESERVED = ",:"  # separators of the values of an axis


def instance_name(case: str, variant: str, mesh: str, ending: str = "npz") -> str:
    """Return the name of the file that `lacore export` writes for a program."""
    return f"{case}-{variant}-{mesh}.{ending}"


def commands_of(run: Run) -> dict[str, str]:
    """Return the columns `repeat_command`, `export_command` and `instance_file` of a run.

    A cell is empty if no command can repeat the run. The exported program is that of the associated
    problem, for any coupling of the run.
    """
    base = _base(run)
    varied = _varied(run, base)
    exports = not (run.size or _changed(run, base))
    name = f"{run.case.id}:{base.name}"
    meshes = ["--meshes", run.mesh] if run.case.meshed else []
    export = shlex.join(["lacore", "export", name, *meshes])
    file = instance_name(run.case.id, run.variant.name, run.mesh)
    return {
        "repeat_command": "" if varied is None else _repeat(run, name, meshes, varied),
        "export_command": export if exports else "",
        "instance_file": file if exports else "",
    }


def _repeat(run: Run, name: str, meshes: list[str], varied: list[str]) -> str:
    couplings = ["--couplings", run.coupling] if run.coupling else []
    command = ["compare", name]
    if varied:
        command = ["sweep", name, *(word for axis in varied for word in ("--vary", axis))]
    return shlex.join(["lacore", *command, *meshes, "--backends", run.backend, *couplings])


def _base(run: Run) -> Variant:
    """Return the listed variant from which the variant of a run was made.

    The variants of a sweep are named after it, unless the case has one variant only.
    """

    def distance(one: Variant) -> tuple[int, bool, int]:
        named = run.variant.name.startswith(f"{one.name}-")
        return len(_changed(run, one)), not named, -len(one.name)

    same = (one for one in run.case.variants if one.name == run.variant.name)
    return next(same, None) or min(run.case.variants, key=distance)


def _changed(run: Run, base: Variant) -> Mapping[str, Any]:
    """Return the parameters of a run that differ from those of a variant, or name its variant.

    A sweep names its variants after the varied parameters, in the order in which they are given.
    """
    name = "" if base.name == run.variant.name else f"-{run.variant.name}-"
    return {
        own: value
        for own, value in sorted(run.parameters.items(), key=lambda item: name.find(f"-{item[0]}-"))
        if f"-{own}-" in name
        or own not in base.parameters
        or canonical(base.parameters[own]) != canonical(value)
    }


def _varied(run: Run, base: Variant) -> list[str] | None:
    """Return the axes of a sweep that repeats the run, one for each value; None if impossible."""
    kinds = {
        "param": _changed(run, base),
        "size": run.size,
        "setting": run.settings,
        "option": run.options,
    }
    named = [
        (f"{kind}.{name}", value) for kind, own in kinds.items() for name, value in own.items()
    ]
    if named and run.coupling in (BRACKET, RANGE):
        return None
    for _, value in named:
        if not isinstance(value, _PLAIN) or not str(value) or set(str(value)) & set(_RESERVED):
            return None
    return [f"{name}={value}" for name, value in named]
