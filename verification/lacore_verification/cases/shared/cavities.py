"""Thick tubes and spheres of soil under pressure from inside: a quarter, and its load."""

from math import log, pi, radians, sin, tan

import numpy as np

import lacore as la
from lacore.numerics.arrays import Floats
from lacore_verification.case import SOLVER, Band, Convergence, Reference

INNER, OUTER, C = 1.0, 2.0, 1.0
MESHES = {
    "coarse": {"n_radial": 2, "n_angular": 4},
    "medium": {"n_radial": 12, "n_angular": 12},
    "fine": {"n_radial": 34, "n_angular": 36},
}


SPHERE = Reference(
    2 * log(OUTER / INNER),
    "2 s0 ln(b/a)",
    "Hill, The Mathematical Theory of Plasticity; analytically",
    "exact",
)
"""The fully plastic sphere of von Mises's material."""
SPHERE_BURSTS = """\
equilibrium:  d sigma_r/dr = 2 (sigma_t - sigma_r)/r
yield:        sigma_t - sigma_r = s0  (two equal hoop stresses)
integrate:    0 - (-alpha) = 2 s0 ln(b/a)
b/a = 2:      alpha = 1.386294 s0
"""


def quarter(
    n_radial: int, n_angular: int, angle: float, dilation: float, kinematics: str
) -> "la.Problem":
    """Return a quarter of a tube (plane strain) or a sphere (axisymmetric), curved, cohesion 1."""
    flat = la.meshes.rectangle(
        (INNER, OUTER), (0, pi / 2), n_radial, n_angular, grade_x=(INNER, OUTER / INNER)
    )
    mesh = la.meshes.isoparametric(flat, on_rays)
    supports = [la.Fix("soil", "bottom", "y")]
    if kinematics == "plane_strain":
        supports.append(la.Fix("soil", "top", "x"))
    soil = la.MohrCoulomb(C, angle, dilation_angle=dilation if dilation < angle else None)
    return la.Problem(
        bodies={"soil": la.Body(mesh, soil, kinematics=kinematics, space="p2-gauss")},
        supports=supports,
        reference_loads=[la.Pressure("soil", "left")],
    )


def on_rays(x: Floats) -> Floats:
    """Return places from radii and angles, with the axis free of round-off."""
    radius, angle = x
    ray = np.stack([np.where(angle == pi / 2, 0.0, np.cos(angle)), np.sin(angle)])
    return np.asarray(radius * ray)


def expansion(angle: float, hoops: int) -> Reference:
    """Return the pressure, of a tube with one hoop stress, or of a sphere with two."""
    ratio, phi = OUTER / INNER, radians(angle)
    if not angle:
        value = 2 * hoops * C * log(ratio)
    else:
        value = C / tan(phi) * (ratio ** (2 * hoops * sin(phi) / (1 + sin(phi))) - 1)
    return Reference(
        value,
        f"c cot(phi) ((b/a)^({2 * hoops} sin(phi)/(1 + sin(phi))) - 1)",
        "equilibrium and yield integrated along the radius, analytically",
        "exact",
    )


def smooth(error: Convergence, elements: int) -> Band:
    """Return a smooth solution on curved edges.

    Fine meshes leave less than the solver, on top of it.
    """
    own = error.two_sided(elements, "interior strain points, curved edges.")
    return Band(
        below=own.below + SOLVER,
        above=own.above + SOLVER,
        reason=f"{own.reason} The solver, {SOLVER:g}, comes on top.",
    )
