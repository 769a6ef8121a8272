"""What a strain rate costs, as rows of a cone: the form that criteria take (T1)."""

from dataclasses import dataclass

import numpy as np

from lacore.arrays import Floats, Ints
from lacore.showing import Compact

KINEMATICS = ("plane_strain", "plane_stress", "axisymmetric")


@dataclass(frozen=True, repr=False)
class ConicForm(Compact):
    """Dissipation ``D = bound * ||rows @ eps||`` with ``volumetric @ eps = 0``.

    `eps` is the strain rate in engineering components (xx, yy, gamma_xy), of axisymmetric bodies
    (rr, zz, tt, gamma_rz), unit 1/s.

    Attributes:
        rows: cone rows, shape (dim, components).
        volumetric: row of theta = tr eps where it must vanish, else zeros, shape (components,).
        bound: largest norm of the conjugate stress, Pa; of all elements, or of each, (elements,).
        volumetric_factor: factor c such that ``||(rows @ eps, c theta)||`` is proportional to the
            norm of the three-dimensional strain rate deviator also where theta is not zero: the
            regularised dissipation (T17) sees that deviator.
    """

    rows: Floats
    volumetric: Floats
    bound: float | Floats
    volumetric_factor: float

    @property
    def compressible(self) -> bool:
        """Whether the plane velocity may change areas: plane stress."""
        return not np.any(self.volumetric)

    def bounds(self, elements: Ints) -> Floats:
        """The bound in elements, of their shape, Pa."""
        if np.ndim(self.bound) == 0:
            return np.full(np.shape(elements), self.bound, dtype=np.float64)
        return np.asarray(np.asarray(self.bound)[elements])

    def stress(self, conjugate: Floats, mean: Floats) -> Floats:
        """Stresses (xx, yy, zz, xy) or (rr, zz, tt, rz), shape (m, 4), Pa, tension positive.

        Args:
            conjugate: of `rows`, shape (m, dim), Pa.
            mean: of `volumetric`, shape (m,), Pa; in plane strain also sigma_zz (T1).
        """
        plane = conjugate @ self.rows + mean[:, None] * self.volumetric
        if plane.shape[1] == 4:
            return np.asarray(plane)
        out = np.zeros_like(mean) if self.compressible else mean
        return np.column_stack([plane[:, :2], out, plane[:, 2]])

    def across(self) -> "ConicForm":
        """The same for a layer in which only ``(eps_nn, gamma_nt)`` vary: a velocity jump (T23).

        `rows` and `volumetric` act on these two. Of an isotropic criterion.
        """
        axes = np.array([0, 2])
        rows, factor = self.rows[:, axes], self.volumetric_factor
        if not self.compressible:  # eps_nn = theta = 0: it stays in regularised norms only
            factor = float(np.hypot(np.linalg.norm(rows[:, 0]), factor))
            rows = rows * np.array([0.0, 1.0])
        return ConicForm(rows[rows.any(axis=1)], self.volumetric[axes], self.bound, factor)
