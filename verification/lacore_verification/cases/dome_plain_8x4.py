r"""A dome of 8 plain meridians and 4 rings is shaken sideways.

              .-- oculus --.
           .-'  |       |   `-.
         .'     |       |     '.       32 blocks, R = 1, t = 0.15
        /-------+-------+-------\      oculus 0.25 rad, mu = 0.5
       |        |       |        |
       +--------+-------+--------+     alpha W
       ///////////////////////////

Most domes have several mechanisms, and each of them a continuum of reactions: Coulomb loads are not
unique. The value is one that has been certified; the associated load is above all of them.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases.shared.solids import HYPERSTATIC, certified, named, shaken

VALUE, ASSOCIATED = 0.403809, 0.4094239
MU = 0.5


def build(mu: float) -> "la.Problem":
    """Return the problem: a dome of radius 1 m on a ring of fixed blocks."""
    dome = la.masonry3d.dome(8, 4, 1.0, 0.15, 0.25, mu)
    return shaken(dome, named(dome, "base"))


def reference(mu: float) -> Reference:
    """Return the reference: tabulated."""
    return {MU: certified(VALUE, ASSOCIATED)}[mu]


def band(elements: int, mu: float) -> Band:
    """Return the band: the references are rounded to six digits; alpha is in weights."""
    return rigid(1.0)


CASE = Case(
    id="dome-plain-8x4",
    title="Dome of plain meridians, shaken",
    tags=("blocks", "space", "contact", "Coulomb", "masonry", "interval", "associated differs"),
    unit="W",
    explanation=__doc__,
    hand_calculation=f"""\
None: found by optimisation, and certified.
a Coulomb state:  {VALUE}
associated:       {ASSOCIATED}
""",
    build=build,
    reference=reference,
    band=band,
    variants=(Variant("mu-0.5", {"mu": MU}, unfit=HYPERSTATIC),),
)
