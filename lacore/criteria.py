"""Yield criteria (T1): what a strain rate costs, as rows of a cone. They know no solver."""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from lacore.arrays import Floats
from lacore.errors import InputError, is_number, require_known, require_range
from lacore.hardening import HardeningLaw, Perfect, require_hardening_law
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
        bound: largest norm of the conjugate stress, Pa.
        volumetric_factor: factor c such that ``||(rows @ eps, c theta)||`` is proportional to the
            norm of the three-dimensional strain rate deviator also where theta is not zero: the
            regularised dissipation (T17) sees that deviator.
    """

    rows: Floats
    volumetric: Floats
    bound: float
    volumetric_factor: float

    @property
    def compressible(self) -> bool:
        """Whether the plane velocity may change areas: plane stress."""
        return not np.any(self.volumetric)

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


@dataclass(frozen=True, repr=False)
class VonMises(Compact):
    """von Mises material, by its yield stress in shear `k` or in tension ``sqrt(3) k``, in Pa.

    Give one of the two, or a law of `lacore.hardening`, of which a limit load takes the initial
    yield stress. Source: T1, T29; Bousshine & Chaaba 2007, eq. (5).

    Raises:
        InputError: none or several given, not a positive finite number, not a law or one that
            softens.
    """

    shear_strength: float | None = None
    yield_stress: float | None = None
    hardening: HardeningLaw | None = None

    def __post_init__(self) -> None:
        given = {
            name: value
            for name, value in (
                ("shear_strength", self.shear_strength),
                ("yield_stress", self.yield_stress),
                ("hardening", self.hardening),
            )
            if value is not None
        }
        if len(given) != 1:
            raise InputError(
                "VonMises",
                sorted(given),
                "needs exactly one of shear_strength, yield_stress and hardening",
                "give VonMises(shear_strength=k) or VonMises(yield_stress=sqrt(3)*k), in Pa,"
                " or a law as VonMises(hardening=...)",
            )
        if self.hardening is not None:
            require_hardening_law("VonMises.hardening", self.hardening)
            return
        for name in given:
            value = getattr(self, name)
            if not (is_number(value) and value > 0):
                raise InputError(
                    f"VonMises.{name}", value, "not a positive number", "give a strength > 0 in Pa"
                )
            require_range(f"VonMises.{name}", value)

    @property
    def k(self) -> float:
        """Yield stress in shear, initial where it hardens, Pa."""
        if self.shear_strength is not None:
            return self.shear_strength
        return float(self.law.stress(np.zeros(1))[0]) / sqrt(3)

    @property
    def law(self) -> HardeningLaw:
        """Yield stress in tension over the equivalent plastic strain."""
        if self.hardening is not None:
            return self.hardening
        if self.yield_stress is not None:
            return Perfect(self.yield_stress)
        return Perfect(sqrt(3) * self.k)

    def conic_form(self, kinematics: str) -> ConicForm:
        """Cone of the dissipation (T1).

        Plane strain ``k ||(eps_xx - eps_yy, gamma)||``, theta = 0; plane stress
        ``k ||(2 eps_xx + eps_yy, sqrt(3) eps_yy, gamma)||``, where eps_zz keeps the volume;
        axisymmetric ``k ||(eps_rr - eps_zz, (eps_rr + eps_zz - 2 eps_tt)/sqrt(3), gamma)||``,
        theta = 0.
        """
        require_known("Body.kinematics", kinematics, KINEMATICS)
        if kinematics == "axisymmetric":
            share = 1 / sqrt(3)
            return ConicForm(
                rows=np.array([[1, -1, 0, 0], [share, share, -2 * share, 0], [0, 0, 0, 1]]),
                volumetric=np.array([1.0, 1.0, 1.0, 0.0]),
                bound=self.k,
                volumetric_factor=0.0,  # the rows have no part of theta
            )
        if kinematics == "plane_stress":
            return ConicForm(
                rows=np.array([[2.0, 1.0, 0.0], [0.0, sqrt(3), 0.0], [0.0, 0.0, 1.0]]),
                volumetric=np.zeros(3),
                bound=self.k,
                volumetric_factor=0.0,
            )
        return ConicForm(
            rows=np.array([[1.0, -1.0, 0.0], [0.0, 0.0, 1.0]]),
            volumetric=np.array([1.0, 1.0, 0.0]),
            bound=self.k,
            volumetric_factor=1 / sqrt(3),
        )
