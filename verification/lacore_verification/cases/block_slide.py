r"""A block on a floor with Coulomb friction mu is pushed by a force at height y.

              +-----------------+
              |        |        |
    alpha --->|        v W      |  h
              |                 |
              +-----------------+
              /////// mu ////////
              |<------ b ------>|

It slides, or it topples about its leading lower corner. The normal reactions follow from
equilibrium alone, so that friction makes no difference between Coulomb and associated loads.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid


def build(mu: float, W: float, b: float, h: float, y: float) -> "la.Problem":
    """Return the problem: block and floor; W, alpha: forces per thickness."""
    blocks = la.BlockAssembly(
        {
            "floor": la.masonry.rectangle(-b, b, -h, 0),
            "block": la.masonry.rectangle(-b / 2, b / 2, 0, h),
        },
        friction=mu,
    )
    return la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", "floor")],
        reference_loads=[la.PointForce("blocks", (-b / 2, y), (1, 0))],
        dead_loads=[la.PointForce("blocks", "block", (0, -W))],
    )


def reference(mu: float, W: float, b: float, h: float, y: float) -> Reference:
    """Return the reference: the smaller of sliding and toppling."""
    value = min(mu * W, W * b / (2 * y))
    return Reference(
        value, "min(mu W, W b/(2 y))", "equilibrium, analytically", "exact", associated=value
    )


def valid(mu: float, W: float, b: float, h: float, y: float) -> bool:
    """Return whether the parameters are valid: the force acts on the face of the block."""
    return 0 < y <= h


def band(elements: int, mu: float, W: float, b: float, h: float, y: float) -> Band:
    """Return the band: rigid."""
    return rigid(W)


CASE = Case(
    id="block-slide",
    title="Rigid block pushed along a floor",
    tags=("blocks", "contact", "Coulomb", "closed form"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="""\
t_n in total:  W, whatever alpha is
sliding:       alpha = mu W
toppling:      alpha y = W b/2 about the leading corner
together:      alpha = min(mu W, W b/(2 y))
""",
    build=build,
    reference=reference,
    valid=valid,
    band=band,
    variants=(
        *(
            Variant(f"mu-{mu:g}", {"mu": mu, "W": 1.0, "b": 1.0, "h": 1.0, "y": 1.0})
            for mu in (0.2, 0.4, 0.6)
        ),
        Variant("low", {"mu": 0.3, "W": 1.0, "b": 2.0, "h": 1.0, "y": 0.5}),
    ),
    sweep="mu",
)
