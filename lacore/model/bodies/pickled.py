"""Pickling of bodies by their arguments: the rest is computed and checked again."""

from collections.abc import Mapping
from dataclasses import Field, fields
from typing import Any, ClassVar, Protocol


class _Made(Protocol):
    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]


def by_arguments(body: _Made) -> tuple[type, tuple[Any, ...]]:
    """Return the value of `__reduce__` for a dataclass whose mappings cannot be pickled."""
    given = [getattr(body, entry.name) for entry in fields(body) if entry.init]
    return type(body), tuple(dict(own) if isinstance(own, Mapping) else own for own in given)
