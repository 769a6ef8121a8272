"""Load factors that were found before, in a folder: a file each, named by what was solved."""

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
    """What is kept of a state.

    Attributes:
        value, error: see `lacore.analyses.proven_values`.
        status, residual: of the state.
        seconds: that it took.
    """

    value: float
    error: float
    status: str
    residual: float
    seconds: float


def digest(program: KinematicProgram, given: Mapping[str, Any]) -> str:
    """A name for a program and what it is solved with: equal for equal ones, bit for bit."""
    seen = hashlib.sha256(f"{_FORMAT} {__version__} {sorted(given.items())!r}".encode())
    _read(seen, program)
    return seen.hexdigest()


def recall(folder: Path, name: str) -> LoadFactorRecord | None:
    """What was found before; None where nothing was, or where a file cannot be read."""
    try:
        told = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
        numbers = {key: float(told[key]) for key in ("value", "error", "residual", "seconds")}
        return LoadFactorRecord(status=str(told["status"]), **numbers)
    except (OSError, ValueError, KeyError, TypeError):
        return None


def keep(folder: Path, name: str, found: LoadFactorRecord) -> None:
    """Write what was found, whole or not at all."""
    unfinished = folder / f"{name}.part"
    unfinished.write_text(json.dumps(asdict(found)), encoding="utf-8")
    unfinished.replace(folder / f"{name}.json")


def folder_of(folder: str | Path | None) -> Path | None:
    """The folder, made where there is none.

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
    """Feed all numbers of a part of a program, and what they belong to."""
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
