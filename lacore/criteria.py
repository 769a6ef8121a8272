"""Yield criteria (T1): what a strain rate costs, as rows of a cone. They know no solver."""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from lacore.arrays import Floats
from lacore.errors import InputError, is_number, require_known

KINEMATICS = ("plane_strain",)


@dataclass(frozen=True)
class ConicForm:
    """Dissipation ``D = bound * ||rows @ eps||`` with, where given, ``volumetric @ eps = 0``.

    `eps` is the strain rate in engineering components (xx, yy, gamma_xy), unit 1/s.

    Attributes:
        rows: cone rows, shape (dim, 3).
        volumetric: row of theta = tr eps, shape (3,).
        bound: largest norm of the conjugate stress, Pa.
        volumetric_factor: factor c such that ``||(rows @ eps, c theta)||`` is proportional to the
            norm of the three-dimensional strain rate deviator also where theta is not zero: the
            regularised dissipation (T17) sees that deviator.
    """

    rows: Floats
    volumetric: Floats
    bound: float
    volumetric_factor: float


@dataclass(frozen=True)
class VonMises:
    """von Mises material, by its yield stress in shear `k` or in tension ``sqrt(3) k``, in Pa.

    Give one of the two. Source: T1; Bousshine & Chaaba 2007, eq. (5).

    Raises:
        InputError: none or both given, or not a positive finite number.
    """

    shear_strength: float | None = None
    yield_stress: float | None = None

    def __post_init__(self) -> None:
        given = {
            name: value
            for name, value in (
                ("shear_strength", self.shear_strength),
                ("yield_stress", self.yield_stress),
            )
            if value is not None
        }
        if len(given) != 1:
            raise InputError(
                "VonMises",
                sorted(given),
                "needs exactly one of shear_strength and yield_stress",
                "give VonMises(shear_strength=k) or VonMises(yield_stress=sqrt(3)*k), in Pa",
            )
        for name, value in given.items():
            if not (is_number(value) and value > 0):
                raise InputError(
                    f"VonMises.{name}", value, "not a positive number", "give a strength > 0 in Pa"
                )

    @property
    def k(self) -> float:
        """Yield stress in shear, Pa."""
        if self.shear_strength is not None:
            return self.shear_strength
        assert self.yield_stress is not None
        return self.yield_stress / sqrt(3)

    def conic_form(self, kinematics: str) -> ConicForm:
        """Cone of the dissipation: plane strain ``k ||(eps_xx - eps_yy, gamma)||``, theta = 0."""
        require_known("Body.kinematics", kinematics, KINEMATICS)
        return ConicForm(
            rows=np.array([[1.0, -1.0, 0.0], [0.0, 0.0, 1.0]]),
            volumetric=np.array([1.0, 1.0, 0.0]),
            bound=self.k,
            volumetric_factor=1 / sqrt(3),
        )
