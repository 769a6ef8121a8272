"""Stored evidence of a bracket: meshes, and the shares of their elements in the gap (T26)."""

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Floats, Ints

_ARRAYS = ("points", "elements", "shares", "interfaces", "marks")
_NUMBERS = ("lower", "upper", "scale")


@dataclass(frozen=True)
class Shares:
    """The gap identity on one mesh.

    Attributes:
        mesh: ``uniform``, ``irregular``, or ``upper``, ``lower``: refined for that bound.
        points, elements: of the mesh, shapes (2, n) and (3, e), in 3D one more each.
        shares: of elements in the gap, shape (e,), in the unit of load factors.
        interfaces: shares of interfaces.
        marks: shares by which the mesh of a lower bound was refined; empty for other meshes.
        lower, upper: load factors of both bounds on this mesh.
        scale: the larger of the load factor and the plastic power, as dead loads may make the
            latter larger; round-off is relative to it.
    """

    mesh: str
    points: Floats
    elements: Ints
    shares: Floats
    interfaces: Floats
    marks: Floats
    lower: float
    upper: float
    scale: float

    @property
    def total(self) -> float:
        """Sum of all shares."""
        return float(self.shares.sum() + self.interfaces.sum())

    @property
    def least(self) -> float:
        """The least share."""
        return float(np.concatenate([self.shares, self.interfaces]).min(initial=np.inf))


def packed_shares(found: Sequence[Shares]) -> bytes:
    """Return shares in numpy's archive format."""
    arrays: dict[str, np.ndarray] = {"meshes": np.array([one.mesh for one in found])}
    for one in found:
        arrays |= {f"{one.mesh}_{name}": getattr(one, name) for name in _ARRAYS}
        arrays[f"{one.mesh}_numbers"] = np.array([getattr(one, name) for name in _NUMBERS])
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)  # type: ignore[arg-type]  # the stub takes the names for its own
    return buffer.getvalue()


def unpacked_shares(data: bytes) -> list[Shares]:
    """Return the inverse of `packed_shares`; nothing in the data is executed.

    Raises:
        ValueError: the bytes are no such archive.
    """
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            arrays = dict(archive)
        return [_shares(str(mesh), arrays) for mesh in arrays["meshes"]]
    # zip, struct, key and value errors mean that the bytes have another format.
    except Exception as error:
        raise ValueError(f"no bracket: {error}") from error


def _shares(mesh: str, arrays: Mapping[str, np.ndarray]) -> Shares:
    lower, upper, scale = map(float, arrays[f"{mesh}_numbers"])
    points, elements, shares, interfaces, marks = (arrays[f"{mesh}_{name}"] for name in _ARRAYS)
    if len(points) not in (2, 3) or elements.shape != (len(points) + 1, shares.size):
        raise ValueError("shares of another mesh")
    return Shares(mesh, points, elements, shares, interfaces, marks, lower, upper, scale)
