r"""A block on a rough floor is shaken sideways, in any direction psi over the floor.

          +------+                    y
         /  b   /|                    |   / alpha W
        +------+ |      from above:   +--/----+
        |      | |                    | / psi |
        |  W   | | h                  |o------|--> x
        |      | +                    |       |
        |      |/ b                   +-------+
     ///+------+/// mu

It slides, or topples over the edge that the push is most across: over an edge, not over a corner,
as long as psi is not 45 degrees, where it may do either.

The load is unique although the pressures at four corners are not: the moment of the push moves
their resultant along the push, so that friction ``alpha/mu`` of every corner's limit, all along the
push, is in equilibrium below the collapse load for any of these pressures.
"""

from math import cos, pi, sin

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases.shared.solids import on_floor, shaken


def build(mu: float, b: float, h: float, psi: float) -> "la.Problem":
    """Return the problem: block and floor."""
    blocks = la.BlockAssembly3D(on_floor(b, h), mu)
    return shaken(blocks, ("floor",), (cos(psi), sin(psi), 0.0))


def reference(mu: float, b: float, h: float, psi: float) -> Reference:
    """Return the reference: the smaller of sliding and toppling."""
    value = min(mu, b / h / max(abs(cos(psi)), abs(sin(psi))))
    formula = "min(mu, (b/h)/max(|cos psi|, |sin psi|))"
    # Dilatant friction moves blocks up, against their weight: that costs as much as it slips.
    return Reference(value, formula, "moments, analytically", "exact", associated=value)


def band(elements: int, mu: float, b: float, h: float, psi: float) -> Band:
    """Return the band: rigid; alpha is in weights."""
    return rigid(1.0)


def _variant(name: str, psi: float, mu: float = 0.7, h: float = 2.0) -> Variant:
    return Variant(name, {"mu": mu, "b": 1.0, "h": h, "psi": psi})


CASE = Case(
    id="block-azimuth",
    title="Block shaken in any direction",
    tags=("blocks", "space", "contact", "Coulomb", "closed form"),
    unit="W",
    explanation=__doc__,
    hand_calculation="""\
sliding:   alpha W = mu W
toppling:  about the edge x = b/2,
           alpha W cos(psi) h/2 = W b/2
together:  alpha = min(mu, (b/h)/max(|cos psi|, |sin psi|))
""",
    build=build,
    reference=reference,
    band=band,
    variants=(
        _variant("along", 0.0),
        _variant("oblique", 0.4),
        _variant("diagonal", pi / 4),
        _variant("slides", 1.9, mu=0.3, h=1.0),
    ),
)
