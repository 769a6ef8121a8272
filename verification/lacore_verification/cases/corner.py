r"""Two walls in bond at a right angle: shaken across one of them, along the other.

          from above                  first course        second course

      +--+                            +--+                +--+
      |  |                            |  |                |  |
      |  |    y                       +--+                |  |
      |  |    |                       |  |                +--+
      |  +----+---------+             +--+-+------+       |  +------+--
      |       o--> x    |             |    |      |       |  |      |
      +-----------------+             +----+------+       +--+------+--

The wall along x is pushed out of its plane, by alpha times its weight along y, and leans on the
other only at the corner: it tears off in steps, up the bond, twisting blocks on their beds. The
head joints make reactions hyperstatic; the interval is what one mechanism carries.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases.shared.solids import HYPERSTATIC, certified, shaken

# By friction: what the mechanism found carries, from and to, and the associated load.
FOUND = {0.5: (0.3061925, 0.3257414, 0.3332557), 0.6: (0.3462811, 0.3614233, 0.3726984)}


def build(mu: float) -> "la.Problem":
    """Return the problem: walls of 4 and 3 blocks, 8 courses."""
    walls = la.masonry3d.corner((4, 3), 8, mu)
    return shaken(walls, ("base",), (0.0, 1.0, 0.0))


def reference(mu: float) -> Reference:
    """Return the reference: tabulated."""
    low, high, associated = FOUND[mu]
    return certified(low, associated, high)


def band(elements: int, mu: float) -> Band:
    """Return the band: the references are rounded to seven digits; alpha is in weights."""
    return rigid(1.0)


CASE = Case(
    id="corner",
    title="Corner of two walls, pushed out of plane",
    tags=("blocks", "space", "contact", "Coulomb", "masonry", "interval", "associated differs"),
    unit="W",
    explanation=__doc__,
    hand_calculation="""\
None: found by optimisation, and certified.
mu = 0.5:  [0.3061925, 0.3257414], associated 0.3332557
mu = 0.6:  [0.3462811, 0.3614233], associated 0.3726984
""",
    build=build,
    reference=reference,
    band=band,
    variants=(
        Variant("mu-0.5", {"mu": 0.5}, unfit=HYPERSTATIC),
        Variant("mu-0.6", {"mu": 0.6}, unfit=HYPERSTATIC),
    ),
)
