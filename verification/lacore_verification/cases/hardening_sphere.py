r"""A thick hollow sphere of a hardening material is blown up until its bore has grown by half.

        z
        | axis
        o - _
        o     ` .
        o         `.
        o _         `
          ` .  <-    \    a from 1 to 1.5
          p    `.     \   b = 2 at the beginning
          -->   \      |
                 |     |
    ------------ o o o o ---- r
                  u_z = 0

Axisymmetric, a quarter of a meridian section in quadrilaterals with curved edges. The pressure
follows the bore and a point of it controls the path: nothing tells the other points of the bore to
keep up. That they do, to 1e-5, is the work of the quadratic term that chooses between mechanisms
of nearly the same pressure (T29, T32).
"""

from dataclasses import replace

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant
from lacore_verification.case.following import Following, last_load
from lacore_verification.cases import thick_sphere
from lacore_verification.cases.shared.cavities import INNER, OUTER
from lacore_verification.cases.shared.exact_paths import peak, pressure, sphere
from lacore_verification.cases.shared.hardening_laws import LAWS

_STEPS = {
    "leapfrog": (0.043, 2),
    "implicit-midpoint": (0.0038, 2),
    "explicit": (0.097, 1),
    "implicit-euler": (0.096, 1),
}
_SAFETY = 1.3
_LADDERS = {"perfect": (5, 7, 10, 20), "linear-1": (2, 3, 4, 5)}
TRAVEL = 0.5
_PEAKS = {law: peak(sphere(LAWS[law], INNER, OUTER)) for law in ("linear-3", "voce")}


def build(n_radial: int, n_angular: int, law: str, steps: int, scheme: str) -> "la.Problem":
    """Return the problem: the quarter of the static case; yield stress 1 at the beginning."""
    static = thick_sphere.build(n_radial, n_angular, "q2")
    body = static.bodies["sphere"]
    assert isinstance(body, la.Body)
    hardening = replace(body, criterion=la.VonMises(hardening=LAWS[law]))
    return replace(static, bodies={"sphere": hardening})


def path(law: str, steps: int, scheme: str) -> Following:
    """Return the path: the equator of the bore moves outwards by half of its radius."""
    shell = sphere(LAWS[law], INNER, OUTER)
    return Following(
        TRAVEL,
        steps,
        scheme,
        la.PointTravel("sphere", (INNER, 0.0), (1.0, 0.0)),
        exact=lambda travel: pressure(shell, INNER + travel),
        ladder=_LADDERS.get(law, ()),
    )


def reference(law: str, steps: int, scheme: str) -> Reference:
    """Return the reference: the pressure at the last load."""
    at = last_load(TRAVEL, steps, scheme)
    return Reference(
        pressure(sphere(LAWS[law], INNER, OUTER), INNER + at),
        "p = 2 int_a^b sigma_Y dr/r, eb = 2 ln(r/R)",
        "Hill, The Mathematical Theory of Plasticity; analytically (T33)",
        "exact",
    )


def band(elements: int, law: str, steps: int, scheme: str) -> Band:
    """Return the band: errors of the steps and of the elements."""
    coefficient, order = _STEPS[scheme]
    mesh = thick_sphere.band(elements, "q2").above
    allowed = _SAFETY * coefficient * steps**-order + mesh
    return Band(
        allowed,
        allowed,
        f"Largest error along the path of all four laws on 4 x 8 elements, 2 to 40 steps:"
        f" {coefficient:g} steps^-{order}; allowed {_SAFETY:g} times that, and {mesh:.1g} of the"
        " static case for elements and solver.",
    )


CASE = Case(
    id="hardening-sphere",
    title="Thick hollow sphere of hardening material, blown up",
    tags=("hardening", "continuum", "axisymmetric", "path", "closed form"),
    unit="pressure / s0",
    explanation=__doc__,
    hand_calculation=f"""\
volumes:      r^3 - R^3 = a^3 - A^3
strain:       eb = 2 ln(r/R)
equilibrium:  dp/dr = 2 sigma_Y(eb)/r
perfect:      p = 2 s0 ln(b/a)
linear:       with u = 1 - (R/r)^3
              p = 2 s0 ln(b/a) + (4 H/9) (Li2(u_a) - Li2(u_b))
peak:         sigma_Y exp(-1.5 eb) equal inside and outside
              linear-3: {_PEAKS["linear-3"]}
              voce:     {_PEAKS["voce"]}
""",
    meshes={
        "coarse": {"n_radial": 4, "n_angular": 8},
        "medium": {"n_radial": 6, "n_angular": 12},
        "fine": {"n_radial": 12, "n_angular": 24},
    },
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    path=path,
    variants=(
        *(
            Variant(law, {"law": law, "steps": 20, "scheme": "leapfrog"}, meshes=("coarse",))
            for law in ("perfect", "voce")
        ),
        Variant(
            "linear-1-implicit-midpoint",
            {"law": "linear-1", "steps": 5, "scheme": "implicit-midpoint"},
            meshes=("coarse",),
        ),
    ),
)
