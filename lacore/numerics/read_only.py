"""Programs that cannot be changed: read-only arrays, and a digest that detects changes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from hashlib import blake2b
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_matrix, issparse

_INDEX_ARRAYS = ("data", "indices", "indptr")


def _parts_of(value: object, name: str) -> Iterator[tuple[str, object]]:
    """Yield the names and values in a dataclass or a tuple."""
    if isinstance(value, tuple):
        yield from ((f"{name}[{number}]", part) for number, part in enumerate(value))
    elif is_dataclass(value) and not isinstance(value, type):
        yield from ((f"{name}.{own.name}", getattr(value, own.name)) for own in fields(value))


def _matrices_of(value: object) -> Iterator[object]:
    if issparse(value):
        yield value
    for _, part in _parts_of(value, ""):
        yield from _matrices_of(part)


def arrays_of(value: object, name: str = "program") -> Iterator[tuple[str, npt.NDArray[Any]]]:
    """Yield the names and arrays of a dataclass and its parts, including sparse matrices."""
    if isinstance(value, np.ndarray):
        yield name, value
    elif issparse(value):
        for part in _INDEX_ARRAYS:
            if isinstance(own := getattr(value, part, None), np.ndarray):
                yield f"{name}.{part}", own
    for whole, held in _parts_of(value, name):
        yield from arrays_of(held, whole)


def make_read_only(value: object) -> None:
    """Let no array of a dataclass be written to; rows of sparse matrices are sorted before."""
    for matrix in _matrices_of(value):
        # SciPy sorts rows in place when it first needs it, which it could not do later.
        if isinstance(matrix, csr_matrix) and not matrix.has_canonical_format:
            matrix.sum_duplicates()
    for _, array in arrays_of(value):
        array.flags.writeable = False


def digests(value: object, name: str = "program") -> dict[str, str]:
    """Return a digest of each array of a dataclass, by its name."""
    return {
        own: blake2b(np.ascontiguousarray(array).data, digest_size=16).hexdigest()
        for own, array in arrays_of(value, name)
    }


def changed(before: dict[str, str], value: object, name: str = "program") -> list[str]:
    """Return the names of the arrays whose digests have changed."""
    now = digests(value, name)
    return sorted(own for own in before.keys() | now.keys() if before.get(own) != now.get(own))
