r"""A portal frame, its feet simply resting on a floor, is loaded at mid-span.

              P |         | alpha      | P
                v         v            v
                o---------o------------o
                |                      |
                |       M_p            |
                |                      |  h
                |                      |
                o                      o
        //////// mu ////////////// mu //////
                |<-------- L --------->|

The beam collapses on three hinges, or its thrust pushes the feet apart, which the load itself
presses on the floor: a frame whose feet slide needs friction mu h < L/2, or never slides. The load
is unique, as moments about the feet give the same normal reaction P + alpha/2 to both.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases.portal_sway import WEAK, portal


def build(mu: float, P: float, Mp: float, h: float, L: float) -> "la.Problem":
    """Return the problem: dead load P on each column, alpha at mid-span."""
    frame, feet = portal(mu, Mp, h, L)
    dead = [la.PointForce("portal", node, (0, -P)) for node in ("B", "C")] if P > 0 else []
    return la.Problem(
        bodies={"portal": frame},
        interfaces=feet,
        reference_loads=[la.PointForce("portal", "M", (0, -1))],
        dead_loads=dead,
    )


def reference(mu: float, P: float, Mp: float, h: float, L: float) -> Reference:
    """Return the reference: the smaller of two mechanisms."""
    value = 8 * Mp / L
    if 2 * mu * h < L:
        value = min(value, 4 * (Mp + mu * h * P) / (L - 2 * mu * h))
    return Reference(
        value,
        "min(8 Mp/L, 4 (Mp + mu h P)/(L - 2 mu h))",
        "equilibrium, analytically; a case of Bousshine, Chaaba & de Saxce 2002",
        "exact",
        associated=value,
    )


def band(elements: int, mu: float, P: float, Mp: float, h: float, L: float) -> Band:
    """Return the band: rigid between hinges."""
    return rigid(2 * P)


_SIZES = {"Mp": 1.0, "h": 2.0, "L": 4.0}

CASE = Case(
    id="portal-beam",
    title="Portal frame on Coulomb feet, loaded at mid-span",
    tags=("frames", "contact", "Coulomb", "closed form"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="""\
beam:         3 hinges, alpha L/4 = 2 Mp
feet:         V = P + alpha/2, thrust H = mu V
              mid-span hinge only: alpha L/4 = Mp + H h
              alpha = 4 (Mp + mu h P)/(L - 2 mu h), L > 2 mu h
Mp = 1, h = 2, L = 4: (mu, P) = (.1, 0): 1.111111,
       (.1, 1): 1.333333, (.3, .5): 1.857143, (.8, 1): 2
""",
    build=build,
    reference=reference,
    band=band,
    variants=(
        Variant("feet-no-dead-load", {"mu": 0.1, "P": 0.0, **_SIZES}, unfit=WEAK),
        Variant("feet", {"mu": 0.1, "P": 1.0, **_SIZES}, unfit=WEAK),
        Variant("feet-rougher", {"mu": 0.3, "P": 0.5, **_SIZES}, unfit=WEAK),
        Variant("beam", {"mu": 0.8, "P": 1.0, **_SIZES}, unfit=WEAK),
    ),
)
