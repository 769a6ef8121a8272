r"""A thick tube of inner radius a = 1 and outer radius b = 2 bursts under internal pressure.

          o - _
          o     ` .
    u_x=0 o         `.
          o _         `
            ` .  <-    \    a = 1, b = 2
        alpha  `.       \
           -->   \       |
                  |      |
                  o oo o o
                   u_y = 0

Plane strain, a quarter modelled. There is no contact: the case tests the continuum, and curved
boundaries. The mesh replaces both circles by polygons, so its value is not a bound.
"""

from math import cos, log, pi, sqrt

import lacore as la
from lacore_verification.case import Band, Case, Convergence, Order, Reference, Variant
from lacore_verification.case.band import Bracketing

INNER, OUTER = 1.0, 2.0
_MESHES = {
    "coarse": {"n_radial": 2, "n_angular": 4},
    "medium": {"n_radial": 9, "n_angular": 16},
    "fine": {"n_radial": 26, "n_angular": 46},
}
_ERROR = Convergence(
    0.372, 0.974, "72 to 4784 elements: 0.577, 0.323, 0.105, 0.051, 0.021, 0.010 %, all above"
)


def build(n_radial: int, n_angular: int) -> "la.Problem":
    """Return the problem: the quarter; yield stress 1, so the load factor is in units of s0."""
    mesh = la.meshes.quarter_ring(INNER, OUTER, n_radial, n_angular, grade=OUTER / INNER)
    return la.Problem(
        bodies={"tube": la.Body(mesh, la.VonMises(yield_stress=1.0), geometry="approximated")},
        supports=[la.Fix("tube", "x_axis", "y"), la.Fix("tube", "y_axis", "x")],
        reference_loads=[la.Pressure("tube", "bore")],
    )


def reference() -> Reference:
    """Return the reference: the fully plastic tube."""
    return Reference(
        2 / sqrt(3) * log(OUTER / INNER),
        "(2/sqrt3) s0 ln(b/a)",
        "Hill, The Mathematical Theory of Plasticity; analytically",
        "exact",
    )


def band(elements: int) -> Band:
    """Return the band: straight edges on curved boundaries."""
    return _ERROR.two_sided(elements, "straight edges replace the circles.")


def order() -> Order:
    """Return the order of convergence: that of the elements and of the polygon."""
    return Order(
        tuple({"n_radial": n, "n_angular": 2 * n} for n in (2, 4, 6, 8, 10)),
        1.0,
        0.05,
        "The solution is smooth, both quadratic velocities and a polygon for the circles leave an"
        " error of squared mesh sizes: order 1 in elements. Measured: 1.006 +- 0.004 (95 %).",
    )


def _bracketing(mesh: str) -> Bracketing:
    """Return load factors of rings that the polygon contains, and in which it is contained."""
    turn = pi / 2 / _MESHES[mesh]["n_angular"]
    off = -log(cos(turn / 2)) / log(OUTER / INNER)
    return Bracketing(
        mesh=mesh,
        below=off,
        above=off,
        reason="the polygons lie between rings of b/a times cos(turn/2) and by it, turn the angle"
        f" of an edge, whose load factors differ from the reference by {off:.3%}",
    )


CASE = Case(
    id="thick-cylinder",
    title="Thick tube under internal pressure",
    tags=("continuum", "curved boundary", "closed form"),
    unit="pressure / s0",
    explanation=__doc__,
    hand_calculation="""\
equilibrium:  d sigma_r/dr = (sigma_t - sigma_r)/r
yield:        sigma_t - sigma_r = 2 k = (2/sqrt3) s0  (plane strain)
integrate:    0 - (-alpha) = (2/sqrt3) s0 ln(b/a)
b/a = 2:      alpha = 0.800377 s0
""",
    meshes=_MESHES,
    build=build,
    reference=reference,
    band=band,
    order=order,
    bracket=_bracketing("medium"),
    variants=(Variant("burst", {}),),
)
