r"""A wedge between two fixed walls is pulled up, or pushed down.

                       ^ alpha
                 +-----|-----+
        +--------+     o     +--------+
        |/////////\    | W  /|////////|
        |//////////\   v   /|/////////|      faces: mu
        |//////////.+-----+.//////////|      beta from the vertical
        +------------+   +------------+

Pulled up the faces open: alpha = W for any friction. Associated friction lets nothing rise where
phi > beta: its load is +inf, and so the usual start of the coupling loop does not exist. Pushed
down nothing can move: the load factor is +inf, proven without friction already.
"""

from math import atan, inf

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases.symmetric_wedge import between_blocks, wedged


def build(mu: float, beta: float, W: float, down: bool) -> "la.Problem":
    """Return the problem: the blocks of `symmetric-wedge`, fixed."""
    return wedged(between_blocks(mu, mu, beta), {"wedge": W}, (0, -1 if down else 1))


def reference(mu: float, beta: float, W: float, down: bool) -> Reference:
    """Return the reference: opening, or locked."""
    source = "equilibrium, analytically; confirmed by mixed-integer programming"
    if down:
        return Reference(inf, "no motion", source, "status", status=la.Status.LOCKED)
    associated = inf if beta < atan(mu) else W
    formula = "W; associated +inf if b < phi, else W"
    return Reference(W, formula, source, "exact", associated=associated)


def valid(mu: float, beta: float, W: float, down: bool) -> bool:
    """Return whether the parameters are valid.

    With vertical faces the wedge would not open them: see `block-between-walls`.
    """
    return beta > 0


def band(elements: int, mu: float, beta: float, W: float, down: bool) -> Band:
    """Return the band: rigid."""
    return rigid(W)


CASE = Case(
    id="wedge-in-walls",
    title="Wedge between fixed walls: associated friction locks it",
    tags=("blocks", "contact", "Coulomb", "closed form", "associated differs", "status"),
    unit="N/m",
    explanation=__doc__,
    hand_calculation="""\
up:          moving at rate v opens the faces, u_n = v sin b > 0
             so t = 0, alpha = W
associated:  u_n = v sin b >= mu u_t = mu v cos b
             only if b >= phi: then alpha = W, else nothing moves
down:        u_n = -v sin b < 0: nothing moves, alpha = +inf
""",
    build=build,
    reference=reference,
    valid=valid,
    band=band,
    variants=(
        Variant("clamping", {"mu": 0.5, "beta": 0.2, "W": 1.0, "down": False}),
        Variant("loose", {"mu": 0.2, "beta": 0.5, "W": 1.0, "down": False}),
        Variant(
            "pushed-down",
            {"mu": 0.5, "beta": 0.2, "W": 1.0, "down": True},
            unfit={"regularised": "penalties give way where nothing can move"},
        ),
    ),
)
