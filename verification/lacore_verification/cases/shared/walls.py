"""Masonry walls of Ferris & Tin-Loi (IJMS 43, 2001): courses, problem, band of their cases."""

from collections.abc import Sequence

import lacore as la
from lacore_verification.case import Band, Reference, rigid

BLOCK = (0.4, 0.175)  # m
MU = 0.65  # of all joints, in the literature
_A, _B = (0.5, 1, 1, 1, 1, 0.5), (1, 1, 1, 1, 1)
_E, _U = (1, 1, 1, 1), (0.5, 1, 1, 1, 0.5)
_e, _u = (1, 0.5, -1, 0.5, 1), (0.5, 1, -1, 1, 0.5)  # with an opening
WALL_1 = (_A, _B) * 3
WALL_2 = (_A, _B) * 5
WALL_3 = (_E, _U, _E, _u, _e, _u, _e, _u, _E, _U, _E)

SOURCE = (
    "Ferris & Tin-Loi 2001, Gilbert, Casapulla & Ahmed 2006 (associated value, to 5 digits);"
    " interval by independent linear programs"
)


def shaken(blocks: "la.BlockAssembly", held: tuple[str, ...] = ("base",)) -> "la.Problem":
    """Return own weight as dead load, alpha times it to the right; some blocks are fixed."""
    own = tuple(name for name in blocks.names if name not in held)
    return la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", name) for name in held],
        reference_loads=[la.BodyForce("blocks", (1, 0), own)],
        dead_loads=[la.BodyForce("blocks", (0, -1), own)],
    )


def wall(rows: Sequence[Sequence[float]], mu: float) -> "la.Problem":
    """Return a wall from its courses, on a rigid base, `shaken`."""
    return shaken(la.masonry.running_bond(rows, mu, BLOCK))


def listed(low: float, high: float, associated: float) -> Reference:
    """Return the reference to Coulomb loads of one mechanism; others may have other loads."""
    return Reference(
        low,
        "linear programs",
        SOURCE,
        "interval of one mechanism",
        up_to=high,
        associated=associated,
        complete=False,
    )


def band(elements: int, mu: float) -> Band:
    """Return the references are rounded to six digits; alpha is in weights."""
    return rigid(1.0)


HYPERSTATIC = {
    "regularised": "undetermined clamping forces in the head joints: penalties take the reaction"
    " loop tens of solves, of which IPOPT fails some"
}
HAND = """\
analytically:     one block on one joint: alpha = min(mu, b/h), as in
             block-topple; a wall is weaker: blocks topple in
             groups that split along a staircase of joints
associated:  one linear program, {associated}
Coulomb:     reactions are hyperstatic, loads not unique: the
             mechanism found carries any of
             [{low}, {high}]
"""
