r"""A portal frame, its feet simply resting on a floor, is pushed sideways.

              P |                      | P
        alpha   v                      v
        ------> o----------------------o
                |                      |
                |       M_p            |
                |                      |  h
                |                      |
                o                      o
        //////// mu ////////////// mu //////
                |<-------- L --------->|

It sways on two plastic corners, or slides with both feet; or the windward foot, which the push
unloads, slides alone while the leeward corner yields; or it overturns. Feet turn freely. The normal
reactions follow from equilibrium, so that Coulomb and associated loads are the same.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid


def portal(mu: float, Mp: float, h: float, L: float) -> "tuple[la.Frame, list[la.Interface]]":
    """Return the frame, its corners at height h and a node at mid-span, and its feet."""
    frame = la.Frame(
        nodes={"A": (0, 0), "B": (0, h), "M": (L / 2, h), "C": (L, h), "D": (L, 0)},
        members=[("A", "B"), ("B", "M"), ("M", "C"), ("C", "D")],
        plastic_moment=Mp,
    )
    floor = la.RigidObstacle((0, 0), (0, 1))
    return frame, [la.Interface(("portal", foot), floor, mu) for foot in ("A", "D")]


def build(mu: float, P: float, Mp: float, h: float, L: float) -> "la.Problem":
    """Return the problem: dead load P on each column, alpha at beam level."""
    frame, feet = portal(mu, Mp, h, L)
    return la.Problem(
        bodies={"portal": frame},
        interfaces=feet,
        reference_loads=[la.PointForce("portal", "B", (1, 0))],
        dead_loads=[la.PointForce("portal", node, (0, -P)) for node in ("B", "C")],
    )


def reference(mu: float, P: float, Mp: float, h: float, L: float) -> Reference:
    """Return the reference: the least of four mechanisms."""
    value = min(2 * Mp / h, 2 * mu * P, (mu * P + Mp / h) / (1 + mu * h / L), P * L / h)
    return Reference(
        value,
        "min(2 Mp/h, 2 mu P, (mu P + Mp/h)/(1 + mu h/L), P L/h)",
        "equilibrium, analytically; a case of Bousshine, Chaaba & de Saxce 2002",
        "exact",
        associated=value,
    )


def band(elements: int, mu: float, P: float, Mp: float, h: float, L: float) -> Band:
    """Return the band: rigid between hinges."""
    return rigid(2 * P)


_SIZES = {"Mp": 1.0, "h": 2.0, "L": 4.0}

WEAK = {"slsqp": "its r = 0.03 is too strong for hinges, and anything less too stiff for it"}

CASE = Case(
    id="portal-sway",
    title="Portal frame on Coulomb feet, pushed sideways",
    tags=("frames", "contact", "Coulomb", "closed form"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="""\
feet:          V1 = P - alpha h/L (windward), V2 = P + alpha h/L
sway:          2 corner hinges, alpha h = 2 Mp
both slide:    alpha = mu (V1 + V2) = 2 mu P
one slides:    H1 = mu V1, leeward corner H2 h = Mp
               alpha = H1 + H2 = (mu P + Mp/h)/(1 + mu h/L)
overturns:     V1 = 0, alpha = P L/h
Mp = 1, h = 2, L = 4: (mu, P) = (.1, 1): .2, (.25, 1): .5,
       (.35, 1.5): .872340, (.9, 1.5): 1, (.9, .3): .531034
""",
    build=build,
    reference=reference,
    band=band,
    variants=(
        Variant("slides", {"mu": 0.1, "P": 1.0, **_SIZES}, unfit=WEAK),
        Variant("slides-too", {"mu": 0.25, "P": 1.0, **_SIZES}, unfit=WEAK),
        Variant("one-foot-slides", {"mu": 0.35, "P": 1.5, **_SIZES}, unfit=WEAK),
        Variant("sways", {"mu": 0.9, "P": 1.5, **_SIZES}, unfit=WEAK),
        Variant("light", {"mu": 0.9, "P": 0.3, **_SIZES}, unfit=WEAK),
    ),
)
