r"""A pier is shaken sideways, and crushes at its toe before it overturns.

                 +---------+
                 |         |
       alpha W --|--> o    | h        o  centroid
                 |    |    |
                 |    W    |
                 +---------+
               ///|<- b ->|///
                       ^^^^            the strength f over a depth a:
                       | a |           a = W/(f b)

A rigid pier turns about its edge. Of one that crushes the weight stands on as much of the joint as
it takes at its strength, and the lever of the weight is shorter by half of that depth. Cells of a
joint carry no more than that, at any strength, and all of it where the depth ends between two rows
of cells (T95): with three of them from the edge to the middle, at 1/18, 2/9 and 1/2 of the width.
The load is unique: below it, friction is alpha/mu of its limit in every cell at most, for any
pressures in equilibrium.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases.shared.solids import on_floor, shaken


def build(mu: float, b: float, h: float, depth: float) -> "la.Problem":
    """Return the problem: pier and floor; its weight per volume is 1."""
    strength = b * h / depth  # W/(a b), W = b b h
    blocks = la.BlockAssembly3D(on_floor(b, h), mu, crushing=la.Crushing(strength, divisions=3))
    return shaken(blocks, ("floor",))


def reference(mu: float, b: float, h: float, depth: float) -> Reference:
    """Return the reference: moments about the centre of pressure."""
    value = (b - depth) / h
    # Dilatant friction costs nothing where nothing slips.
    return Reference(value, "(b - W/(f b))/h", "moments, analytically", "exact", associated=value)


def band(elements: int, mu: float, b: float, h: float, depth: float) -> Band:
    """Return the band: rigid; alpha is in weights."""
    return rigid(1.0)


SMALL = {"slsqp": "a dense method, and a joint has 144 points and as many speeds of crushing"}

CASE = Case(
    id="toe-crushing",
    title="Pier that crushes at its toe",
    tags=("blocks", "space", "contact", "Coulomb", "crushing", "closed form"),
    unit="W",
    explanation=__doc__,
    hand_calculation="""\
depth:     a = W/(f b), under the strength f over the width b
moments:   about the middle of that strip,
           alpha W h/2 = W (b/2 - a/2)
together:  alpha = (b - a)/h
""",
    build=build,
    reference=reference,
    band=band,
    variants=(
        Variant("strong", {"mu": 0.7, "b": 1.0, "h": 2.0, "depth": 1 / 18}, unfit=SMALL),
        Variant("weak", {"mu": 0.7, "b": 1.0, "h": 2.0, "depth": 2 / 9}, unfit=SMALL),
        Variant("half", {"mu": 0.7, "b": 2.0, "h": 3.0, "depth": 1.0}),
    ),
)
