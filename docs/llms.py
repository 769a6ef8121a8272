"""Write ``lacore/llms.txt``, a summary of lacore for language models: ``python docs/llms.py``.

Names, signatures, statuses, commands, exit codes and the keys of problem files are read from the
code. The file is part of the wheel, and the site has it at its root.
"""

import dataclasses
import enum
import inspect
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import click

import lacore as la
from lacore_verification.commands.cli import main as commands
from lacore_verification.defaults import STOPPED
from lacore_verification.report.problems import starters
from lacore_verification.usage import BAD_INPUT

FILE = Path(__file__).parents[1] / "lacore" / "llms.txt"
ABOUT = """\
# lacore

> lacore computes the load at which a rigid-plastic structure collapses (limit analysis, with
> Coulomb friction in contact), proves the result, and compares solvers for the problem on cases
> with known collapse loads.

A problem has bodies (continua of soil, metal or masonry; rigid blocks in two or three dimensions;
plane frames), supports, contact, dead loads and reference loads. The load factor multiplies the
reference loads at collapse. Every result has a status, a rigor that states what is proven, and a
certificate of residuals that are recomputed without the solver. Units in Python are SI: m, Pa, N,
and N/m for forces per metre of thickness; angles are in degrees.
"""
NAMES = {
    "Problem": "A limit-analysis problem. Loads and supports name the body that they act on.",
    "Body": "A deformable body: a mesh of `la.meshes` and a yield criterion like `la.VonMises`.",
    "BlockAssembly": "Rigid blocks with friction in their joints; builders are in `la.masonry`.",
    "Frame": "A plane frame of members with plastic hinges; sections are in `la.sections`.",
    "Interface": "Contact with friction between a boundary and an obstacle or another boundary.",
    "solve": "Compute load factor, collapse mechanism and certificate; returns `la.LimitState`.",
    "bracket": "Compute a lower and an upper bound, with meshes refined until they are close.",
    "lower_bound": "Compute a strict lower bound on the load factor of the continuum.",
    "coulomb_range": "Search for the lowest and the highest load factor with Coulomb friction.",
    "read_problem": "Read a problem file in TOML, the same that `lacore solve` reads.",
}
"""The most important names of `lacore`, and what they are."""
CODES = {
    0: "success",
    1: "a result is wrong or not certified",
    BAD_INPUT: "invalid input; standard error has one sentence with field, value, reason and fix",
    STOPPED: "interrupted by Ctrl-C",
}
"""Exit codes of all commands."""


def text() -> str:
    """Return the file."""
    parts = (
        ABOUT,
        "## Python: `import lacore as la`\n",
        *(f"- `la.{name}{_parameters(name)}`: {said}" for name, said in NAMES.items()),
        f"\nMembers of a `la.LimitState`: {', '.join(map(_code, _members(la.LimitState)))}.",
        f"Statuses: {_values(la.Status)}. Rigor: {_values(la.Rigor)}.",
        "Invalid input raises `la.InputError` before any solve.\n",
        "## Commands\n",
        *_commands(),
        "\nExit codes:\n",
        *(f"- {code}: {said}" for code, said in CODES.items()),
        "\n## Problem files (TOML)\n",
        *_schema(json.loads(starters.schema())),
    )
    return "\n".join(parts) + "\n"


def _code(name: str) -> str:
    return f"`{name}`"


def _parameters(name: str) -> str:
    """Return the parameters of a function or class, with their defaults, without annotations."""
    signature = inspect.signature(getattr(la, name))
    bare = [own.replace(annotation=own.empty) for own in signature.parameters.values()]
    return str(signature.replace(parameters=bare, return_annotation=signature.empty))


def _members(kind: Any) -> Iterator[str]:
    """Yield the public fields, properties and methods that a dataclass defines itself."""
    yield from (own.name for own in dataclasses.fields(kind) if not own.name.startswith("_"))
    for name, member in vars(kind).items():
        if not name.startswith("_") and (callable(member) or hasattr(member, "__get__")):
            yield name


def _values(kind: type[enum.Enum]) -> str:
    return ", ".join(_code(own.name) for own in kind)


def _commands() -> Iterator[str]:
    """Yield a line per command, then which of them print JSON."""
    own = commands.commands
    for name, command in own.items():
        yield f"- `lacore {name}`: {command.get_short_help_str(limit=200)}"
    silent = [name for name, command in own.items() if not prints_json(command)]
    every = f"Every command except {', '.join(map(_code, silent))}" if silent else "Every command"
    yield f"\n{every} accepts `--json` and then prints one JSON document on standard output."
    yield "`lacore COMMAND --help` lists all options of a command."
    yield f"`lacore new NAME > FILE.toml` writes a problem file: {', '.join(starters.titles())}."
    yield "`lacore solve FILE.toml --json` solves it."


def prints_json(command: click.Command) -> bool:
    """Return whether a command has the option ``--json``."""
    return any("--json" in option.opts for option in command.params)


def _schema(schema: Mapping[str, Any]) -> Iterator[str]:
    """Yield the keys of problem files; required ones have a star."""
    yield "A star marks a required key."
    yield 'Quantities are numbers in SI units, or text with a unit, for example `"20 kPa"`.'
    yield "`lacore new --schema` prints the complete JSON schema.\n"
    yield f"- file: {_keys(schema)}"
    definitions = schema["$defs"]
    for name, key in (
        ("Support", "[[supports]]"),
        ("Interface", "[[interfaces]]"),
        ("PathOf", "[path]"),
        ("Asked", "[solve]"),
    ):
        yield f"- `{key}`: {_keys(definitions[name])}"
    forms = (f"{{ {_keys(definitions[name])} }}" for name in WHERE)
    yield f"- `where`: a name, a list of names, or one of the tables {', '.join(forms)}"
    for title, key in TABLES.items():
        yield f"\n{title}:\n"
        for own in definitions.values():
            constant = own.get("properties", {}).get(key, {}).get("const")
            if constant is not None:
                yield f'- `{key} = "{constant}"`: {_keys(own, without=key)}'


WHERE = ("Box", "Line", "HalfPlane", "OfLayer")
"""Definitions of the tables that select a part of a boundary or of a body."""
TABLES = {
    "Bodies, `[bodies.NAME]`": "kind",
    "Loads, `[[reference_loads]]` and `[[dead_loads]]`": "load",
    'Meshes, `[bodies.NAME.mesh]`; also `{ file = "mesh.msh" }`': "shape",
    "Materials, `[bodies.NAME.material]`, or one such table per region": "criterion",
    "Tools of a path, `[tools.NAME]`": "tool",
    "Travel of a path, `[path.control]`": "measure",
}
"""Tables of a problem file that have several forms, and the key that selects one."""


def _keys(own: Mapping[str, Any], without: str = "") -> str:
    required = own.get("required", ())
    names = (name for name in own["properties"] if name != without)
    return ", ".join(f"{name}*" if name in required else name for name in names)


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
