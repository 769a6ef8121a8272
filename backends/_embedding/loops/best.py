"""What is done point by point and element by element: compiled where numba is installed."""

from collections.abc import Sequence
from functools import cache
from importlib.util import find_spec
from typing import Protocol

from backends._embedding.cones import Compliance, Inverse, Scaling
from backends._embedding.loops import plain
from backends._embedding.loops.plain import Indices
from lacore.arrays import Floats, Ints, Sparse


class Loops(Protocol):
    """See `backends._embedding.loops.plain`, whose functions these are."""

    @property
    def name(self) -> str:
        """Of the library."""

    def pattern(
        self, elements: Sequence[Ints], n: int
    ) -> tuple[Indices, Indices, list[Indices]]: ...

    def touched(self, matrix: Sparse, dim: int) -> tuple[Indices, Indices]: ...

    def dense(self, matrix: Sparse, points: Ints, columns: Ints, dim: int) -> Floats: ...

    def assembled(
        self,
        size: int,
        rows: Sequence[Floats],
        points: Sequence[Ints],
        places: Sequence[Indices],
        blocks: Sequence[Floats],
    ) -> Floats: ...

    def rates(self, matrix: Sparse, dim: int, velocity: Floats) -> Floats: ...

    def forces(self, matrix: Sparse, parts: Floats) -> Floats: ...

    def pulled(self, matrix: Sparse, stiff: Inverse, a: Floats, force: Floats) -> None: ...

    def moved(self, matrix: Sparse, stiff: Inverse, u: Floats, a: Floats, z: Floats) -> None: ...

    def times(
        self,
        matrix: Sparse,
        u: Floats,
        z: Floats,
        soft: Compliance,
        force: Floats,
        found: Floats,
    ) -> None: ...

    def framed(self, values: Floats, vectors: Floats, a: Floats) -> Floats: ...

    def frames(
        self, first: Scaling, others: Floats, slope: Floats, sheared: int
    ) -> tuple[Floats, Floats]: ...

    def along(self, soft: Compliance, free: float, rates: Floats, z: Floats) -> None: ...

    def scaled(self, s: Floats, z: Floats) -> Scaling: ...

    def heights(self, scaling: Scaling, wanted: Floats) -> Floats: ...

    def corrected(self, scaling: Scaling, ds: Floats, dz: Floats, mu: float) -> Floats: ...

    def banded(
        self,
        scaling: Scaling,
        ds: Floats,
        dz: Floats,
        share: float,
        band: tuple[float, float],
    ) -> Floats: ...

    def farthest(self, x: Floats, change: Floats) -> float: ...


def compiles() -> bool:
    """Whether numba is installed, which is not loaded."""
    return find_spec("numba") is not None


@cache
def best_loops() -> Loops:
    """Those of numba where it is installed, else those of NumPy."""
    try:
        # Here: numba takes a third of a second to load, and only this backend has a use for it.
        from backends._embedding.loops import compiled
    except ImportError:  # an extra
        return plain
    return compiled
