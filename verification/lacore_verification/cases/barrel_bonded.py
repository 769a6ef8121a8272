r"""A barrel vault of 399 blocks in bond, 8 m long, is shaken across its axis, or obliquely.

              .--+--.               from above: 15 rows of voussoirs
           .-'\  |  /`-.
         .'\   \_|_/   /'.          +----+----+----+----+--
        /   \.'     `./   \         |    |    |    |    |    --> y
       /`-. /         \ .-'\        +--+-+--+-+--+-+--+-+--
      |    |           |    |       |  |    |    |    |          push at psi
      +----+           +----+       +--+----+----+----+----      from x to y
      ///////         ///////

Whatever its length and its bond, a barrel that is pushed across carries what a slice of it carries,
an arch in the plane (T78): no slice can gain by leaning on its neighbours, which are pushed as
hard. Pushed obliquely, it carries the part along y by friction, without effort, and alpha cos(psi)
is what the arch carries. This is the largest three-dimensional case: 399 blocks, 1162 joints.

The reactions are hyperstatic, and it is not proven that the load is unique. A short search by
`lacore.coulomb_range` found no load of the two-dimensional arch other than the associated one,
which proves nothing.
"""

from math import cos, sin

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases.shared.solids import HYPERSTATIC, shaken

PLANE = 0.1152294  # 15 voussoirs, radii 2 and 2.3, mu = 0.6: Coulomb and associated


def build(psi: float) -> "la.Problem":
    """Return the problem: the vault between its springings, which are held."""
    vault = la.masonry3d.barrel_vault(15, 26, 2.0, 0.3, 8.0, 0.6)
    return shaken(vault, ("left", "right"), (cos(psi), sin(psi), 0.0))


def reference(psi: float) -> Reference:
    """Return the reference: that of the plane arch, along x."""
    value = PLANE / cos(psi)
    return Reference(
        value,
        "alpha of the plane arch over cos(psi)",
        "linear programs of the plane, 7 digits",
        "exact, numerical",
        half_width=5e-8 / cos(psi),
        associated=value,
    )


def band(elements: int, psi: float) -> Band:
    """Return the band: rigid; alpha is in weights."""
    return rigid(1.0)


CASE = Case(
    id="barrel-bonded",
    title="Barrel vault of 399 blocks in bond",
    tags=("blocks", "space", "contact", "Coulomb", "masonry", "relation", "large"),
    unit="W",
    explanation=__doc__,
    hand_calculation="""\
plane arch of 15 voussoirs, radii 2 and 2.3,
mu = 0.6:           alpha_0 = 0.1152294
pushed at psi:      alpha = alpha_0/cos(psi)
                    psi = 0.6435: 0.1440367
""",
    build=build,
    reference=reference,
    band=band,
    variants=(
        Variant("across", {"psi": 0.0}, unfit=HYPERSTATIC),
        Variant("obliquely", {"psi": 0.6435}, unfit=HYPERSTATIC),
    ),
)
