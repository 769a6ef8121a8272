r"""A portal frame without weight, its feet simply resting on a floor, is loaded at mid-span.

                          | alpha
                          v
                o---------o----------o
                |                    |
                |       M_p          |  h
                |                    |
                o                    o
        //////// mu ///////////// mu //////
                |<------- L -------->|

There is no dead load: plasticity alone sets the scale. Friction raises the load, up to
mu = L/(4 h), where the beam collapses by itself and the feet stay. The load is unique, as the
normal reaction of each foot is alpha/2 by equilibrium.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases import portal_beam


def build(mu: float, Mp: float, h: float, L: float) -> "la.Problem":
    """Return the problem: the portal of `portal-beam` without dead load."""
    return portal_beam.build(mu, 0.0, Mp, h, L)


def reference(mu: float, Mp: float, h: float, L: float) -> Reference:
    """Return the reference: feet or beam."""
    value = 4 * Mp / (L - 2 * mu * h) if mu * h <= L / 4 else 8 * Mp / L
    return Reference(
        value,
        "4 Mp/(L - 2 mu h) if mu h <= L/4, else 8 Mp/L",
        "equilibrium, analytically",
        "exact",
        associated=value,
    )


def band(elements: int, mu: float, Mp: float, h: float, L: float) -> Band:
    """Return the band: rigid between hinges."""
    return rigid(0.0)


_SIZES = {"Mp": 1.0, "h": 1.0, "L": 2.0}

CASE = Case(
    id="frame-feet",
    title="Portal frame without weight on Coulomb feet",
    tags=("frames", "contact", "Coulomb", "closed form"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="""\
feet:    V = alpha/2, thrust H = mu alpha/2
slide:   mid-span hinge, alpha L/4 = Mp + mu alpha h/2
         alpha = 4 Mp/(L - 2 mu h)
beam:    3 hinges, alpha = 8 Mp/L
equal:   mu h = L/4
L = 2, h = 1, Mp = 1: mu = 0: 2, .2: 2.5, .4: 3.333333, .5: 4
""",
    build=build,
    reference=reference,
    band=band,
    variants=tuple(Variant(f"mu-{mu:g}", {"mu": mu, **_SIZES}) for mu in (0.0, 0.2, 0.4, 0.6, 0.8)),
    sweep="mu",
)
