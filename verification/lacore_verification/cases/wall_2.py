r"""A wall in running bond, 5 blocks wide, 10 courses high: alpha times its weight acts sideways.

        +----+----+----+----+----+
        |    |    |    |    |    | 10      55 blocks, 141 joints
        +--+-+--+-+--+-+--+-+--+-+
        |  |    |    |    |    | |  9      blocks 0.4 m x 0.175 m
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
from lacore_verification.cases.shared.walls import HAND, HYPERSTATIC, MU, WALL_2, band, listed, wall

LOW, HIGH, ASSOCIATED = 0.557416, 0.577201, 0.579999


def build(mu: float) -> "la.Problem":
    """Return the problem: the wall."""
    return wall(WALL_2, mu)


def reference(mu: float) -> Reference:
    """Return the reference: tabulated."""
    return {MU: listed(LOW, HIGH, ASSOCIATED)}[mu]


CASE = Case(
    id="wall-2",
    title="Masonry wall, 55 blocks",
    tags=("blocks", "contact", "Coulomb", "masonry", "interval", "associated differs"),
    unit="W",
    explanation=__doc__,
    hand_calculation=HAND.format(low=LOW, high=HIGH, associated=ASSOCIATED),
    build=build,
    reference=reference,
    band=band,
    variants=(Variant("mu-0.65", {"mu": MU}, unfit=HYPERSTATIC),),
)
