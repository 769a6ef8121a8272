r"""A block between two fixed vertical walls is lifted.

               ^ alpha
          |/|+---|---+|/|
          |/||   o   ||/|
          |/||   | W ||/|     mu on both sides
          |/||   v   ||/|
          |/|+-------+|/|

Nothing says how hard the walls clamp it. Not at all, and alpha = W lifts it; or with any force N on
each side, and it takes W + 2 mu N. Every load from W upwards is a Coulomb limit load, with one and
the same mechanism; the associated load factor is +inf.
"""

from math import inf

import lacore as la
from lacore_verification.case import CLAMPED, Band, Case, Reference, Variant, rigid


def build(mu: float, W: float, b: float, h: float) -> "la.Problem":
    """Return the problem: block and walls."""
    rectangle = la.masonry.rectangle
    blocks = la.BlockAssembly(
        {
            "left": rectangle(-1.5 * b, -b / 2, -h, 2 * h),
            "right": rectangle(b / 2, 1.5 * b, -h, 2 * h),
            "block": rectangle(-b / 2, b / 2, 0, h),
        },
        friction=mu,
    )
    return la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", "left"), la.Fix("blocks", "right")],
        reference_loads=[la.PointForce("blocks", "block", (0, 1))],
        dead_loads=[la.PointForce("blocks", "block", (0, -W))],
    )


def reference(mu: float, W: float, b: float, h: float) -> Reference:
    """Return the reference: any clamping force."""
    return Reference(
        W, "W and more", "equilibrium, analytically", "interval", up_to=inf, associated=inf
    )


def band(elements: int, mu: float, W: float, b: float, h: float) -> Band:
    """Return the band: rigid."""
    return rigid(W)


CASE = Case(
    id="block-between-walls",
    title="Block lifted between two walls: loads without an upper end",
    tags=("blocks", "contact", "Coulomb", "closed form", "interval", "associated differs"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="""\
walls:       normal force N >= 0 on each side, not determined
block:       alpha = W + 2 mu N
so:          Coulomb loads are all of [W, inf)
associated:  moving up needs u_n = mu u_t on both sides at once:
             impossible, alpha = +inf
""",
    build=build,
    reference=reference,
    band=band,
    variants=(
        Variant("mu-0.3", {"mu": 0.3, "W": 1.0, "b": 1.0, "h": 1.0}, unfit=CLAMPED),
        Variant("mu-0.8", {"mu": 0.8, "W": 1.0, "b": 1.0, "h": 1.0}, unfit=CLAMPED),
    ),
)
