"""Yield criterion of von Mises (T1), perfectly plastic or hardening (T29)."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan, sqrt

import numpy as np

from lacore.model.materials.conic_form import KINEMATICS, SPACE, ConicForm
from lacore.model.materials.fields import Field, Given, Strength, number_told, taken
from lacore.model.materials.hardening import HardeningLaw, Perfect, require_hardening_law
from lacore.reporting.errors import InputError, is_number, require_known, require_range
from lacore.reporting.showing import Compact
from lacore.reporting.text import Symbol, Term, text


@dataclass(frozen=True, repr=False)
class VonMises(Compact):
    """Von Mises material, by its yield stress in shear `k` or in tension ``sqrt(3) k``, in Pa.

    Give one of the two, as a number or varying with place (a `lacore.Field`, a function of
    coordinates of shape (2, n), or a value for each element), or a law of `lacore.hardening`, whose
    initial yield stress a limit load uses. Source: T1, T29; Bousshine & Chaaba 2007, eq. (5).

    Raises:
        InputError: none or several given, a number that is not positive and finite, an invalid law
            or one that softens.

    Example:
        >>> clay = la.VonMises(shear_strength=20e3)  # Pa: 20 kPa
        >>> steel = la.VonMises(hardening=la.hardening.Linear(yield_stress=235e6, slope=1e9))
        >>> steel.shear_strength
    """

    shear_strength: Given | Field | None = None
    yield_stress: Given | Field | None = None
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
                text(
                    "give {}",
                    Term(
                        "VonMises(shear_strength=k) or VonMises(yield_stress=sqrt(3)*k), in Pa,"
                        " or a law as VonMises(hardening=...)",
                        "shear_strength, yield_stress or hardening",
                    ),
                ),
            )
        if self.hardening is not None:
            require_hardening_law("VonMises.hardening", self.hardening)
            return
        for name in given:
            value = taken(f"VonMises.{name}", getattr(self, name))
            object.__setattr__(self, name, value)
            if isinstance(value, Field):
                continue
            if not (is_number(value) and value > 0):
                raise InputError(
                    f"VonMises.{name}", value, "not a positive number", "give a strength > 0 in Pa"
                )
            require_range(f"VonMises.{name}", value)

    @property
    def k(self) -> Strength:
        """Yield stress in shear, initial where it hardens, Pa; a `Field` where it varies."""
        if self.shear_strength is not None:
            return self.shear_strength  # type: ignore[return-value]  # as `taken` leaves it
        if isinstance(self.yield_stress, Field):
            return self.yield_stress / sqrt(3)
        assert self.law is not None
        return float(self.law.stress(np.zeros(1))[0]) / sqrt(3)

    @property
    def strength(self) -> float:
        """See `k`; NaN if it varies."""
        return nan if isinstance(self.k, Field) else self.k

    @property
    def label(self) -> str:
        """Text on its shear strength."""
        first = "" if self.hardening is None else "hardening, at first "
        return text("{}{}", first, number_told(Symbol("k"), self.k))

    @property
    def law(self) -> HardeningLaw | None:
        """Yield stress in tension over the equivalent plastic strain; None if it varies."""
        if self.hardening is not None:
            return self.hardening
        if isinstance(self.yield_stress, Field) or isinstance(self.shear_strength, Field):
            return None
        if self.yield_stress is not None:
            return Perfect(self.yield_stress)  # type: ignore[arg-type]  # a number, checked
        return Perfect(sqrt(3) * self.k)  # type: ignore[arg-type]  # a number, checked

    def weakened(self, factor: float) -> VonMises:
        """Return a perfectly plastic material, with its initial strength divided by a factor."""
        return VonMises(shear_strength=self.k / factor)

    def conic_form(self, kinematics: str) -> ConicForm:
        """Return the cone of the dissipation (T1).

        Plane strain: ``k ||(eps_xx - eps_yy, gamma)||``, theta = 0. Plane stress: ``k ||(2 eps_xx +
        eps_yy, sqrt(3) eps_yy, gamma)||``, where eps_zz keeps the volume. Axisymmetric: ``k
        ||(eps_rr - eps_zz, (eps_rr + eps_zz - 2 eps_tt)/sqrt(3), gamma)||``, theta = 0. Three
        dimensions: five rows, theta = 0 (T89).
        """
        require_known("Body.kinematics", kinematics, KINEMATICS)
        if kinematics == SPACE:
            share = 1 / sqrt(3)
            rows = np.zeros((5, 6))
            rows[0, :2] = 1.0, -1.0
            rows[1, :3] = -share, -share, 2 * share
            rows[2:, 3:] = np.eye(3)
            return ConicForm(
                rows=rows,
                volumetric=np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]),
                bound=self.k,
            )
        if kinematics == "axisymmetric":
            share = 1 / sqrt(3)
            return ConicForm(
                rows=np.array([[1, -1, 0, 0], [share, share, -2 * share, 0], [0, 0, 0, 1]]),
                volumetric=np.array([1.0, 1.0, 1.0, 0.0]),
                bound=self.k,
            )
        if kinematics == "plane_stress":
            return ConicForm(
                rows=np.array([[2.0, 1.0, 0.0], [0.0, sqrt(3), 0.0], [0.0, 0.0, 1.0]]),
                volumetric=np.zeros(3),
                bound=self.k,
                out_of_plane=0.0,
            )
        return ConicForm(
            rows=np.array([[1.0, -1.0, 0.0], [0.0, 0.0, 1.0]]),
            volumetric=np.array([1.0, 1.0, 0.0]),
            bound=self.k,
            volumetric_factor=1 / sqrt(3),
        )
