r"""A block on a slope is pushed across it, along its contour line.

                 /|  z' normal to the slope
                / |
        alpha W .----.           from above the slope:
          <----/ W  /|               slip
              +----+ |             `-.   downhill: W sin(beta)
          ___/|    | +  mu            `+----+
      ___/    |    |/                  |    | <--- alpha W
    _/ beta   +----+                   +----+

The weight already uses part of the friction, downhill; the rest, across the slope, is the other
side of a right triangle. The block slides neither downhill nor across, but along the resultant. It
does not turn: pushed at its centroid, its pressure moves along that resultant, too. No
two-dimensional problem shows that. The load is therefore unique although the pressures at four
corners are not: below it, equal shares of the friction at every corner balance the resultant for
any of them.
"""

from math import cos, sin, sqrt

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases.shared.solids import on_floor


def build(mu: float, beta: float) -> "la.Problem":
    """Return the problem.

    Block and slope, z normal to it, y along the contour line, downhill along x.
    """
    blocks = la.BlockAssembly3D(on_floor(1.0, 0.2), mu)
    weight = 1 / 0.2
    return la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", "floor", "xyz")],
        reference_loads=[la.PointForce("blocks", "block", (0.0, 1.0, 0.0))],
        dead_loads=[
            la.BodyForce("blocks", (weight * sin(beta), 0.0, -weight * cos(beta)), "block")
        ],
    )


def reference(mu: float, beta: float) -> Reference:
    """Return the reference: a right triangle of forces."""
    value = sqrt((mu * cos(beta)) ** 2 - sin(beta) ** 2)
    formula = "W sqrt(mu^2 cos^2(beta) - sin^2(beta))"
    return Reference(value, formula, "equilibrium, analytically", "exact", associated=value)


def valid(mu: float, beta: float) -> bool:
    """Return whether the parameters are valid: the block stays on the slope by itself."""
    return mu * cos(beta) > sin(beta)


def band(elements: int, mu: float, beta: float) -> Band:
    """Return the band: rigid; alpha is in weights."""
    return rigid(1.0)


CASE = Case(
    id="incline-cross",
    title="Block pushed across a slope",
    tags=("blocks", "space", "contact", "Coulomb", "closed form"),
    unit="W",
    explanation=__doc__,
    hand_calculation="""\
normal force:  N = W cos(beta)
friction:      has to carry W sin(beta) downhill
               and alpha W across: a right triangle
slip:          (W sin(beta))^2 + (alpha W)^2 = (mu N)^2
""",
    build=build,
    reference=reference,
    band=band,
    valid=valid,
    variants=(
        Variant("gentle", {"mu": 0.6, "beta": 0.2}),
        Variant("steep", {"mu": 0.6, "beta": 0.5}),
    ),
)
