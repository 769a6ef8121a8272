r"""A thick tube of a hardening material is blown up until its bore has grown by half.

      r = 1                r = 2
        +--------------------+  u_z = 0
    p ->|                    |
    p ->|                    |  free
        +--------------------+  u_z = 0
        |                          z
        |--> bore: a from 1 to 1.5 |__ r

A slice of the axisymmetric body (r, z), without axial motion; the pressure follows the bore, which
controls the path. Volumes fix how each particle moves, whatever the law: the whole path has a
closed form. With perfect plasticity the pressure falls from the beginning as the wall thins; with
enough hardening it rises to a peak first.
"""

import lacore as la
from lacore_verification.case import SOLVER, Band, Case, Reference, Variant
from lacore_verification.case.following import Following, last_load
from lacore_verification.cases.shared.exact_paths import cylinder, peak, pressure
from lacore_verification.cases.shared.hardening_laws import LAWS

INNER, OUTER, HEIGHT, TRAVEL = 1.0, 2.0, 0.25, 0.5
_MESH = 3e-3  # relative, times n^-4
_STEPS = {"leapfrog": (0.026, 2), "explicit": (0.037, 1), "implicit-euler": (0.037, 1)}
_SAFETY = 1.3
_LADDERS = {
    ("linear-3", "leapfrog"): (5, 7, 10, 20),
    ("perfect", "explicit"): (10, 14, 20, 28),
    ("perfect", "implicit-euler"): (5, 7, 10, 14),
}
_PEAKS = {law: peak(cylinder(LAWS[law], INNER, OUTER)) for law in ("linear-3", "voce")}


def build(n: int, law: str, steps: int, scheme: str) -> "la.Problem":
    """Return the problem: a row of quadrilaterals; yield stress 1 at the beginning."""
    mesh = la.meshes.quadrilaterals(
        (INNER, OUTER), (0, HEIGHT), n, 1, grade_x=(INNER, OUTER / INNER)
    )
    body = la.Body(mesh, la.VonMises(hardening=LAWS[law]), kinematics="axisymmetric", space="q2")
    return la.Problem(
        bodies={"tube": body},
        supports=[la.Fix("tube", "bottom", "y"), la.Fix("tube", "top", "y")],
        reference_loads=[la.Pressure("tube", "left")],
    )


def path(law: str, steps: int, scheme: str) -> Following:
    """Return the path: the bore moves outwards by half of its radius."""
    tube = cylinder(LAWS[law], INNER, OUTER)
    exact = scheme == "implicit-midpoint"
    return Following(
        TRAVEL,
        steps,
        scheme,
        la.PointTravel("tube", (INNER, 0.0), (1.0, 0.0)),
        exact=lambda travel: pressure(tube, INNER + travel),
        volume=1e-10 if exact else 0.02,
        ladder=_LADDERS.get((law, scheme), ()),
    )


def reference(law: str, steps: int, scheme: str) -> Reference:
    """Return the reference: the pressure at the last load."""
    at = last_load(TRAVEL, steps, scheme)
    return Reference(
        pressure(cylinder(LAWS[law], INNER, OUTER), INNER + at),
        "p = (2/sqrt3) int_a^b sigma_Y dr/r, eb = (2/sqrt3) ln(r/R)",
        "Hill, The Mathematical Theory of Plasticity; analytically (T33)",
        "exact",
    )


def band(elements: int, law: str, steps: int, scheme: str) -> Band:
    """Return the band: errors of the steps; those of the elements are negligible."""
    mesh = _MESH * elements**-4 + SOLVER
    if scheme not in _STEPS:
        return Band(
            mesh,
            mesh,
            "Exact in time: the implicit midpoint of a velocity c/r keeps a^2 - A^2 for all"
            " particles, and the Hencky increment is ln(r/R). Left are elements and solver.",
        )
    coefficient, order = _STEPS[scheme]
    allowed = _SAFETY * coefficient * steps**-order + mesh
    return Band(
        allowed,
        allowed,
        f"Largest error along the path of all four laws, 5 to 40 steps: {coefficient:g}"
        f" steps^-{order}; allowed {_SAFETY:g} times that, and {mesh:.1g} for elements and solver.",
    )


CASE = Case(
    id="hardening-cylinder",
    title="Thick tube of hardening material, blown up",
    tags=("hardening", "continuum", "axisymmetric", "path", "closed form"),
    unit="pressure / s0",
    explanation=__doc__,
    hand_calculation=f"""\
volumes:      r^2 - R^2 = a^2 - A^2       (u_z = 0)
strain:       eb = (2/sqrt3) ln(r/R)
equilibrium:  dp/dr = (2/sqrt3) sigma_Y(eb)/r
perfect:      p = (2/sqrt3) s0 ln(b/a)
linear:       with u = 1 - (R/r)^2
              p = (2/sqrt3) [s0 ln(b/a)
                  + H/(2 sqrt3) (Li2(u_a) - Li2(u_b))]
peak:         sigma_Y exp(-sqrt3 eb) equal inside and outside
              linear-3: {_PEAKS["linear-3"]}
              voce:     {_PEAKS["voce"]}
""",
    meshes={"coarse": {"n": 8}, "medium": {"n": 16}, "fine": {"n": 32}},
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    path=path,
    variants=(
        *(
            Variant(law, {"law": law, "steps": 20, "scheme": "leapfrog"}, meshes=("coarse",))
            for law in LAWS
        ),
        *(
            Variant(
                f"{law}-{scheme}",
                {"law": law, "steps": steps, "scheme": scheme},
                meshes=("coarse",),
            )
            for law, scheme, steps in (
                ("perfect", "explicit", 20),
                ("perfect", "implicit-euler", 10),
                ("voce", "implicit-midpoint", 5),
            )
        ),
    ),
)
