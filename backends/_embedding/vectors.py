"""Unknowns of a step, or right-hand sides: one array, and views of its parts."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from backends._embedding.arrays import Conic
from lacore.arrays import Floats


class Layout:
    """Where what is in the array of a `Vector`."""

    def __init__(self, conic: Conic) -> None:
        shapes = [(one.rows.dim, one.rows.count) for one in conic.costly]
        shapes += [(kind.rows.dim, kind.rows.count) for kind in conic.free]
        ends = np.cumsum([conic.load.size, conic.equal.count, *(a * b for a, b in shapes)])
        self.force = slice(0, int(ends[0]))
        self.equal = slice(int(ends[0]), int(ends[1]))
        parts = [
            (slice(int(a), int(b)), shape)
            for a, b, shape in zip(ends[1:-1], ends[2:], shapes, strict=True)
        ]
        self.costly, self.free = parts[: len(conic.costly)], parts[len(conic.costly) :]
        self.size = int(ends[-1]) + 2  # and lambda and tau

    def zeros(self) -> "Vector":
        """Nothing."""
        return Vector(self, np.zeros(self.size))


@dataclass(frozen=True)
class Vector:
    """u, p, z of costly cones, r of free cones, lambda and tau; or forces, rates, and so on.

    Attributes:
        layout: of the array.
        data: shape (size,).
    """

    layout: Layout
    data: Floats

    @property
    def force(self) -> Floats:
        """Velocities, shape (n,)."""
        return self.data[self.layout.force]

    @property
    def equal(self) -> Floats:
        """Multipliers of E."""
        return self.data[self.layout.equal]

    @cached_property
    def costly(self) -> tuple[Floats, ...]:
        """Stresses of costly cones, shape (d, m) each."""
        return tuple(self.data[own].reshape(shape) for own, shape in self.layout.costly)

    @cached_property
    def free(self) -> tuple[Floats, ...]:
        """Pressures of free cones, shape (dim, m) each."""
        return tuple(self.data[own].reshape(shape) for own, shape in self.layout.free)

    @property
    def load(self) -> float:
        """The multiplier of the load."""
        return float(self.data[-2])

    @property
    def tau(self) -> float:
        """Of the embedding."""
        return float(self.data[-1])

    def plus(self, other: "Vector", share: float = 1.0) -> "Vector":
        """The sum, of a share of the other."""
        return Vector(self.layout, self.data + share * other.data)
