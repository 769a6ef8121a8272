"""Loops over points and elements, compiled if numba is installed."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib.util import find_spec
from typing import Protocol

from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore_backends._embedding.cones import Compliances, Eliminated, Inverses, Scaling
from lacore_backends._embedding.loops import plain
from lacore_backends._embedding.loops.plain import Indices
from lacore_backends._embedding.loops.stack import Stack


class Loops(Protocol):
    """Protocol of the functions of `lacore_backends._embedding.loops.plain`."""

    @property
    def name(self) -> str:
        """Name of the library."""

    def pattern(
        self, elements: Sequence[Ints], n: int
    ) -> tuple[Indices, Indices, list[Indices]]: ...

    def touched(
        self, starts: Indices, columns: Indices, dim: int, n: int
    ) -> tuple[Indices, Indices]: ...

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

    def pulled(self, stack: Stack, stiff: Inverses, right: Floats, force: Floats) -> None: ...

    def moved(self, stack: Stack, stiff: Inverses, right: Floats, x: Floats) -> None: ...

    def times(self, stack: Stack, soft: Compliances, x: Floats, out: Floats) -> None: ...

    def along(
        self, stack: Stack, soft: Compliances, steep: float, left: Floats, x: Floats
    ) -> None: ...

    def inverted(self, stack: Stack, soft: Compliances, delta: Floats) -> Inverses: ...

    def blocks(self, stack: Stack, stiff: Inverses) -> list[Floats]: ...

    def framed(self, values: Floats, vectors: Floats, a: Floats) -> Floats: ...

    def frames(
        self, first: Scaling, others: Floats, slope: Floats, sheared: int
    ) -> tuple[Floats, Floats]: ...

    def scaled(self, s: Floats, z: Floats) -> Scaling: ...

    def eliminated(
        self, scaling: Scaling, cost: Floats, rise: Floats, lead: Floats, tau: float
    ) -> Eliminated: ...

    def reduced(
        self,
        own: Eliminated,
        rise: Floats,
        height: Floats,
        missed: Floats,
        share: float,
        right: Floats,
    ) -> Floats: ...

    def strained(
        self,
        scaling: Scaling,
        own: Eliminated,
        costs: tuple[Floats, Floats],
        given: tuple[Floats, Floats],
        tau: float,
        z: Floats,
    ) -> Floats: ...

    def flowed(self, scaling: Scaling, height: Floats, z: Floats) -> Floats: ...

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
    """Return whether numba is installed, without loading it."""
    return find_spec("numba") is not None


@cache
def best_loops() -> Loops:
    """Return the loops of numba if it is installed, else those of NumPy."""
    try:
        # Import it here, because numba takes a third of a second to load and only this backend uses
        # it.
        from lacore_backends._embedding.loops import compiled
    except ImportError:  # numba is an optional dependency.
        return plain
    return compiled
