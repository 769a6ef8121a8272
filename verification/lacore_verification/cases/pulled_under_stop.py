r"""A block is pulled from under another one, which a vertical stop holds back.

                               |//|
              +------------+   |//|
              |   2, W2    | mu_w |      the stop is rigid and fixed
              |            +---|//|
        +-----+--- mu2 ----+---+--+
        |        1, W1            | ---> alpha
        +---------- mu1 ----------+
     /////////////////////////////////

The upper block stays, and its friction on the lower one presses it against the stop. There it does
not slide: the friction F of the stop is not determined, it may hold the block up or press it down.
With a rough stop the collapse load is therefore *not unique*: every value of an interval is a
Coulomb limit load, with one and the same mechanism. With a smooth stop there is one.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid

LOWER, UPPER, HEIGHT = 6.0, 4.0, 1.0  # widths of the blocks, and their height
STOP = (0.25, 0.75)  # of the height of the upper block: where it touches the stop


def build(mu1: float, mu2: float, mu_w: float, W1: float, W2: float) -> "la.Problem":
    """Return the problem: two blocks and the stop."""
    rectangle = la.masonry.rectangle
    low, high = (HEIGHT * (1 + part) for part in STOP)
    blocks = la.BlockAssembly(
        {
            "floor": rectangle(-LOWER, LOWER, -HEIGHT, 0),
            "lower": rectangle(-LOWER / 2, LOWER / 2, 0, HEIGHT),
            "upper": rectangle(-UPPER / 2, UPPER / 2, HEIGHT, 2 * HEIGHT),
            "stop": rectangle(UPPER / 2, UPPER / 2 + HEIGHT, low, high),
        },
        friction=mu1,
        joint_friction={("lower", "upper"): mu2, ("upper", "stop"): mu_w},
    )
    return la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", "floor"), la.Fix("blocks", "stop")],
        reference_loads=[la.PointForce("blocks", "lower", (1, 0))],
        dead_loads=[
            la.PointForce("blocks", "lower", (0, -W1)),
            la.PointForce("blocks", "upper", (0, -W2)),
        ],
    )


def pressures(mu2: float, mu_w: float, W2: float) -> tuple[float, float]:
    """Return the smallest and largest normal force N between the blocks."""
    return W2 / (1 + mu2 * mu_w), W2 / (1 - mu2 * mu_w)


def reference(mu1: float, mu2: float, mu_w: float, W1: float, W2: float) -> Reference:
    """Return the reference.

    The interval that the stop's friction opens; its upper end is the associated load.
    """
    low, high = (mu2 * N + mu1 * (W1 + N) for N in pressures(mu2, mu_w, W2))
    source = "equilibrium, analytically; ends confirmed by mixed-integer programming"
    if mu_w > 0:
        formula = "mu2 N + mu1 (W1 + N), N = W2/(1 -+ mu2 mu_w)"
        return Reference(low, formula, source, "interval", up_to=high, associated=high)
    return Reference(low, "mu1 (W1 + W2) + mu2 W2", source, "exact", associated=low)


def valid(mu1: float, mu2: float, mu_w: float, W1: float, W2: float) -> bool:
    """Return whether the parameters are valid.

    The upper block does not lock against the stop (mu2 mu_w < 1), and nothing topples.

    On the upper block friction mu2 N at its base and the stop's reaction turn it by at most mu2 N
    h2, the stop's friction by mu_w mu2 N b2/2: N stays within half the width. The lower block is
    pulled at half its height, against friction on both its faces.
    """
    if mu2 * mu_w >= 1:
        return False
    N = pressures(mu2, mu_w, W2)[1]
    turned = mu2 * N * (STOP[1] * HEIGHT + mu_w * UPPER / 2)
    below = (mu2 * N + mu1 * (W1 + N)) * HEIGHT / 2 + turned + mu2 * N * HEIGHT
    return turned < pressures(mu2, mu_w, W2)[0] * UPPER / 2 and below < W1 * LOWER / 2


def band(elements: int, mu1: float, mu2: float, mu_w: float, W1: float, W2: float) -> Band:
    """Return the band: rigid."""
    return rigid(W1 + W2)


_GIVEN = {"mu1": 0.3, "mu2": 0.5}

CASE = Case(
    id="pulled-under-stop",
    title="Block pulled from under another one: loads that are not unique",
    tags=("blocks", "contact", "Coulomb", "closed form", "interval"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="""\
between the blocks:  normal force N, friction mu2 N
stop:                reaction R = mu2 N, friction -mu_w R <= F <= mu_w R
upper block:         N = W2 + F
                     N in [W2/(1 + mu2 mu_w), W2/(1 - mu2 mu_w)]
lower block:         alpha = mu2 N + mu1 (W1 + N)
W1 = 2, W2 = 1, mu1 = .3, mu2 = .5:
                     smooth stop: 1.4
                     mu_w = .4:   any of [1.266667, 1.6]
""",
    build=build,
    reference=reference,
    valid=valid,
    band=band,
    variants=(
        Variant("smooth-stop", {**_GIVEN, "mu_w": 0.0, "W1": 2.0, "W2": 1.0}),
        *(
            Variant(f"mu_w-{mu_w:g}", {**_GIVEN, "mu_w": mu_w, "W1": 2.0, "W2": 1.0})
            for mu_w in (0.2, 0.4, 0.6)
        ),
    ),
    sweep="mu_w",
)
