"""Plain data as bytes, for messages from the untrusted process of a backend.

Unpickling runs code that the sender chooses. Here a message holds only None, truth values, numbers,
text, lists, mappings and arrays of numbers, and reading it cannot do anything but build these.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

_LENGTH = 8  # bytes of the number that states the length of the header
_ARRAY = "__array__"
_KINDS = "fiub"  # kinds of arrays: floats, integers, truth values


def dumps(value: object) -> bytes:
    """Encode a value.

    Raises:
        TypeError: It holds something that is not plain; the message says what and where.
    """
    arrays: list[bytes] = []
    header = json.dumps(_packed(value, arrays, "value")).encode()
    return b"".join([len(header).to_bytes(_LENGTH, "little"), header, *arrays])


def loads(message: bytes) -> Any:
    """Decode a value; tuples are returned as lists.

    Raises:
        ValueError: The message was not made by `dumps`.
    """
    length = int.from_bytes(message[:_LENGTH], "little")
    begin = _LENGTH + length
    value, end = _unpacked(json.loads(message[_LENGTH:begin]), memoryview(message), begin)
    if end != len(message):
        raise ValueError(f"a message of {len(message)} bytes describes {end}")
    return value


def _packed(value: object, arrays: list[bytes], where: str) -> Any:
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, (int, float)):
        return value
    if isinstance(value, (np.generic, np.ndarray)):
        if value.dtype.kind not in _KINDS:
            raise TypeError(f"{where} is an array of {value.dtype}, not of numbers")
        if isinstance(value, np.generic):
            return value.item()
        arrays.append(np.ascontiguousarray(value).tobytes())
        return {_ARRAY: value.dtype.str, "shape": list(value.shape)}
    if isinstance(value, Mapping):
        if not all(isinstance(key, str) for key in value):
            raise TypeError(f"{where} has keys that are not text")
        return {key: _packed(part, arrays, f"{where}.{key}") for key, part in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, (bytes, bytearray)):
        return [_packed(part, arrays, f"{where}[{i}]") for i, part in enumerate(value)]
    raise TypeError(f"{where} is a {type(value).__name__}")


def _unpacked(value: Any, message: memoryview, begin: int) -> tuple[Any, int]:
    if isinstance(value, list):
        parts = []
        for part in value:
            found, begin = _unpacked(part, message, begin)
            parts.append(found)
        return parts, begin
    if isinstance(value, dict):
        if _ARRAY in value:
            return _array(value, message, begin)
        named = {}
        for key, part in value.items():
            named[key], begin = _unpacked(part, message, begin)
        return named, begin
    return value, begin


def _array(value: dict[str, Any], message: memoryview, begin: int) -> tuple[Any, int]:
    kind, shape = np.dtype(value[_ARRAY]), tuple(int(size) for size in value["shape"])
    if kind.kind not in _KINDS or any(size < 0 for size in shape):
        raise ValueError(f"an array of {kind} and shape {shape} in a message")
    end = begin + kind.itemsize * int(np.prod(shape, dtype=object))
    if end > len(message):
        raise ValueError("a message ends within an array")
    # Copy the array: a view of the message would keep all of it, and be read-only.
    return np.frombuffer(message[begin:end], dtype=kind).reshape(shape).copy(), end
