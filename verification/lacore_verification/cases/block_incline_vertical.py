r"""A weight is added on a block on an incline, which a dead force H pulls down the slope.

                           | alpha
                        +--v---+
                      .'  o   .'
               H <----+-- | -+
                .'/////// v W
              .'  mu
            .'
          .'  )  beta
        -----------------

No added weight makes the block slide. If tan(beta) < mu, friction grows with it faster than what it
has to hold: the associated load factor is +inf. The only limit load is a lower one, *below* which
the block slides: H/tan(phi - beta) - W, or -W, nothing left to hold, if nothing pulls.

If tan(beta) > mu it slides whatever weighs on it. Without H the only equilibrium is that without
any weight, alpha = -W; with H there is none, and the status is unsafe. A code that returns a number
then, or that takes one side of tan(beta) = mu for the other, is wrong.
"""

from math import atan, inf, tan

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases.block_incline import inclined


def build(mu: float, beta: float, W: float, H: float, b: float, h: float) -> "la.Problem":
    """Return the problem: loaded at the centroid."""
    pull = [la.PointForce("blocks", "block", (-H, 0))] if H > 0 else []
    return la.Problem(
        bodies={"blocks": inclined(mu, beta, b, h)},
        supports=[la.Fix("blocks", "slope")],
        reference_loads=[la.PointForce("blocks", "block", (0, -1))],
        dead_loads=[la.PointForce("blocks", "block", (0, -W)), *pull],
    )


def reference(mu: float, beta: float, W: float, H: float, b: float, h: float) -> Reference:
    """Return the reference: the load below which it slides, or none."""
    formula, source = "H/tan(phi - b) - W; none if H > 0 and phi < b", "equilibrium, analytically"
    holds = tan(beta) < mu
    if H > 0 and not holds:
        return Reference(-inf, formula, source, "status", status=la.Status.UNSAFE)
    value = (H / tan(atan(mu) - beta) if H > 0 else 0.0) - W
    return Reference(value, formula, source, "exact", associated=inf if holds else value)


def valid(mu: float, beta: float, W: float, H: float, b: float, h: float) -> bool:
    """Return whether the parameters are valid.

    It does not topple: the reaction, inclined phi, crosses the base mu h/2 off its middle.
    """
    return mu * h < b


def band(elements: int, mu: float, beta: float, W: float, H: float, b: float, h: float) -> Band:
    """Return the band: rigid."""
    return rigid(W + H)


_SIZES = {"W": 1.0, "b": 4.0, "h": 1.0}

CASE = Case(
    id="block-incline-vertical",
    title="Weight added on a rigid block on an incline",
    tags=("blocks", "contact", "Coulomb", "closed form", "associated differs", "status"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="""\
V = W + alpha weighs on the slope, t_n = V cos b - H sin b
slides down:  V sin b + H cos b = mu (V cos b - H sin b)
              V = H/tan(phi - b), alpha = V - W
more weight:  V (mu cos b - sin b) grows: it holds, no upper end
phi < b:      the left is larger for every V: no equilibrium,
              but that without any weight, V = H = 0
""",
    build=build,
    reference=reference,
    valid=valid,
    band=band,
    variants=(
        Variant("rough", {"mu": 0.5, "beta": 0.3, "H": 0.0, **_SIZES}),
        Variant(
            "rough-pulled",
            {"mu": 0.5, "beta": 0.3, "H": 0.5, **_SIZES},
            unfit={
                "regularised": "neither the associated problem nor the frictionless one has a start"
            },
        ),
        Variant("slippery", {"mu": 0.2, "beta": 0.3, "H": 0.0, **_SIZES}),
        Variant(
            "slippery-pulled",
            {"mu": 0.2, "beta": 0.3, "H": 0.5, **_SIZES},
            unfit={"ipopt": "it runs into its iteration limit where nothing is in equilibrium"},
        ),
    ),
)
