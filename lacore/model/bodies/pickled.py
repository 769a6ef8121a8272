"""Pickling of bodies by what they were made of: the rest is computed anew, and checked."""

from collections.abc import Mapping
from dataclasses import Field, fields
from typing import Any, ClassVar, Protocol


class _Made(Protocol):
    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]


def by_arguments(body: _Made) -> tuple[type, tuple[Any, ...]]:
    """For `__reduce__` of a dataclass whose mappings have no pickle as they are kept."""
    given = [getattr(body, entry.name) for entry in fields(body) if entry.init]
    return type(body), tuple(dict(own) if isinstance(own, Mapping) else own for own in given)
