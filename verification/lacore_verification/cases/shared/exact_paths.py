"""Exact paths of hardening bodies (T33): thick shells under pressure, strips and bars.

They use no elements and are the references of sequential limit analysis.
"""

from dataclasses import dataclass
from math import exp, log, sqrt

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import spence

from lacore.model.materials.hardening import HardeningLaw, Linear, Perfect, Voce
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError, require_positive

_WHOLE = 1e-12  # For exponents: a hundredth of the required accuracy of a closed form.
_GROWTH = np.geomspace(1e-6, 1e3, 2000)  # Bore radii that are searched for a peak.


@dataclass(frozen=True)
class Shell:
    """A thick cylinder or a hollow sphere that a pressure in the bore expands; see `cylinder`.

    Attributes:
        law: of hardening.
        inner, outer: initial radii, m.
        dimension: 2 of a cylinder in plane strain, 3 of a sphere.

    Raises:
        InputError: radii that are not positive or not in order, another dimension.
    """

    law: HardeningLaw
    inner: float
    outer: float
    dimension: int

    def __post_init__(self) -> None:
        require_positive("Shell.inner", self.inner)
        require_positive("Shell.outer", self.outer)
        if self.outer <= self.inner:
            raise InputError(
                "Shell.outer", self.outer, "not outside the bore", f"give more than {self.inner!r}"
            )

        if self.dimension not in (2, 3):
            raise InputError(
                "Shell.dimension", self.dimension, "neither cylinder nor sphere", "give 2 or 3"
            )

    @property
    def factor(self) -> float:
        """Equivalent strain over ``ln(r/R)``, and ``dp/dr`` over ``sigma_Y/r``."""
        return 2 / sqrt(3) if self.dimension == 2 else 2.0


@dataclass(frozen=True)
class Peak:
    """The largest pressure [Pa] of a path, and the radius [m] of the bore at it."""

    radius: float
    pressure: float

    def __str__(self) -> str:
        return f"{self.pressure:.6f} at a = {self.radius:.6g}"


def cylinder(law: HardeningLaw, inner: float = 1.0, outer: float = 2.0) -> Shell:
    """Return a thick cylinder in plane strain."""
    return Shell(law, inner, outer, 2)


def sphere(law: HardeningLaw, inner: float = 1.0, outer: float = 2.0) -> Shell:
    """Return a hollow sphere."""
    return Shell(law, inner, outer, 3)


def outer_radius(shell: Shell, bore: float) -> float:
    """Return the current outer radius, m, at a bore of current radius `bore`: the volume stays."""
    n = shell.dimension
    return float((shell.outer**n + _swept(shell, bore)) ** (1 / n))


def strain(shell: Shell, bore: float, radius: Floats) -> Floats:
    """Return the equivalent plastic strains at current radii [m], those of the bore included."""
    n = shell.dimension
    return np.asarray(-shell.factor / n * np.log1p(-_swept(shell, bore) / radius**n))


def bore_strain(shell: Shell, bore: float) -> float:
    """Return the equivalent plastic strain at the bore, the largest."""
    _swept(shell, bore)
    return shell.factor * log(bore / shell.inner)


def pressure(shell: Shell, bore: float) -> float:
    """Return the pressure, Pa, at a bore of current radius `bore` [m]: closed form or quadrature.

    Raises:
        InputError: the bore is smaller than at the beginning.
    """
    closed = closed_form(shell, bore)
    return quadrature(shell, bore) if closed is None else closed


