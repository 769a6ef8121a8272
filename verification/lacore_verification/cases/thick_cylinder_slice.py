r"""A slice of a thick tube, a = 1 and b = 2, bursts under internal pressure.

      axis                u_z = 0
        |          o--o--o--o--o--o--o
        |   alpha  |                 |
        |    -->   |      slice      |  free    height 1/2
        |          |                 |
        +----------o--o--o--o--o--o--o------- r
                   1      u_z = 0    2

The thick tube again, seen along its axis (r, z): a rectangle, and no error of the boundary.
Planes across the axis stay where they are. Triangles in crossed cells, cells cut once and
quadrilaterals answer it: plane strain rates of crossed triangles depend on each other, and here
they only nearly do.
"""

from math import log, sqrt

import lacore as la
from lacore_verification.case import SOLVER, Band, Case, Convergence, Order, Reference, Variant

INNER, OUTER, HEIGHT = 1.0, 2.0, 0.5
_ERRORS = {
    "crossed": Convergence(
        0.0039, 2.0, "32 to 8192 triangles: 3.8e-6, 2.5e-7, 1.6e-8, 9.8e-10, all above"
    ),
    "diagonal": Convergence(
        5.1e-4, 1.02, "16 to 1024 triangles: 3.2e-5, 6.8e-6, 1.6e-6, 4.0e-7, all above"
    ),
    "quadrilaterals": Convergence(
        0.00085, 2.0, "8 to 1200: 1.3e-5, 8.5e-7, 5.4e-8, 6.6e-10, all above"
    ),
}


def build(nx: int, ny: int, mesh: str) -> "la.Problem":
    """Return the problem: the slice; yield stress 1, so the load factor is in units of s0."""
    sides = (INNER, OUTER), (0, HEIGHT), nx, ny
    if mesh == "quadrilaterals":
        cells = la.meshes.quadrilaterals(*sides)
    else:
        cells = la.meshes.rectangle(*sides, crossed=mesh == "crossed")
    body = la.Body(
        cells,
        la.VonMises(yield_stress=1.0),
        kinematics="axisymmetric",
        space="q2" if mesh == "quadrilaterals" else "p2-gauss",
    )
    return la.Problem(
        bodies={"tube": body},
        supports=[la.Fix("tube", "bottom", "y"), la.Fix("tube", "top", "y")],
        reference_loads=[la.Pressure("tube", "left")],
    )


def reference(mesh: str) -> Reference:
    """Return the reference: the fully plastic tube."""
    return Reference(
        2 / sqrt(3) * log(OUTER / INNER),
        "(2/sqrt3) s0 ln(b/a)",
        "Hill, The Mathematical Theory of Plasticity; analytically",
        "exact",
    )


def band(elements: int, mesh: str) -> Band:
    """Return the band: interior strain points."""
    error = _ERRORS[mesh].two_sided(elements, "interior strain points.")
    return Band(
        below=error.below + SOLVER,
        above=error.above + SOLVER,
        reason=f"{error.reason} The solver, {SOLVER:g}, comes on top.",
    )


def order(mesh: str) -> Order | None:
    """Return the order of convergence.

    Of cells cut once; errors of the others, of order 2, are soon those of solving.
    """
    if mesh != "diagonal":
        return None
    return Order(
        tuple({"nx": 2 * n, "ny": n} for n in (2, 3, 4, 6, 8)),
        1.07,
        0.1,
        "Squared sizes, order 1 in elements. Measured: 1.07 over 16 to 256 triangles, falling"
        " towards 1.",
    )


CASE = Case(
    id="thick-cylinder-slice",
    title="Thick tube under internal pressure, axisymmetric",
    tags=("continuum", "axisymmetric", "closed form"),
    unit="pressure / s0",
    explanation=__doc__,
    hand_calculation="""\
equilibrium:  d sigma_r/dr = (sigma_t - sigma_r)/r
yield:        sigma_t - sigma_r = 2 k = (2/sqrt3) s0, as u_z = 0
integrate:    0 - (-alpha) = (2/sqrt3) s0 ln(b/a)
b/a = 2:      alpha = 0.800377 s0
""",
    meshes={
        "coarse": {"nx": 4, "ny": 2},
        "medium": {"nx": 18, "ny": 8},
        "fine": {"nx": 48, "ny": 25},
    },
    build=build,
    reference=reference,
    band=band,
    order=order,
    bracket=None,
    variants=tuple(
        Variant(mesh, {"mesh": mesh}) for mesh in ("crossed", "diagonal", "quadrilaterals")
    ),
)
