r"""A block on an incline is pushed along the slope, up or down.

                        +------+   up
                    .'   o    .' -->
                  +----- | --+
                .'////// v W
              .'  mu
            .'
          .'  )  beta
        -----------------

Pushed down, the load factor is negative where tan(beta) > mu: the block has to be held back, and
-alpha is the force for it. The load is unique, as the normal reactions follow from equilibrium.
"""

from math import cos, sin

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid


def inclined(mu: float, beta: float, b: float, h: float) -> "la.BlockAssembly":
    """Return a block on a slope; the origin is the middle of its base."""
    along, up = (cos(beta), sin(beta)), (-sin(beta), cos(beta))

    def place(s: float, n: float) -> tuple[float, float]:
        return s * along[0] + n * up[0], s * along[1] + n * up[1]

    return la.BlockAssembly(
        {
            "slope": [place(-b, -h), place(b, -h), place(b, 0), place(-b, 0)],
            "block": [place(-b / 2, 0), place(b / 2, 0), place(b / 2, h), place(-b / 2, h)],
        },
        friction=mu,
    )


def pushed(blocks: "la.BlockAssembly", W: float, direction: tuple[float, float]) -> "la.Problem":
    """Return the block, pushed at its centroid."""
    return la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", "slope")],
        reference_loads=[la.PointForce("blocks", "block", direction)],
        dead_loads=[la.PointForce("blocks", "block", (0, -W))],
    )


def stands(mu: float, b: float, h: float) -> bool:
    """Return whether a block that slides does not topple.

    All forces act at the centroid, so that the reaction, inclined phi, crosses the base mu h/2 off
    its middle.
    """
    return mu * h < b


def build(mu: float, beta: float, W: float, b: float, h: float, down: bool) -> "la.Problem":
    """Return the problem: pushed along the slope."""
    side = -1 if down else 1
    return pushed(inclined(mu, beta, b, h), W, (side * cos(beta), side * sin(beta)))


def reference(mu: float, beta: float, W: float, b: float, h: float, down: bool) -> Reference:
    """Return the reference: sliding."""
    value = W * (mu * cos(beta) - sin(beta) if down else mu * cos(beta) + sin(beta))
    formula = f"W (mu cos b {'-' if down else '+'} sin b)"
    return Reference(value, formula, "equilibrium, analytically", "exact", associated=value)


def valid(mu: float, beta: float, W: float, b: float, h: float, down: bool) -> bool:
    """Return whether the parameters are valid: see `stands`."""
    return stands(mu, b, h)


def band(elements: int, mu: float, beta: float, W: float, b: float, h: float, down: bool) -> Band:
    """Return the band: rigid."""
    return rigid(W)


_SIZES = {"W": 1.0, "b": 4.0, "h": 1.0}

CASE = Case(
    id="block-incline",
    title="Rigid block pushed along an incline",
    tags=("blocks", "contact", "Coulomb", "closed form", "negative load"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="""\
across the slope:  t_n = W cos b
along it, up:      alpha - W sin b = mu W cos b
down:              alpha + W sin b = mu W cos b
b = 0.3, mu = 0.5: 0.773188 up,  0.182148 down
b = 0.3, mu = 0.2: 0.486588 up, -0.104453 down (held back)
""",
    build=build,
    reference=reference,
    valid=valid,
    band=band,
    variants=tuple(
        Variant(f"{name}-mu-{mu:g}", {"mu": mu, "beta": 0.3, **_SIZES, "down": down})
        for mu in (0.5, 0.2)
        for name, down in (("up", False), ("down", True))
    ),
)
