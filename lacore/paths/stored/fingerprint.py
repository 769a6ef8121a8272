"""What tells one statement of a problem from another: digests of its parts."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
from skfem import Mesh

from lacore.model.materials.hardening import HardeningLaw
from lacore.reporting.errors import InputError

_SAMPLES = np.concatenate([[0.0], np.geomspace(1e-6, 10.0, 71)])  # of strain, of laws of others


def fingerprint(parts: Mapping[str, Any]) -> dict[str, str]:
    """A digest of each part: equal for equal statements, bit for bit.

    Raises:
        InputError: something that only its place in memory tells from others.
    """
    return {
        name: hashlib.sha256(json.dumps(_described(name, part)).encode()).hexdigest()
        for name, part in parts.items()
    }


def _described(field: str, value: Any) -> Any:
    """Plain data that say all of a value that counts."""
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        data = np.ascontiguousarray(value)
        return [str(data.dtype), data.shape, hashlib.sha256(data.tobytes()).hexdigest()]
    kind = type(value).__qualname__
    if isinstance(value, Mesh):
        return [kind, *_mesh(field, value)]
    if is_dataclass(value) and not isinstance(value, type):
        own = {entry.name: getattr(value, entry.name) for entry in fields(value)}
        return [kind, _described(field, own)]
    if isinstance(value, Mapping):
        return [[str(key), _described(field, part)] for key, part in value.items()]
    if isinstance(value, Sequence):
        return [_described(field, part) for part in value]
    if isinstance(value, HardeningLaw) and not isinstance(value, type):
        sampled = np.stack([value.stress(_SAMPLES), value.modulus(_SAMPLES)])
        return [kind, _described(field, sampled)]
    raise InputError(
        field,
        value,
        "has nothing to be known by again, as a checkpoint needs",
        "make its class a frozen dataclass, or leave out the checkpoint",
    )


def _mesh(field: str, mesh: Mesh) -> list[Any]:
    """Return places, elements and boundaries of a mesh, and regions where it has some."""
    named = {name: np.asarray(facets) for name, facets in (mesh.boundaries or {}).items()}
    regions = {name: np.asarray(part) for name, part in (mesh.subdomains or {}).items()}
    parts = [mesh.doflocs, mesh.t, named, *([regions] if regions else [])]
    return [_described(field, part) for part in parts]
