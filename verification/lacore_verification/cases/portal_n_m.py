r"""A portal frame on slender columns: the axial force takes of their moments.

              P |                      | P
        alpha   v                      v
        ------> o======================o      rigid beam
                |                      |
                |   N/Np + M/Mp = 1    |  h
                |                      |
        ////////o                      o////////  clamped
                |<-------- L --------->|

It sways on a hinge at each end of both columns. What the push adds to the axial force of one column
it takes from the other, so that their moments, which fall in proportion to it, keep their sum: the
load factor falls by the share P/Np, and the span does not matter.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid


def build(P: float, Np: float, Mp: float, h: float, L: float) -> "la.Problem":
    """Return the problem: dead load P on each column, alpha at beam level."""
    column = la.sections.Section(((-Np, 0.0), (0.0, Mp), (Np, 0.0)), "column")
    frame = la.Frame(
        nodes={"A": (0, 0), "B": (0, h), "C": (L, h), "D": (L, 0)},
        members={"left": ("A", "B"), "beam": ("B", "C"), "right": ("D", "C")},
        sections={"left": column, "beam": la.sections.rigid(), "right": column},
    )
    return la.Problem(
        bodies={"portal": frame},
        supports=[la.Fix("portal", ("A", "D"), "clamped")],
        reference_loads=[la.PointForce("portal", "B", (1, 0))],
        dead_loads=[la.PointForce("portal", node, (0, -P)) for node in ("B", "C")],
    )


def valid(P: float, Np: float, Mp: float, h: float, L: float) -> bool:
    """Return whether the parameters are valid: both columns are compressed, and none is crushed."""
    shear = 2 * Mp * (1 - P / Np) / L
    return shear <= P <= Np - shear


def reference(P: float, Np: float, Mp: float, h: float, L: float) -> Reference:
    """Return the reference: sway."""
    value = 4 * Mp * (1 - P / Np) / h
    return Reference(
        value, "4 Mp (1 - P/Np)/h", "equilibrium, analytically", "exact", associated=value
    )


def band(elements: int, P: float, Np: float, Mp: float, h: float, L: float) -> Band:
    """Return the band: rigid between hinges."""
    return rigid(2 * P)


_SIZES = {"Mp": 1.5, "h": 3.0, "L": 5.0}

CASE = Case(
    id="portal-n-m",
    title="Portal frame whose columns yield to axial force and moment",
    tags=("frames", "closed form"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="""\
columns:  2 M1 + 2 M2 = alpha h,  shear of the beam V = (M1 + M2)/L
          N1 = P - V,  N2 = P + V
hinges:   M1 = Mp (1 - N1/Np),  M2 = Mp (1 - N2/Np)
          alpha h = 2 Mp (2 - 2 P/Np)
alpha = 4 Mp (1 - P/Np)/h
Mp = 1.5, h = 3, Np = 10: P = 2: 1.6, P = 5: 1, P = 8: 0.4
""",
    build=build,
    reference=reference,
    band=band,
    valid=valid,
    variants=tuple(Variant(f"P-{P:g}", {"P": P, "Np": 10.0, **_SIZES}) for P in (2.0, 5.0, 8.0)),
    sweep="P",
)
