"""Base of all entries of a problem file: known keys, and their conversion to calls."""

from collections.abc import Iterable
from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, model_validator

from lacore.files.problem.calls import Call
from lacore.files.problem.places import Path
from lacore.files.problem.schema.values import refused
from lacore.reporting.errors import suggest


class Entry(BaseModel):
    """A table of a problem file.

    Attributes:
        maker: function of its call, see `lacore.files.problem.calls.MAKERS`.
        tag: the key that determines its kind, which is not an argument.
    """

    model_config = ConfigDict(
        extra="forbid", frozen=True, hide_input_in_errors=True, use_attribute_docstrings=True
    )
    maker: ClassVar[str] = ""
    tag: ClassVar[str] = ""

    @model_validator(mode="before")
    @classmethod
    def _keys(cls, given: Any) -> Any:
        """Check for unknown and missing keys, and list the valid ones in errors."""
        if not isinstance(given, dict):
            raise refused("not a table", "give its keys, as { key = value }")
        known = {entry.alias or name: entry for name, entry in cls.model_fields.items()}
        for key in given:
            if key not in known:
                raise refused("unknown key", _advice(str(key), known, given), str(key))
        missing = [key for key, entry in known.items() if entry.is_required() and key not in given]
        if missing:
            needed = ", ".join(missing)
            raise refused("missing", f"add {needed}", missing[0])
        return given

    def call(self, at: Path) -> Any:
        """Return its call, with its place in the file."""
        return Call(self.maker, self.arguments(at), at)

    def arguments(self, at: Path) -> dict[str, Any]:
        """Return the keys that were given, as arguments."""
        fields = type(self).model_fields
        given = {name: getattr(self, name) for name in fields if name in self.model_fields_set}
        return {
            name: node(own, (*at, fields[name].alias or name))
            for name, own in given.items()
            if name != self.tag and own is not None
        }


def _advice(key: str, known: Iterable[str], given: Iterable[str]) -> str:
    """Return the closest key, preferably one that is not given, and all valid ones."""
    names = {*known}
    for own in (names - {*given}, names):
        if (fix := suggest(key, own)).endswith("?"):
            return f"{fix} known keys: {', '.join(sorted(names))}"
    return f"known keys: {', '.join(sorted(names))}"


def node(value: Any, at: Path) -> Any:
    """Return a value of the file as part of calls."""
    if isinstance(value, Entry):
        return value.call(at)
    if isinstance(value, tuple | list):
        return type(value)(node(own, (*at, place)) for place, own in enumerate(value))
    if isinstance(value, dict):
        return {name: node(own, (*at, name)) for name, own in value.items()}
    return value
