r"""A wedge is pushed down between two blocks on a floor.

                       | alpha
                 +-----v-----+
        +--------+     o     +--------+
        |         \    | W  /         |
        |   Wb     \   v   /    Wb    |      faces: mu
        |           +-----+           |      beta from the vertical
        +------------+   +------------+
     ///////////////// mu_f ///////////////

Each face turns the push into a thrust at beta + phi below the horizontal. Friction of the wedge
feeds the friction of the floor: where beta + phi + phi_f reaches 90 degrees the wedge jams, however
hard it is pushed. A load factor below zero means that the weight alone drives the blocks apart. The
load is unique, as a wedge that goes down slips on both faces, which fixes the inclination of both
thrusts; equilibrium gives their size.

With vertical faces (beta = 0) the wedge is a plug, clamped by a force that nothing determines: it
slides at any clamping force up to the one that moves the blocks. The Coulomb loads are an interval.
"""

from math import atan, cos, inf, pi, sin, tan

import lacore as la
from lacore_verification.case import JAM, Band, Case, Reference, Variant, rigid

GAP, LENGTH, TIP, TOP = 0.5, 4.0, 0.2, 0.6  # half gap, length of a block, ends of the faces


def between_blocks(mu: float, mu_f: float, beta: float) -> "la.BlockAssembly":
    """Return floor, two blocks, and the wedge in the gap between them."""
    right = [
        (GAP, 0.0),
        (GAP + LENGTH, 0.0),
        (GAP + LENGTH, TOP),
        (GAP + TOP * tan(beta), TOP),
    ]
    low, high = GAP + TIP * tan(beta), GAP + TOP * tan(beta)
    reach = GAP + LENGTH + 1
    return la.BlockAssembly(
        {
            "floor": la.masonry.rectangle(-reach, reach, -1, 0),
            "left": [(-x, y) for x, y in right],
            "right": right,
            "wedge": [(-low, TIP), (low, TIP), (high, TOP), (-high, TOP)],
        },
        friction=mu,
        joint_friction={("floor", "left"): mu_f, ("floor", "right"): mu_f},
    )


def wedged(
    blocks: "la.BlockAssembly", weights: dict[str, float], direction: tuple[float, float]
) -> "la.Problem":
    """Return the wedge loaded at its centroid, the floor fixed, and what weighs nothing with it."""
    return la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", name) for name in blocks.names if name not in weights],
        reference_loads=[la.PointForce("blocks", "wedge", direction)],
        dead_loads=[la.PointForce("blocks", name, (0, -W)) for name, W in weights.items()],
    )


def build(mu: float, mu_f: float, beta: float, W: float, Wb: float) -> "la.Problem":
    """Return the problem: the wedge is pushed down."""
    weights = {"left": Wb, "right": Wb, "wedge": W}
    return wedged(between_blocks(mu, mu_f, beta), weights, (0, -1))


def reference(mu: float, mu_f: float, beta: float, W: float, Wb: float) -> Reference:
    """Return the reference: blocks slide apart; jamming; or, of a plug, an interval."""
    phi, phi_f = atan(mu), atan(mu_f)
    formula = "2 Wb sin(phi_f) sin(b + phi)/cos(b + phi + phi_f) - W"
    source = "equilibrium, analytically; confirmed by mixed-integer programming"
    if beta + phi + phi_f >= pi / 2:
        return Reference(inf, formula, source, "status", status=la.Status.JAM, associated=inf)
    value = 2 * Wb * sin(phi_f) * sin(beta + phi) / cos(beta + phi + phi_f) - W
    if beta > 0:
        return Reference(value, formula, source, "exact", associated=value)
    formula = f"from -W to {formula}, b = 0"
    return Reference(-W, formula, source, "interval", up_to=value, associated=value)


def valid(mu: float, mu_f: float, beta: float, W: float, Wb: float) -> bool:
    """Return whether the parameters are valid.

    The blocks do not topple about their outer toes; a plug does not jam.

    The thrust R acts anywhere on the face, lowest at its tip: R cos(b + phi), which is mu_f times
    the force on the floor, turns outwards with lever TIP, the rest back.
    """
    phi, phi_f = atan(mu), atan(mu_f)
    if beta + phi + phi_f >= pi / 2:
        return beta > 0
    R = Wb * sin(phi_f) / cos(beta + phi + phi_f)
    down, out = R * sin(beta + phi), R * cos(beta + phi)
    own = Wb * LENGTH / 2.5  # the centroid is at least so far from the toe
    return out * TIP < own + down * (LENGTH - TIP * tan(beta))


def band(elements: int, mu: float, mu_f: float, beta: float, W: float, Wb: float) -> Band:
    """Return the band: rigid."""
    return rigid(W + 2 * Wb)


_WEIGHTS = {"W": 1.0, "Wb": 2.0}

CASE = Case(
    id="symmetric-wedge",
    title="Wedge pushed down between two blocks",
    tags=("blocks", "contact", "Coulomb", "closed form", "jamming", "interval"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="""\
reaction R on each face, inclined phi against its normal:
wedge:     2 R sin(b + phi) = alpha + W
block:     R cos(b + phi) = mu_f (Wb + R sin(b + phi))
           R = Wb sin(phi_f)/cos(b + phi + phi_f)
together:  alpha = 2 Wb sin(phi_f) sin(b + phi)
                   / cos(b + phi + phi_f) - W
jam:       b + phi + phi_f >= 90 degrees
W = 1, Wb = 2: b = .35, mu = .5, mu_f = .5:  3.493987
               b = .2,  mu = .3, mu_f = .3: -0.234815
plug:      b = 0: R from 0 (slides down by its weight, alpha = -W)
           to that value; mu = .5, mu_f = .4: any of [-1, 0]
""",
    build=build,
    reference=reference,
    valid=valid,
    band=band,
    variants=(
        Variant("rough", {"mu": 0.5, "mu_f": 0.5, "beta": 0.35, **_WEIGHTS}),
        Variant("slippery", {"mu": 0.3, "mu_f": 0.3, "beta": 0.2, **_WEIGHTS}),
        Variant("plug", {"mu": 0.5, "mu_f": 0.4, "beta": 0.0, **_WEIGHTS}),
        Variant("jam", {"mu": 0.8, "mu_f": 0.8, "beta": 0.35, **_WEIGHTS}, unfit=JAM),
    ),
)
