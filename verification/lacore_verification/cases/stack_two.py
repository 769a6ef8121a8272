r"""Two blocks on top of each other on a floor; one of them is pushed.

              +---------------+
    alpha --> |    2, W2      |        or
              +------ mu2 ----+
              |    1, W1      | <-- here
              +------ mu1 ----+
        /////////////////////////////

Pushed above, the upper block slides on the lower, or both on the floor. Pushed below, both move
together, whatever the friction between them: it only has to carry nothing. The load is unique, as
the normal reactions of both joints follow from equilibrium.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid


def build(
    mu1: float, mu2: float, W1: float, W2: float, b: float, h: float, lower: bool
) -> "la.Problem":
    """Return the problem.

    Two equal blocks b x h of different weight; the reference load at the centroid of one.
    """
    blocks = la.masonry.stack([(b, h), (b, h)], mu2, {("base", "1"): mu1})
    return la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", "base")],
        reference_loads=[la.PointForce("blocks", "1" if lower else "2", (1, 0))],
        dead_loads=[
            la.PointForce("blocks", "1", (0, -W1)),
            la.PointForce("blocks", "2", (0, -W2)),
        ],
    )


def reference(
    mu1: float, mu2: float, W1: float, W2: float, b: float, h: float, lower: bool
) -> Reference:
    """Return the reference: the smaller resistance to sliding."""
    both = mu1 * (W1 + W2)
    value = both if lower else min(mu2 * W2, both)
    formula = "mu1 (W1 + W2)" if lower else "min(mu2 W2, mu1 (W1 + W2))"
    return Reference(value, formula, "equilibrium, analytically", "exact", associated=value)


def valid(mu1: float, mu2: float, W1: float, W2: float, b: float, h: float, lower: bool) -> bool:
    """Return whether the parameters are valid.

    Nothing topples: the thrust crosses both joints inside.

    Pushed above at height h/2 of the upper block, its reaction is alpha h/(2 W2) off the middle of
    the upper joint, and 3 alpha h/(2 (W1 + W2)) off that of the floor; pushed below, only alpha
    h/(2 (W1 + W2)) there.
    """
    alpha = reference(mu1, mu2, W1, W2, b, h, lower).value
    if lower:
        return alpha * h < (W1 + W2) * b
    return alpha * h < W2 * b and 3 * alpha * h < (W1 + W2) * b


def band(
    elements: int, mu1: float, mu2: float, W1: float, W2: float, b: float, h: float, lower: bool
) -> Band:
    """Return the band: rigid."""
    return rigid(W1 + W2)


_SIZES = {"W1": 2.0, "W2": 1.0, "b": 4.0, "h": 1.0}

CASE = Case(
    id="stack-two",
    title="Two rigid blocks on top of each other",
    tags=("blocks", "contact", "Coulomb", "closed form"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="""\
upper joint:  t_n = W2,      carries mu2 W2
floor:        t_n = W1 + W2, carries mu1 (W1 + W2)
pushed above: through both,  alpha = min of the two
pushed below: floor only,    alpha = mu1 (W1 + W2)
W1 = 2, W2 = 1: (mu1, mu2) = (.3, .5): 0.5 above, 0.9 below
                             (.2, .9): 0.6 above
""",
    build=build,
    reference=reference,
    valid=valid,
    band=band,
    variants=(
        Variant("upper-slides", {"mu1": 0.3, "mu2": 0.5, **_SIZES, "lower": False}),
        Variant("both-slide", {"mu1": 0.2, "mu2": 0.9, **_SIZES, "lower": False}),
        Variant("pushed-below", {"mu1": 0.3, "mu2": 0.5, **_SIZES, "lower": True}),
    ),
)
