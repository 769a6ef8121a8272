"""Checks of the keys, types and units of problem files."""

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from lacore.files.problem.places import Path
from lacore.files.problem.schema.document import ProblemFile
from lacore.files.problem.schema.meshes import FOLDER
from lacore.files.problem.schema.values import AMOUNTS, FORCES
from lacore.files.problem.source import Source, has
from lacore.files.problem.units import Amount
from lacore.reporting.errors import InputError, suggest

TAGS = ("kind", "shape", "criterion", "law", "load", "measure", "tool")
"""Keys whose values determine the kind of a table."""
_LIST = ("not a list", "write it as [ ... ]")
_TABLE = ("not a table", "write it as [table] or { key = value }")
_BOOL = ("neither true nor false", "write true or false, without quotes")
_SAID: Mapping[str, tuple[str, str]] = {
    "tuple_type": _LIST,
    "list_type": _LIST,
    "missing": ("too few values", "add the next one"),  # only for lists, as keys are checked before
    "too_long": ("too many values", "remove the others"),
    "dict_type": _TABLE,
    "model_type": _TABLE,
    "model_attributes_type": _TABLE,
    "string_type": ("not a text", "write it in quotes"),
    "bool_type": _BOOL,
    "bool_parsing": _BOOL,
}


def checked(source: Source) -> tuple[ProblemFile, Sequence[Amount]]:
    """Return the contents of a file, and all numbers in it.

    Raises:
        InputError: anything that a problem file must not contain.
    """
    amounts: list[Amount] = []
    context = {FOLDER: source.file.parent, FORCES: _whole(source.data), AMOUNTS: amounts}
    try:
        return ProblemFile.model_validate(source.data, context=context), amounts
    except ValidationError as error:
        found = error.errors(include_url=False, include_input=False)
        raise source.errors([_told(source, one) for one in found]) from None


def _whole(data: Mapping[str, Any]) -> frozenset[str]:
    """Return the bodies whose forces are not per thickness: frames, and axisymmetric bodies."""
    bodies = data.get("bodies")
    if not isinstance(bodies, dict):
        return frozenset()
    kinds = {"kind": "frame", "kinematics": "axisymmetric"}
    return frozenset(
        name
        for name, body in bodies.items()
        if isinstance(body, dict) and any(body.get(key) == own for key, own in kinds.items())
    )


def _told(source: Source, one: Any) -> tuple[Path, InputError]:
    """Return the place of an error, and the error."""
    path, context = _path(source.data, one["loc"]), one.get("ctx", {})
    kind = one["type"]
    if kind == "refused":
        path, why, fix = (*path, *context["more"]), context["why"], context["fix"]
        value = None
    elif kind in ("union_tag_invalid", "union_tag_not_found"):
        key = context["discriminator"].strip("'")
        path = (*path, key)
        known = [name.strip(" '") for name in context.get("expected_tags", "").split(",")]
        value = context.get("tag")
        why, fix = "unknown", suggest(str(value), known)
        if kind == "union_tag_not_found":
            value, why, fix = None, "missing", f"add {key}"
    elif kind == "literal_error":
        known = context["expected"].replace(" or ", ", ").replace("'", "").split(", ")
        value = _at(source.data, path)
        why, fix = "unknown", suggest(str(value), known)
    else:
        value = _at(source.data, path)
        why, fix = _SAID.get(kind, (str(one["msg"]), "see the examples of `lacore new`"))
    return path, source.error(path, value, why, fix)


def _path(data: Any, loc: tuple[str | int, ...]) -> Path:
    """Return a place of pydantic without the tags that it inserts between keys."""
    path: list[str | int] = []
    own, tag = data, False
    for key in loc:
        tag = not tag and isinstance(own, dict) and key in map(own.get, TAGS)
        if not tag and has(own, key):  # A tag may also be a key, but after it.
            own = own[key]
            path.append(key)
    return tuple(path)


def _at(data: Any, path: Path) -> Any:
    own = data
    for key in path:
        own = own[key]
    return own
