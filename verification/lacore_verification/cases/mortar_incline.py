r"""A block on a bed of mortar on an incline is pushed up the slope, or pulled off it.

                      off  o
                        \  +------+   up
                         .'   o    .' -->
                       +--- W | --+
                     .'~~~~~ v .'     c_a, T
                   .'  mu    .'
                 .'        .'
               .'  ) beta
             -----------------

Mortar carries shear without pressure, and some tension. Pushed along, the block shears all of its
bed: adhesion, and friction of its weight. Pulled across, it opens the bed from its upper end on and
turns about the lower one, as its weight does already. Friction makes no difference between Coulomb
and associated loads: reactions follow from equilibrium, or the mechanism does not slip.
"""

from math import cos, sin

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid


def build(
    mu: float, adhesion: float, share: float, beta: float, W: float, b: float, h: float, off: bool
) -> "la.Problem":
    """Return the problem.

    The origin is the middle of the bed; `share`: of the apex c_a/mu, the strength in tension.
    """
    along, across = (cos(beta), sin(beta)), (-sin(beta), cos(beta))

    def box(half: float, low: float, high: float) -> list[tuple[float, float]]:
        corners = ((-half, low), (half, low), (half, high), (-half, high))
        return [(s * along[0] + n * across[0], s * along[1] + n * across[1]) for s, n in corners]

    mortar = la.Coulomb(mu, adhesion=adhesion, tension=share * adhesion / mu)
    blocks = la.BlockAssembly({"slope": box(b, -h, 0), "block": box(b / 2, 0, h)}, mortar)
    return la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", "slope")],
        reference_loads=[la.PointForce("blocks", "block", across if off else along)],
        dead_loads=[la.PointForce("blocks", "block", (0, -W))],
    )


def reference(
    mu: float, adhesion: float, share: float, beta: float, W: float, b: float, h: float, off: bool
) -> Reference:
    """Return the reference: sliding, or opening about the lower end of the bed."""
    if off:
        value = share * adhesion / mu * b + W * cos(beta) - W * sin(beta) * h / b
        formula = "T b + W (cos b - h/b sin b)"
    else:
        value = adhesion * b + W * (mu * cos(beta) + sin(beta))
        formula = "c_a b + W (mu cos b + sin b)"
    return Reference(value, formula, "equilibrium, analytically", "exact", associated=value)


def valid(
    mu: float, adhesion: float, share: float, beta: float, W: float, b: float, h: float, off: bool
) -> bool:
    """Return whether the parameters are valid.

    Pushed, it does not topple; pulled, the bed carries the weight along it.

    All forces act at the centroid: pushed by friction F, the pressure at the rear edge of the bed
    is ``W cos b/b - F h/b^2``, and no less than -T. Pulled off, the bed has left ``c_a - mu T``.
    """
    tension = share * adhesion / mu
    if off:
        return W * sin(beta) < (adhesion - mu * tension) * b
    friction = adhesion * b + mu * W * cos(beta)
    return friction * h < b * (W * cos(beta) + tension * b)


def band(
    elements: int,
    mu: float,
    adhesion: float,
    share: float,
    beta: float,
    W: float,
    b: float,
    h: float,
    off: bool,
) -> Band:
    """Return the band: rigid."""
    return rigid(W + adhesion * b * (1 + share / mu))


_SIZES = {"mu": 0.5, "adhesion": 1.2, "W": 1.0, "b": 4.0, "h": 1.0}

CASE = Case(
    id="mortar-incline",
    title="Rigid block on mortar on an incline",
    tags=("blocks", "contact", "Coulomb", "adhesion", "closed form"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="""\
up:   alpha - W sin b = c_a B + mu W cos b, width B
off:  alpha B/2 + W sin b h/2 = W cos b B/2 + T B^2/2
b = 0.3, mu = 0.5, c_a = T = 1.2, B = 4, h = 1:
      5.573188 up, 5.681456 off, 0.881456 off if T = 0
""",
    build=build,
    reference=reference,
    valid=valid,
    band=band,
    variants=(
        Variant("up", {"share": 0.5, "beta": 0.3, **_SIZES, "off": False}),
        Variant("off", {"share": 0.5, "beta": 0.3, **_SIZES, "off": True}),
        Variant("off-untied", {"share": 0.0, "beta": 0.3, **_SIZES, "off": True}),
    ),
)