def closed_form(shell: Shell, bore: float) -> float | None:
    """Return `pressure` of `Perfect`, `Linear` and `Voce` (T33).

    None where there is no closed form.

    For Voce there is a finite one where ``m = rate factor/dimension`` is an integer. Otherwise it
    needs a hypergeometric function that SciPy 1.17 does not compute near the bore.
    """
    n, f, law = shell.dimension, shell.factor, shell.law
    swept, b = _swept(shell, bore), outer_radius(shell, bore)
    u_a, u_b = swept / bore**n, swept / b**n
    match law:
        case Perfect():
            hardened = 0.0
        case Linear():
            hardened = law.slope * f / n * float(_dilogarithm(u_a) - _dilogarithm(u_b))
        case Voce() if (m := _whole(law.rate * f / n)) > 0:
            rise = law.saturation - law.yield_stress
            hardened = rise * (_saturating(u_a, m) - _saturating(u_b, m))
        case _:
            return None
    return f * (law.yield_stress * log(b / bore) + hardened / n)


def quadrature(shell: Shell, bore: float) -> float:
    """Return `pressure` of any law, by adaptive integration over ``ln r``, to 1e-12."""

    def yield_stress(log_radius: float) -> float:
        at = strain(shell, bore, np.array([exp(log_radius)]))
        return float(shell.law.stress(at)[0])

    ends = log(bore), log(outer_radius(shell, bore))
    return shell.factor * float(quad(yield_stress, *ends, epsabs=0.0, epsrel=1e-12, limit=500)[0])


def peak(shell: Shell) -> Peak:
    """Return the largest pressure of the path, where ``dp/da`` vanishes (T33), or at the beginning.

    Raises:
        InputError: the pressure still rises at a bore of a thousand initial radii.
    """
    radii = shell.inner * (1 + _GROWTH)
    rising = np.array([_slope(shell, radius) for radius in radii]) > 0
    if rising[-1]:
        raise InputError(
            "Shell.law", shell.law, f"no peak up to a bore of {radii[-1]:.3g} m", "harden it less"
        )
    turns = np.flatnonzero(rising[:-1] & ~rising[1:])
    found = [brentq(lambda a: _slope(shell, a), radii[i], radii[i + 1], xtol=1e-14) for i in turns]
    peaks = [Peak(float(a), pressure(shell, float(a))) for a in (shell.inner, *found)]
    return max(peaks, key=lambda candidate: candidate.pressure)


def strip_force(law: HardeningLaw, length: float, width: float = 1.0) -> float:
    """Return the force [N/m] on a strip in plane strain without friction, tension or compression.

    Args:
        law: of hardening.
        length: current length over the initial one.
        width: initial, m.
    """
    f = 2 / sqrt(3)
    return f * _stress(law, f * abs(log(length))) * width / length


def bar_force(law: HardeningLaw, length: float, section: float = 1.0) -> float:
    """Return the force [N] on a round bar or disc without friction, tension or compression.

    Args:
        law: of hardening.
        length: current length over the initial one.
        section: initial, m^2.
    """
    return _stress(law, abs(log(length))) * section / length


def _stress(law: HardeningLaw, at: float) -> float:
    return float(law.stress(np.array([at]))[0])


def _swept(shell: Shell, bore: float) -> float:
    """Return ``c = r^n - R^n``, the same for all particles."""
    if not bore >= shell.inner:
        raise InputError(
            "bore", bore, "smaller than at the beginning", f"give at least {shell.inner!r}"
        )
    return bore**shell.dimension - shell.inner**shell.dimension


def _slope(shell: Shell, bore: float) -> float:
    """Return ``dp/da`` except for a positive factor."""
    n, b = shell.dimension, outer_radius(shell, bore)
    inside = _stress(shell.law, bore_strain(shell, bore)) * (shell.inner / bore) ** n
    outside = _stress(shell.law, shell.factor * log(b / shell.outer)) * (shell.outer / b) ** n
    return inside - outside


def _dilogarithm(u: float) -> float:
    return float(spence(1 - u))


def _whole(m: float) -> int:
    return round(m) if abs(m - round(m)) <= _WHOLE * m else 0


def _saturating(u: float, m: int) -> float:
    """Return ``E(u) = int_0^u (1 - (1-s)^m) ds/s``."""
    k = np.arange(1, m + 1)
    return float(np.sum((1 - (1 - u) ** k) / k))
