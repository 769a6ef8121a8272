"""Unknowns of a step or right-hand sides: one array, and views of its parts."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lacore.numerics.arrays import Floats
from lacore_backends._embedding.arrays import Conic


class Layout:
    """Places of the parts in the array of a `Vector`."""

    def __init__(self, conic: Conic) -> None:
        shapes = [(rows.dim, rows.count) for rows in conic.kinds]
        ends = np.cumsum([conic.load.size, *(a * b for a, b in shapes)])
        self.force = slice(0, int(ends[0]))
        self.parts = [
            (slice(int(a), int(b)), shape)
            for a, b, shape in zip(ends[:-1], ends[1:], shapes, strict=True)
        ]
        self.costly = len(conic.costly)
        self.free = self.costly + len(conic.free)
        self.size = int(ends[-1]) + 2  # The last two entries are lambda and tau.

    def zeros(self) -> "Vector":
        """Return a vector of zeros."""
        return Vector(self, np.zeros(self.size))


@dataclass(frozen=True)
class Vector:
    """u, z, r and zeta of cones and planes, p, lambda and tau; or right-hand sides.

    Attributes:
        layout: layout of the array.
        data: shape (size,).
    """

    layout: Layout
    data: Floats

    @property
    def force(self) -> Floats:
        """Velocities, shape (n,)."""
        return self.data[self.layout.force]

    @cached_property
    def parts(self) -> tuple[Floats, ...]:
        """Multipliers of all kinds of rows, shape (dim, m) each, those of E last."""
        return tuple(self.data[own].reshape(shape) for own, shape in self.layout.parts)

    @property
    def costly(self) -> tuple[Floats, ...]:
        """Stresses of costly cones."""
        return self.parts[: self.layout.costly]

    @property
    def free(self) -> tuple[Floats, ...]:
        """Pressures of free cones."""
        return self.parts[self.layout.costly : self.layout.free]

    @property
    def planes(self) -> tuple[Floats, ...]:
        """Stresses of planes."""
        return self.parts[self.layout.free : -1]

    @property
    def equal(self) -> Floats:
        """Multipliers of E, shape (m,)."""
        return np.asarray(self.parts[-1][0])

    @property
    def load(self) -> float:
        """The multiplier of the load."""
        return float(self.data[-2])

    @property
    def tau(self) -> float:
        """Variable of the embedding."""
        return float(self.data[-1])

    def plus(self, other: "Vector", share: float = 1.0) -> "Vector":
        """Return the sum with a share of the other vector."""
        return Vector(self.layout, self.data + share * other.data)
