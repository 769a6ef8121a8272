r"""A square block on a rough floor is turned about its vertical axis.

        from above          +-------------+
                            |`.         .'|     slip at the four
                            |  `.     .'  |     corners, which carry
             alpha          |     ( )     |     a quarter of W each,
            (torque)        |   .'   `.   |     across their distance
                            | .'       `. |     b/sqrt(2) from the axis
                            +-------------+
                            |<---- b ---->|

The pressures below rigid blocks are not determined: among all pressures that balance W the loop
finds those of a Coulomb state, and contact at corners has the most friction torque that any
pressure gives (T72). Uniform pressure would give 0.3826 mu W b, 54 % of it. The load of four
corners is unique: they are at the same distance from the axis, and any pressures whose resultant
passes through it give the same torque.
"""

from math import sqrt

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases.shared.solids import on_floor


def build(mu: float, b: float) -> "la.Problem":
    """Return the problem.

    A couple of horizontal forces at two sides of the block, 1 N m per load factor.
    """
    blocks = la.BlockAssembly3D(on_floor(b, 0.5), mu)
    arm = b / 2
    couple = [
        la.PointForce("blocks", (sign * arm, 0.0, 0.25), (0.0, sign / (2 * arm), 0.0))
        for sign in (1, -1)
    ]
    weight = 1 / (b * b * 0.5)
    return la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", "floor", "xyz")],
        reference_loads=couple,
        dead_loads=[la.BodyForce("blocks", (0.0, 0.0, -weight), "block")],
    )


def reference(mu: float, b: float) -> Reference:
    """Return the reference: all weight at the corners."""
    value = mu * b / sqrt(2)
    return Reference(
        value, "mu W b/sqrt(2)", "equilibrium, analytically", "exact", associated=value
    )


def band(elements: int, mu: float, b: float) -> Band:
    """Return the band.

    Rigid; alpha times 1 N m is a torque, as large as the weight 1 N times b/2 at b/2.
    """
    return rigid(b / 2)


CASE = Case(
    id="torque-four",
    title="Square block turned on a floor",
    tags=("blocks", "space", "contact", "Coulomb", "torsion", "closed form"),
    unit="N m",
    explanation=__doc__,
    hand_calculation="""\
corners:   normal forces W/4, friction mu W/4 each
distance:  b/sqrt(2) from the axis
torque:    4 (mu W/4) b/sqrt(2) = mu W b/sqrt(2)
mu = 0.5, b = 1, W = 1:  0.35355339
""",
    build=build,
    reference=reference,
    band=band,
    variants=(
        Variant("unit", {"mu": 0.5, "b": 1.0}),
        Variant("wide", {"mu": 0.7, "b": 3.0}),
    ),
)
