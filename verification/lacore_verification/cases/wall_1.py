r"""A wall in running bond, 5 blocks wide, 6 courses high: alpha times its weight acts sideways.

        +----+----+----+----+----+
        |    |    |    |    |    |  6      33 blocks, 83 joints
        +--+-+--+-+--+-+--+-+--+-+
        |  |    |    |    |    | |  5      blocks 0.4 m x 0.175 m
        +--+-+--+-+--+-+--+-+--+-+         mu = 0.65 in all joints
        |    |    |    |    |    |  :
        +--+-+--+-+--+-+--+-+--+-+  -->
        |  |    |    |    |    | |  1      alpha W
        +--+----+----+----+----+-+
        //////////////////////////

A standard problem of masonry. Each joint, bed and head, has friction and no tension. Blocks rock
and slide in groups; the head joints make the reactions hyperstatic, so that Coulomb limit loads are
not unique. The interval is what one mechanism carries with other reactions; other mechanisms may
carry other loads, none of them above the associated one.
"""

import lacore as la
from lacore_verification.case import Case, Reference, Variant
from lacore_verification.cases.shared.walls import HAND, HYPERSTATIC, MU, WALL_1, band, listed, wall

LOW, HIGH, ASSOCIATED = 0.638982, 0.642859, 0.642859


def build(mu: float) -> "la.Problem":
    """Return the problem: the wall."""
    return wall(WALL_1, mu)


def reference(mu: float) -> Reference:
    """Return the reference: tabulated."""
    return {MU: listed(LOW, HIGH, ASSOCIATED)}[mu]


CASE = Case(
    id="wall-1",
    title="Masonry wall, 33 blocks",
    tags=("blocks", "contact", "Coulomb", "masonry", "interval", "associated differs"),
    unit="W",
    explanation=__doc__,
    hand_calculation=HAND.format(low=LOW, high=HIGH, associated=ASSOCIATED),
    build=build,
    reference=reference,
    band=band,
    variants=(Variant("mu-0.65", {"mu": MU}, unfit=HYPERSTATIC),),
)
