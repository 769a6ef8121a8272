"""What all planes of a point leave of its stiffness, in the frame of its principal directions."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Floats
from lacore_backends._embedding.cones import Scaling
from lacore_backends._embedding.pressure_dependent import Planes
from lacore_backends._embedding.rows import Rows

_STEEP = 4.0  # largest value of ``2 w w^T - J`` per w.w, along the edge of a cone


@dataclass(frozen=True)
class Frame:
    """``V values V^T`` of m points.

    Attributes:
        values: shape (dim, m).
        vectors: V, a direction a column, shape (m, dim, dim).
        square: of `lacore_backends._embedding.cones.Compliance`: across what flows, shape (m,).
    """

    values: Floats
    vectors: Floats
    square: Floats

    @classmethod
    def of(cls, planes: Planes, scalings: Sequence[Scaling]) -> "Frame":
        """``C = sum B_i^T W_i^2 B_i`` of planes, of both of their kinds of cones."""
        first, others = scalings
        loops, (count, _, m) = planes.rows.loops, planes.slope.shape
        values, vectors = loops.frames(first, others.square, planes.slope, planes.sheared)
        squares = np.concatenate([first.square, others.square])
        return cls(values, vectors, squares.reshape(count, m).sum(axis=0))

    def pulled(self, rows: Rows, a: Floats, force: Floats) -> None:
        """``matrix^T C a`` added to a force."""
        force += rows.force(rows.loops.framed(self.values, self.vectors, a))

    def moved(self, rows: Rows, u: Floats, a: Floats, z: Floats) -> None:
        """``C (a - matrix u)`` into z."""
        z[:] = rows.loops.framed(self.values, self.vectors, a - rows.at(u))

    def applied(self, rows: Rows, u: Floats, z: Floats, force: Floats, found: Floats) -> None:
        """``matrix u + C z`` added to what was found, and ``matrix^T z`` to a force."""
        found += rows.at(u) + rows.loops.framed(self.values, self.vectors, z)
        force += rows.force(z)

    def inverse(self, delta: Floats) -> "Frame":
        """``(C + delta)^-1``."""
        return self.through(lambda c: np.asarray(1 / (c + delta)))

    def through(self, function: Callable[[Floats], Floats]) -> "Frame":
        """The function of C that its eigenvalues have."""
        return Frame(function(self.values), self.vectors, self.square)

    def along(self, steep: float, rates: Floats, z: Floats) -> None:
        """Add what makes up for rates along what flows: more than `steep` times across it."""
        flows = self.values > _STEEP * steep * self.square
        along = np.einsum("mij,im->jm", self.vectors, rates)
        share = np.where(flows, along / np.where(flows, self.values, 1.0), 0.0)
        z += np.einsum("mij,jm->im", self.vectors, share)

    @property
    def blocks(self) -> Floats:
        """Shape (dim, dim, m)."""
        found = np.einsum("mik,km,mjk->ijm", self.vectors, self.values, self.vectors)
        return np.ascontiguousarray(found)
