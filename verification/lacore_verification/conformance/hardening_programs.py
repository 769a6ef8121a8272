"""Features of a step of a path (T29) with analytical solutions: hardening, distant contact.

A cone of weight w, bound c and modulus h costs ``w (c L + h L^2/2)`` at the length L of its strain
rate, and its stress there is ``c + h L``. The load factor is a multiplier: the increase of the cost
for a small increase of ``F0.U = 1``. Softened by a stiffness K, the cone has ``L = p + s/K``, ``s =
c + h p``. Bodies are on the plane of `worked`.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from lacore.program.kinematic import ContactRows, DissipationGroup, FrozenContact, reaction_contact
from lacore.program.regularization import Penalties
from lacore_verification.conformance.worked import (
    LENGTH,
    NORMAL,
    UPWARD,
    WEIGHT,
    Worked,
    cones,
    frozen,
    nowhere,
    points,
    program,
)


def hardening(
    rows: npt.ArrayLike,
    weights: Sequence[float],
    bounds: Sequence[float],
    moduli: Sequence[float],
    volumetric: npt.ArrayLike | None = None,
) -> DissipationGroup:
    """Return cones as those of `cones`, with moduli."""
    return replace(cones(rows, weights, bounds, volumetric), modulus=np.array(moduli, dtype=float))


def _two() -> list[DissipationGroup]:
    return [
        hardening([[[1, 0]]], [2], [1], [1]),
        hardening([[[0, 1]]], [0.5], [1], [4]),
    ]


def two_that_harden() -> Worked:
    """Return two cones that share a load by their hardening."""
    return Worked(
        "hardening shares the load",
        "u_1 + u_2 = 1, 2 (1 + u_1) = (1 + 4 u_2)/2 = alpha: u = (1, 7)/8, alpha = 2.25; softened"
        " alpha/2 - 1 + (2 alpha - 1)/4 + 2.5 alpha/K = 1",
        program(_two(), nowhere(2), [1, 1]),
        frozen(),
        load_factor=2.25,
        velocity=[0.125, 0.875],
        stress=([[1.125]], [[4.5]]),
        isostatic=False,
        softened=lambda penalty: 2.25 / (1 + 2.5 / penalty.eta),
    )


def _one_softened(penalty: Penalties) -> float:
    return 2 * (3 + 0.5 * (penalty.eta - 3) / (penalty.eta + 0.5))


def _cones() -> list[Worked]:
    f = np.array([0.6, 0.8])
    root = np.sqrt(5)
    return [
        Worked(
            "one cone that hardens",
            "'one cone' with h = 1/2, |U| = 1: alpha = 2 (3 + 1/2); softened p = (K - 3)/(K + 1/2)",
            program([hardening([np.eye(2)], [2], [3], [0.5])], nowhere(2), f),
            frozen(),
            load_factor=7,
            velocity=f,
            stress=(3.5 * f[None],),
            isostatic=False,
            softened=_one_softened,
        ),
        two_that_harden(),
        Worked(
            "hardening up to a neighbour",
            "u_1 + u_2 = 1, one cone of 3/2 does not harden, the other has (1 + 4 u_2)/2: u_2 ="
            " 1/2, alpha = 3/2, softened too",
            program(
                [hardening([[[1, 0]], [[0, 1]]], [1, 0.5], [1.5, 1], [0, 4])], nowhere(2), [1, 1]
            ),
            frozen(),
            load_factor=1.5,
            velocity=[0.5, 0.5],
            stress=([[1.5], [3]],),
            isostatic=False,
            softened=lambda _: 1.5,
        ),
        Worked(
            "volumetric row and hardening",
            "'volumetric row', L = 1/sqrt 5, with h L = 2: the stress is 4 in place of 2",
            program(
                [hardening([[[1, 0, 0], [0, 1, 0]]], [0.5], [2], [2 * root], [[1, 1, -1]])],
                nowhere(3),
                [1, 0, 1],
            ),
            frozen(),
            load_factor=2 / root,
            velocity=[0.4, 0.2, 0.6],
            stress=([[8 / root, 4 / root]],),
            mean_stress=([-4 / root],),
            isostatic=False,
        ),
    ]


def _above(distance: float, limit: float = 0.0) -> tuple[ContactRows, FrozenContact]:
    """Return a point with a distance to close, and the friction limit at the start of a loop."""
    touching = points([NORMAL], [[UPWARD]], [LENGTH])
    rows = replace(touching, closing=np.array([distance]), limit=np.array([limit]))
    return rows, reaction_contact(rows, np.zeros(1))


def closing_and_hardening(limit: float) -> Worked:
    """Return a body with hardening that closes a distance and slides."""
    rows, contact = _above(0.75, limit)
    return Worked(
        "a distance, hardening, friction",
        "as before with 1 + 0.8 |U| = 2 and friction F: alpha = F + 3 + 1.28, L t_n = 4 - 0.96",
        program([hardening([np.eye(2)], [0.8], [1], [0.8])], rows, UPWARD, WEIGHT),
        contact,
        load_factor=LENGTH * limit + 4.28,
        velocity=[1.25, 0],
        stress=([[2, 0]],),
        normal_reaction=[1.52],
        tangential_reaction=[[-limit]],
        isostatic=False,
    )


def _distances() -> list[Worked]:
    rows, contact = _above(0.75)
    far, unpressed = _above(1.0)
    tied = cones([np.eye(2)], [0.8], [3])
    return [
        Worked(
            "a distance that closes",
            "up the plane by 1 and down to it by 3/4: U = (1.25, 0), held back by 2.4 along it:"
            " alpha = 3 + 1.92, L t_n = 4 - 1.44",
            program([tied], rows, UPWARD, WEIGHT),
            contact,
            load_factor=4.92,
            velocity=[1.25, 0],
            stress=([[3, 0]],),
            normal_reaction=[1.28],
            tangential_reaction=[[0]],
            isostatic=False,
        ),
        closing_and_hardening(0.7),
        Worked(
            "a distance that stays",
            "pressed by 3, held by 2 (1 + 1.2 |U|): in balance across the plane where u_n = -3/4,"
            " above the -1 that is free; alpha = 4",
            program(
                [hardening([np.eye(2)], [2], [1], [1.2])],
                far,
                UPWARD,
                -3 * np.array(NORMAL),
            ),
            unpressed,
            load_factor=4,
            velocity=[1.25, 0],
            stress=([[2.5, 0]],),
            normal_reaction=[0],
            tangential_reaction=[[0]],
            isostatic=False,
        ),
    ]


HARDENING = (*_cones(), *_distances())
