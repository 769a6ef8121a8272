r"""A block on an incline is pushed horizontally, against the slope.

                        +------+
    alpha -----------> .' o   .'
                  +------ | -+
                .'/////// v W
              .'  mu
            .'
          .'  )  beta
        -----------------

The push presses the block on the slope, and the friction with it grows. The reaction is inclined by
beta + phi, phi = atan(mu), against the vertical: where that is 90 degrees or more, no force moves
the block. The rate of the reaction loop is mu tan(beta): towards 1 it crawls, and 1 is jamming. The
load is unique, as the normal reactions follow from equilibrium and the push.
"""

from math import atan, inf, pi, tan

import lacore as la
from lacore_verification.case import JAM, Band, Case, Reference, Variant, rigid
from lacore_verification.cases.block_incline import inclined, pushed, stands


def build(mu: float, beta: float, W: float, b: float, h: float) -> "la.Problem":
    """Return the problem: pushed horizontally at the centroid."""
    return pushed(inclined(mu, beta, b, h), W, (1, 0))


def reference(mu: float, beta: float, W: float, b: float, h: float) -> Reference:
    """Return the reference: sliding, or jamming."""
    lean = beta + atan(mu)
    formula, source = "W tan(b + phi), jam if b + phi >= 90 degrees", "equilibrium, analytically"
    if lean >= pi / 2:
        return Reference(inf, formula, source, "status", status=la.Status.JAM, associated=inf)
    return Reference(W * tan(lean), formula, source, "exact", associated=W * tan(lean))


def valid(mu: float, beta: float, W: float, b: float, h: float) -> bool:
    """Return whether the parameters are valid: it does not topple, see `stands`."""
    return stands(mu, b, h)


def band(elements: int, mu: float, beta: float, W: float, b: float, h: float) -> Band:
    """Return the band: rigid."""
    return rigid(W)


_SIZES = {"W": 1.0, "b": 4.0, "h": 1.0}

CASE = Case(
    id="block-incline-horizontal",
    title="Rigid block pushed horizontally against an incline",
    tags=("blocks", "contact", "Coulomb", "closed form", "jamming"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="""\
reaction:   inclined phi against the normal of the slope,
            so b + phi against the vertical
triangle:   W vertical, alpha horizontal:
            alpha = W tan(b + phi)
b = 0.3:    mu = 0.5: 0.957418,  mu = 0.2: 0.540270
jam:        b + phi >= 90 degrees, as mu tan b >= 1
""",
    build=build,
    reference=reference,
    valid=valid,
    band=band,
    variants=(
        *(Variant(f"mu-{mu:g}", {"mu": mu, "beta": 0.3, **_SIZES}) for mu in (0.2, 0.5, 0.7)),
        Variant("jam", {"mu": 1.5, "beta": 0.9, **_SIZES}, unfit=JAM),
    ),
    sweep="mu",
)
