"""Stiffness of points after elimination of all their planes, in principal directions."""

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
        vectors: V, one direction per column, shape (m, dim, dim).
        square: compliance across the flow, as in `lacore_backends._embedding.cones.Compliance`,
            shape (m,).
    """

    values: Floats
    vectors: Floats
    square: Floats

    @classmethod
    def of(cls, planes: Planes, scalings: Sequence[Scaling]) -> "Frame":
        """Return ``C = sum B_i^T W_i^2 B_i`` of planes with both kinds of cones."""
        first, others = scalings
        loops, (count, _, m) = planes.rows.loops, planes.slope.shape
        values, vectors = loops.frames(first, others.square, planes.slope, planes.sheared)
        squares = np.concatenate([first.square, others.square])
        return cls(values, vectors, squares.reshape(count, m).sum(axis=0))

    def pulled(self, rows: Rows, a: Floats, force: Floats) -> None:
        """Add ``matrix^T C a`` to a force."""
        force += rows.force(rows.loops.framed(self.values, self.vectors, a))

    def moved(self, rows: Rows, u: Floats, a: Floats, z: Floats) -> None:
        """Write ``C (a - matrix u)`` to z."""
        z[:] = rows.loops.framed(self.values, self.vectors, a - rows.at(u))

    def applied(self, rows: Rows, u: Floats, z: Floats, force: Floats, found: Floats) -> None:
        """Add ``matrix u + C z`` to `found`, and ``matrix^T z`` to a force."""
        found += rows.at(u) + rows.loops.framed(self.values, self.vectors, z)
        force += rows.force(z)

    def inverse(self, delta: Floats) -> "Frame":
        """Return ``(C + delta)^-1``."""
        return self.through(lambda c: np.asarray(1 / (c + delta)))

    def through(self, function: Callable[[Floats], Floats]) -> "Frame":
        """Return a function of C, given as a function of its eigenvalues."""
        return Frame(function(self.values), self.vectors, self.square)

    def along(self, steep: float, rates: Floats, z: Floats) -> None:
        """Add the z that corrects rates along flow directions.

        These are directions more than `steep` times as compliant as those across the flow.
        """
        flows = self.values > _STEEP * steep * self.square
        along = np.einsum("mij,im->jm", self.vectors, rates)
        share = np.where(flows, along / np.where(flows, self.values, 1.0), 0.0)
        z += np.einsum("mij,jm->im", self.vectors, share)

    @property
    def blocks(self) -> Floats:
        """Shape (dim, dim, m)."""
        found = np.einsum("mik,km,mjk->ijm", self.vectors, self.values, self.vectors)
        return np.ascontiguousarray(found)
