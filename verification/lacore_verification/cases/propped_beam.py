r"""A beam is clamped at its left end, held at its right one, and bears a uniform load.

        //|  | | | | alpha | | | | | |
        //|  v v v v v v v v v v v v v
        //|================o==========
        //|                          ^
        //|                         /_\  simply supported, or clamped
          |<----------- L ---------->|

Hinges form where moments peak: at the clamped ends, and in the span where nothing marks a place.
Simply supported on the right the peak lies (sqrt(2) - 1) L from that support. The node of its hinge
is found by the solve.
"""

from math import sqrt

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid


def build(right: str, Mp: float, L: float) -> "la.Problem":
    """Return the problem: one member, no node in between."""
    beam = la.Frame({"A": (0, 0), "B": (L, 0)}, {"beam": ("A", "B")}, plastic_moment=Mp)
    return la.Problem(
        bodies={"beam": beam},
        supports=[la.Fix("beam", "A", "clamped"), la.Fix("beam", "B", right)],
        reference_loads=[la.Traction("beam", "beam", (0, -1))],
    )


def reference(right: str, Mp: float, L: float) -> Reference:
    """Return the reference: both ends clamped, or one."""
    factor, formula = {
        "clamped": (16.0, "16 Mp/L^2"),
        "y": (6 + 4 * sqrt(2), "(6 + 4 sqrt 2) Mp/L^2"),
    }[right]
    value = factor * Mp / L**2
    return Reference(value, formula, "Neal, Plastic Methods", "exact", associated=value)


def band(elements: int, right: str, Mp: float, L: float) -> Band:
    """Return the band: rigid between hinges, whose places are found to all digits."""
    return rigid(0.0)


_SIZES = {"Mp": 1.0, "L": 3.0}

BLUNT = "its moments are no sharper than 1e-3, and so is the place of the hinge that it looks for"
REGULARISED = dict.fromkeys(("clarabel-regularised", "ipopt", "newton", "slsqp"), BLUNT)

CASE = Case(
    id="propped-beam",
    title="Beam under a uniform load",
    tags=("frames", "closed form"),
    unit="N/m^2",
    explanation=__doc__,
    hand_calculation="""\
clamped:  hinges at both ends and in the middle, alpha L^2/8 = 2 Mp
propped:  moment at x from the support   alpha x (L - x)/2 - Mp x/L
          its peak is Mp at x = (sqrt(2) - 1) L
          alpha = 2 Mp (3 + 2 sqrt 2)/L^2 = 11.657 Mp/L^2
Mp = 1, L = 3: 1.777778, 1.295206
""",
    build=build,
    reference=reference,
    band=band,
    variants=(
        Variant("propped", {"right": "y", **_SIZES}, unfit=REGULARISED),
        Variant("clamped", {"right": "clamped", **_SIZES}),
    ),
)
