"""Stored load factors in a folder: one file each, named by a digest of the problem."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lacore import __version__
from lacore.program.kinematic import KinematicProgram
from lacore.reporting.errors import InputError

_FORMAT = 1


@dataclass(frozen=True)
class LoadFactorRecord:
    """Stored data of a state.

    Attributes:
        value, error: see `lacore.analyses.proven_values`.
        status, residual: those of the state.
        seconds: time of the solve.
    """

    value: float
    error: float
    status: str
    residual: float
    seconds: float


def digest(program: KinematicProgram, given: Mapping[str, Any]) -> str:
    """Return a digest of a program and its arguments: equal for equal ones, bit by bit."""
    seen = hashlib.sha256(f"{_FORMAT} {__version__} {sorted(given.items())!r}".encode())
    _read(seen, program)
    return seen.hexdigest()


def recall(folder: Path, name: str) -> LoadFactorRecord | None:
    """Return a stored result; None if there is none, or a file cannot be read."""
    try:
        told = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
        numbers = {key: float(told[key]) for key in ("value", "error", "residual", "seconds")}
        return LoadFactorRecord(status=str(told["status"]), **numbers)
    except (OSError, ValueError, KeyError, TypeError):
        return None


def keep(folder: Path, name: str, found: LoadFactorRecord) -> None:
    """Write a result completely or not at all."""
    unfinished = folder / f"{name}.part"
    unfinished.write_text(json.dumps(asdict(found)), encoding="utf-8")
    unfinished.replace(folder / f"{name}.json")


def folder_of(folder: str | Path | None) -> Path | None:
    """Return the folder, which is made if it does not exist.

    Raises:
        InputError: it cannot be made.
    """
    if folder is None:
        return None
    path = Path(folder)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            "folder", str(folder), f"cannot be made: {error.strerror}", "give another, or none"
        ) from None
    return path


def _read(seen: Any, part: object) -> None:
    """Add all numbers of a part of a program, and their types, to a digest."""
    seen.update(f"<{type(part).__name__}>".encode())
    if is_dataclass(part):
        for entry in fields(part):
            seen.update(entry.name.encode())
            _read(seen, getattr(part, entry.name))
    elif isinstance(part, tuple | list):
        for own in part:
            _read(seen, own)
    elif hasattr(part, "tocsr"):
        rows = part.tocsr()
        for own in (rows.shape, rows.indptr, rows.indices, rows.data):
            _read(seen, own)
    elif isinstance(part, np.ndarray):
        seen.update(f"{part.dtype}{part.shape}".encode())
        seen.update(np.ascontiguousarray(part).tobytes())
    else:
        seen.update(repr(part).encode())
