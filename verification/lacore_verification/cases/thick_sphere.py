r"""A thick hollow sphere, radii a = 1 and b = 2, bursts under internal pressure.

        z
        | axis
        o - _
        o     ` .
        o         `.
        o _         `
          ` .  <-    \    a = 1, b = 2
       alpha  `.       \
          -->   \       |
                 |      |
    ------------ o oo o o ---- r
                  u_z = 0

Axisymmetric, a quarter of a meridian section modelled; u_r = 0 on the axis by itself. Edges are
curved: the nodes of a rectangle of radii and angles, on circles and rays. Triangles in crossed
cells and quadrilaterals of the same cells answer it.
"""

from math import pi

import lacore as la
from lacore_verification.case import SOLVER, Band, Case, Convergence, Order, Reference, Variant
from lacore_verification.cases.shared.cavities import INNER, OUTER, SPHERE, SPHERE_BURSTS, on_rays

_ERROR = Convergence(
    0.0306, 2.0, "quadrilaterals, 8 to 1200: 4.8e-4, 3.0e-5, 1.9e-6, 1.2e-7, 9.5e-9, all above"
)
_TRIANGLES = 3e-6  # twice the largest of 32 to 4896 triangles, 1.5e-6 at 72


def build(n_radial: int, n_angular: int, space: str) -> "la.Problem":
    """Return the problem: the quarter; yield stress 1, so the load factor is in units of s0."""
    make = la.meshes.quadrilaterals if space == "q2" else la.meshes.rectangle
    cells = make((INNER, OUTER), (0, pi / 2), n_radial, n_angular, grade_x=(INNER, OUTER / INNER))
    mesh = la.meshes.isoparametric(cells, on_rays)
    body = la.Body(mesh, la.VonMises(yield_stress=1.0), kinematics="axisymmetric", space=space)
    return la.Problem(
        bodies={"sphere": body},
        supports=[la.Fix("sphere", "bottom", "y")],
        reference_loads=[la.Pressure("sphere", "left")],
    )


def reference(space: str) -> Reference:
    """Return the reference: the fully plastic sphere."""
    return SPHERE


def band(elements: int, space: str) -> Band:
    """Return the band.

    Fourth order in the size of quadrilaterals; of crossed triangles even less is left.
    """
    if space == "q2":
        error = _ERROR.two_sided(elements, "interior strain points, curved edges.")
        allowed, reason = (
            error.above + SOLVER,
            f"{error.reason} The solver, {SOLVER:g}, comes on top.",
        )
    else:
        allowed = _TRIANGLES
        reason = (
            "Not a bound: interior strain points. Twice the largest error of 32 to 4896 triangles."
        )
    return Band(below=allowed, above=allowed, reason=reason)


def order(space: str) -> Order | None:
    """Return the order of convergence.

    Of quadrilaterals; errors of triangles are those of the solver.
    """
    if space != "q2":
        return None
    return Order(
        tuple({"n_radial": n, "n_angular": 2 * n} for n in (2, 3, 4, 6, 8)),
        2.0,
        0.05,
        "The solution is smooth: order 4 in the size of quadratic quadrilaterals with volumes kept"
        " against bilinear pressures, 2 in elements. Measured: 2.00 over 8 to 128.",
    )


CASE = Case(
    id="thick-sphere",
    title="Thick hollow sphere under internal pressure",
    tags=("continuum", "axisymmetric", "curved boundary", "closed form"),
    unit="pressure / s0",
    explanation=__doc__,
    hand_calculation=SPHERE_BURSTS,
    meshes={
        "coarse": {"n_radial": 2, "n_angular": 4},
        "medium": {"n_radial": 12, "n_angular": 12},
        "fine": {"n_radial": 34, "n_angular": 36},
    },
    build=build,
    reference=reference,
    band=band,
    order=order,
    bracket=None,
    variants=(
        Variant("triangles", {"space": "p2-gauss"}),
        Variant("quadrilaterals", {"space": "q2"}),
    ),
)
