r"""A wedge is pulled up from between two blocks on a floor.

                       ^ alpha
                 +-----|-----+
        +--------+     o     +--------+
        |         \    | W  /         |
        |   Wb     \   v   /    Wb    |      faces: mu
        |           +-----+           |      beta < phi from the vertical
        +------------+   +------------+
     ///////////////// mu_f ///////////////

The wedge opens both faces at once, so that nothing but its weight holds it: alpha = W, and no
other Coulomb load. Associated friction lets the wedge slide up along faces that dilate and press
the blocks apart, and finds half as much again. This is the case that tells a Coulomb code from one
that is associated in disguise.
"""

from math import atan, cos, sin, tan

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases.symmetric_wedge import GAP, LENGTH, TIP, between_blocks, wedged


def build(mu: float, mu_f: float, beta: float, W: float, Wb: float) -> "la.Problem":
    """Return the problem: the wedge is pulled up."""
    weights = {"left": Wb, "right": Wb, "wedge": W}
    return wedged(between_blocks(mu, mu_f, beta), weights, (0, 1))


def _thrust(mu: float, mu_f: float, beta: float, Wb: float) -> tuple[float, float]:
    """Return the forces of the dilatant wedge on a block: up, and outwards."""
    lean, phi_f = atan(mu) - beta, atan(mu_f)
    R = Wb * sin(phi_f) / cos(lean - phi_f)
    return R * sin(lean), R * cos(lean)


def reference(mu: float, mu_f: float, beta: float, W: float, Wb: float) -> Reference:
    """Return the reference: opening; and what dilatancy makes of it."""
    return Reference(
        W,
        "W; associated W + 2 Wb sin(phi_f) sin(phi - b)/cos(phi - b - phi_f)",
        "equilibrium, analytically; confirmed by mixed-integer programming",
        "exact",
        associated=W + 2 * _thrust(mu, mu_f, beta, Wb)[0],
    )


def valid(mu: float, mu_f: float, beta: float, W: float, Wb: float) -> bool:
    """Return whether the parameters are valid.

    The wedge would clamp (phi > beta > 0), and dilatant it neither lifts nor topples a block.

    The block is thrust up and outwards anywhere on the face, lowest at its tip, against its weight,
    which is at least LENGTH/2.5 away from the outer toe.
    """
    if not 0 < beta < atan(mu):
        return False
    up, out = _thrust(mu, mu_f, beta, Wb)
    lever = GAP + LENGTH - (GAP + TIP * tan(beta))
    return up < Wb and up * lever + out * TIP < Wb * LENGTH / 2.5


def band(elements: int, mu: float, mu_f: float, beta: float, W: float, Wb: float) -> Band:
    """Return the band: rigid."""
    return rigid(W + 2 * Wb)


_WEIGHTS = {"W": 1.0, "Wb": 2.0}

CASE = Case(
    id="wedge-extraction",
    title="Wedge pulled from between two blocks: not associated",
    tags=("blocks", "contact", "Coulomb", "closed form", "associated differs"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="""\
Coulomb:     moving up at rate v opens the faces, u_n = v sin b > 0
             so t = 0 there, and alpha = W
associated:  faces slide with u_n = mu u_t, the blocks move apart
             wedge:  2 R sin(phi - b) = alpha - W
             block:  R cos(phi - b) = mu_f (Wb - R sin(phi - b))
             alpha = W + 2 Wb sin(phi_f) sin(phi - b)
                         / cos(phi - b - phi_f)
W = 1, Wb = 2: b = .2, mu = .5, mu_f = .5: 1 against 1.475664
               b = .1, mu = .3, mu_f = .4: 1 against 1.287815
""",
    build=build,
    reference=reference,
    valid=valid,
    band=band,
    variants=(
        Variant("rough", {"mu": 0.5, "mu_f": 0.5, "beta": 0.2, **_WEIGHTS}),
        Variant("slippery", {"mu": 0.3, "mu_f": 0.4, "beta": 0.1, **_WEIGHTS}),
    ),
)
