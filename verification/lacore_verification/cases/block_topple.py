r"""A block stands on a floor that is tilted, or shaken: alpha times its weight acts sideways.

              +-----+
              |     |
              |  o--+---> alpha W
              |  |  |                h
              |  v  |
              |  W  |
              +-----+
        /////////// mu //////////
              |< b >|

A slender block (b/h < mu) topples about its leading lower corner, a squat one slides. The load is
unique, as the normal reactions at both corners follow from equilibrium.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid


def build(mu: float, W: float, b: float, h: float) -> "la.Problem":
    """Return the problem: block and floor, reference load and dead load at the centroid."""
    blocks = la.BlockAssembly(
        {
            "floor": la.masonry.rectangle(-b, b, -h, 0),
            "block": la.masonry.rectangle(-b / 2, b / 2, 0, h),
        },
        friction=mu,
    )
    weight = W / (b * h)
    return la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", "floor")],
        reference_loads=[la.BodyForce("blocks", (weight, 0), "block")],
        dead_loads=[la.BodyForce("blocks", (0, -weight), "block")],
    )


def reference(mu: float, W: float, b: float, h: float) -> Reference:
    """Return the reference: the smaller of sliding and toppling."""
    value = min(mu, b / h)
    return Reference(value, "min(mu, b/h)", "equilibrium, analytically", "exact", associated=value)


def band(elements: int, mu: float, W: float, b: float, h: float) -> Band:
    """Return the band: rigid; alpha is in weights."""
    return rigid(1.0)


CASE = Case(
    id="block-topple",
    title="Rigid block on a tilted floor",
    tags=("blocks", "contact", "Coulomb", "closed form"),
    unit="W",
    explanation=__doc__,
    hand_calculation="""\
sliding:   alpha W = mu W
toppling:  alpha W h/2 = W b/2 about the leading corner
together:  alpha = min(mu, b/h)
""",
    build=build,
    reference=reference,
    band=band,
    variants=(
        Variant("slender", {"mu": 0.6, "W": 1.0, "b": 0.5, "h": 1.0}),
        Variant("squat", {"mu": 0.3, "W": 1.0, "b": 2.0, "h": 1.0}),
    ),
)
