"""Programs that nobody can change: read-only arrays, and a digest that shows a change."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from hashlib import blake2b
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import issparse

_INDEX_ARRAYS = ("data", "indices", "indptr")


def arrays_of(value: object, name: str = "program") -> Iterator[tuple[str, npt.NDArray[Any]]]:
    """Names and arrays of a dataclass and all of its parts, those of sparse matrices too."""
    if isinstance(value, np.ndarray):
        yield name, value
    elif issparse(value):
        for part in _INDEX_ARRAYS:
            if isinstance(own := getattr(value, part, None), np.ndarray):
                yield f"{name}.{part}", own
    elif isinstance(value, tuple):
        for number, part in enumerate(value):
            yield from arrays_of(part, f"{name}[{number}]")
    elif is_dataclass(value) and not isinstance(value, type):
        for field in fields(value):
            yield from arrays_of(getattr(value, field.name), f"{name}.{field.name}")


def make_read_only(value: object) -> None:
    """Let no array of a dataclass be written to."""
    for _, array in arrays_of(value):
        array.flags.writeable = False


def digests(value: object, name: str = "program") -> dict[str, str]:
    """A digest of each array of a dataclass, by its name."""
    return {
        own: blake2b(np.ascontiguousarray(array).data, digest_size=16).hexdigest()
        for own, array in arrays_of(value, name)
    }


def changed(before: dict[str, str], value: object, name: str = "program") -> list[str]:
    """Names of the arrays whose digests differ from those taken before."""
    now = digests(value, name)
    return sorted(own for own in before.keys() | now.keys() if before.get(own) != now.get(own))
