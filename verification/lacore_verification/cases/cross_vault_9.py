r"""A cross vault of four webs, 9 voussoirs each, is shaken along one of its axes.

         from above, 2.4 m wide

        +---.-----------.---+
        |\  |           |  /|       semicircles, radii 0.9 and 1.1
        |  \|    web    |/  |       mu = 0.6
        .---+----   ----+---.
        |   |  \   /    |   |       36 voussoirs
        |   |    X      |   |---> alpha W
        |   |  /   \    |   |
        .---+----   ----+---.
        |  /|           |\  |
        |/  |           |  \|
        +---.-----------.---+

Webs lean on each other in the groins, vertical planes above the diagonals. Two webs carry the push
as arches, the other two, which lie along it, are dragged by them. Coulomb loads are not unique.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases.shared.solids import HYPERSTATIC, certified, named, shaken

VALUE, ASSOCIATED = 0.240979, 0.2582768
MU = 0.6


def build(mu: float) -> "la.Problem":
    """Return the problem: the vault on fixed blocks below its lowest voussoirs."""
    vault = la.masonry3d.cross_vault(9, 0.9, 0.2, 1.2, mu)
    return shaken(vault, named(vault, "base"))


def reference(mu: float) -> Reference:
    """Return the reference: tabulated."""
    return {MU: certified(VALUE, ASSOCIATED)}[mu]


def band(elements: int, mu: float) -> Band:
    """Return the band: the references are rounded to six digits; alpha is in weights."""
    return rigid(1.0)


CASE = Case(
    id="cross-vault-9",
    title="Cross vault, shaken",
    tags=("blocks", "space", "contact", "Coulomb", "masonry", "interval", "associated differs"),
    unit="W",
    explanation=__doc__,
    hand_calculation=f"""\
None: found by optimisation, and certified.
a Coulomb state:  {VALUE}, and others
associated:       {ASSOCIATED}
""",
    build=build,
    reference=reference,
    band=band,
    variants=(Variant("mu-0.6", {"mu": MU}, unfit=HYPERSTATIC),),
)
