r"""A thick tube of soil is driven apart until its bore has grown by half.

      r = 1                r = 2
        +--------------------+  u_z = 0
    p ->|                    |
    p ->|                    |  free      cohesion 1, friction angle phi, dilates by psi = phi
        +--------------------+  u_z = 0
        |                          z
        |--> bore: a from 1 to 1.5 |__ r

A slice of the axisymmetric body (r, z), without axial motion; the pressure follows the bore, which
controls the path. Nothing hardens. The flow rule fixes how each particle moves, and so how much
the tube grows: as it dilates the wall thins less, and the pressure falls less, than without
friction.
"""

from math import log, pi, radians, sin, tan

import lacore as la
from lacore_verification.case import SOLVER, Band, Case, Reference, Variant
from lacore_verification.case.following import Following, Reading, last_load

INNER, OUTER, HEIGHT, TRAVEL, C = 1.0, 2.0, 0.25, 0.5, 1.0
_MESH = 1.5e-3  # relative, times n^-4, of the load with which it begins; 10 degrees have most
_STEPS = {"leapfrog": (0.021, 2), "explicit": (0.042, 1), "implicit-euler": (0.04, 1)}
_SAFETY = 1.3


def build(n: int, angle: float, steps: int, scheme: str) -> "la.Problem":
    """Return the problem: a row of quadrilaterals."""
    mesh = la.meshes.quadrilaterals(
        (INNER, OUTER), (0, HEIGHT), n, 1, grade_x=(INNER, OUTER / INNER)
    )
    soil = la.Body(mesh, la.MohrCoulomb(C, angle), kinematics="axisymmetric", space="q2")
    return la.Problem(
        bodies={"soil": soil},
        supports=[la.Fix("soil", "bottom", "y"), la.Fix("soil", "top", "y")],
        reference_loads=[la.Pressure("soil", "left")],
    )


def outer(inner: float, angle: float) -> float:
    """Return the outer radius [m] for that of the bore.

    ``r^n - R^n`` is the same for all particles.
    """
    power = 2 / (1 + sin(radians(angle)))
    return float((OUTER**power + inner**power - INNER**power) ** (1 / power))


def pressure(inner: float, angle: float) -> float:
    """Return the pressure, Pa, at the current radii."""
    ratio, phi = outer(inner, angle) / inner, radians(angle)
    if not angle:
        return 2 * C * log(ratio)
    return float(C / tan(phi) * (ratio ** (2 * sin(phi) / (1 + sin(phi))) - 1))


def path(angle: float, steps: int, scheme: str) -> Following:
    """Return the path.

    The bore moves outwards by half of its radius; what the tube grows by is read.
    """
    end = INNER + TRAVEL
    volume = pi * HEIGHT * (outer(end, angle) ** 2 - end**2)
    allowed = _allowed(steps, scheme)
    return Following(
        TRAVEL,
        steps,
        scheme,
        la.PointTravel("soil", (INNER, 0.0), (1.0, 0.0)),
        exact=lambda travel: pressure(INNER + travel, angle),
        reading=Reading(
            "volume at the end",
            lambda found: float(found.history["volume"].iloc[-1]),
            volume * (1 - allowed),
            volume * (1 + allowed),
        ),
    )


def _allowed(steps: int, scheme: str) -> float:
    """Return the relative error of a load by the steps."""
    coefficient, order = _STEPS.get(scheme, _STEPS["leapfrog"])
    return float(_SAFETY * coefficient * steps**-order)


def reference(angle: float, steps: int, scheme: str) -> Reference:
    """Return the reference: the pressure at the last load."""
    return Reference(
        pressure(INNER + last_load(TRAVEL, steps, scheme), angle),
        "c cot(phi) ((b/a)^(2 sin(phi)/(1 + sin(phi))) - 1), r^n - R^n = a^n - 1,"
        " n = 2/(1 + sin(phi))",
        "equilibrium, yield and flow rule integrated along the radius, analytically (T33)",
        "exact",
    )


def band(elements: int, angle: float, steps: int, scheme: str) -> Band:
    """Return the band: errors of the steps; those of the elements are negligible."""
    mesh = _MESH * elements**-4 + SOLVER
    allowed = _allowed(steps, scheme) + mesh
    coefficient, order = _STEPS.get(scheme, _STEPS["leapfrog"])
    return Band(
        allowed,
        allowed,
        f"Largest error of loads on the way and of the volume at its end, 10 and 30 degrees, 5 to"
        f" 20 steps: {coefficient:g} steps^-{order}; allowed {_SAFETY:g} times that, and {mesh:.1g}"
        " for elements and solver.",
    )


CASE = Case(
    id="cavity-expansion",
    title="Thick tube of soil, driven apart",
    tags=("continuum", "soil", "axisymmetric", "path", "closed form"),
    unit="pressure / c",
    explanation=__doc__,
    hand_calculation=f"""\
flow rule:    e_r + e_t = sin(phi) (e_t - e_r)
              v' = -beta v/r,  beta = (1 - sin(phi))/(1 + sin(phi))
particles:    v ~ r^-beta:  r^n - R^n = a^n - 1,  n = 1 + beta
equilibrium:  p = c cot(phi) ((b/a)^m - 1)
              m = 2 sin(phi)/(1 + sin(phi))
phi = 30:     n = 4/3, m = 2/3
              a = 1:    b = 2,         p = {pressure(1.0, 30.0):.6f} c
              a = 1.5:  b = {outer(1.5, 30.0):.6f},  p = {pressure(1.5, 30.0):.6f} c
""",
    meshes={"coarse": {"n": 8}, "medium": {"n": 16}, "fine": {"n": 32}},
    build=build,
    reference=reference,
    band=band,
    surfaces=True,
    bracket=None,
    path=path,
    variants=(Variant("phi-30", {"angle": 30.0, "steps": 10, "scheme": "leapfrog"}, ("coarse",)),),
)
