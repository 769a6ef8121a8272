"""Plane rigid blocks and frames with analytical solutions: cones of one row, or no group at all.

A block is 2 wide and 4 high and weighs W = 5; its unknowns are (u_x, u_y, rotation) of its centre.
It rests on its two lower corners, each with a contact length of 1. Pushed at its centre it tips at
alpha = W/2, or slides before.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from lacore.program.kinematic import ContactRows, DissipationGroup, FrozenContact, KinematicProgram
from lacore.reporting.status import Status
from lacore_verification.conformance.worked import (
    W,
    Worked,
    cones,
    frozen,
    nowhere,
    points,
    program,
)

_LYING = (0.0, -W, 0.0)


def block(
    groups: Sequence[DissipationGroup] = (), reference: Sequence[float] = (1, 0, 0)
) -> KinematicProgram:
    """Return a block on its two lower corners, pushed at its centre."""
    return program(groups, _corners([[0, 1, -1], [0, 1, 1]], [[1, 0, 2]] * 2), reference, _LYING)


def _corners(normal: npt.ArrayLike, tangential: Sequence[Sequence[float]]) -> ContactRows:
    count = len(tangential)
    return points(normal, np.array(tangential)[:, None], [1.0] * count)


def _worked() -> list[Worked]:
    hinge = cones([[[1, 0, 0]]], [1], [1.2], name="hinge")
    lifted = FrozenContact(np.zeros(2), np.full(2, 0.4), np.array([0.3, 0.1]))
    stacked = program(
        [],
        _corners(
            [[0, 1, -1, 0, 0, 0], [0, 1, 1, 0, 0, 0], [0, -1, 1, 0, 1, -1], [0, -1, -1, 0, 1, 1]],
            [[1, 0, 2, 0, 0, 0]] * 2 + [[-1, 0, 2, 1, 0, 2]] * 2,
        ),
        [0, 0, 0, 1, 0, 0],
        [*_LYING, *_LYING],
    )
    rotations = [[1, 0], [1, -1], [0, 2], [1, 1], [1, 0]]
    return [
        Worked(
            "block that slides",
            "alpha = F = 0.3 + 0.5; t_n = 2.5 -+ alpha, the moment of alpha at half height 2",
            block(),
            frozen([0.3, 0.5]),
            load_factor=0.8,
            velocity=[1, 0, 0],
            normal_reaction=[1.7, 3.3],
            tangential_reaction=[[-0.3], [-0.5]],
        ),
        Worked(
            "block that tilts",
            "about its right corner: 2 alpha = 5; the open corner has a bound of 0",
            block(),
            frozen([0, 3]),
            load_factor=2.5,
            velocity=[1, 0.5, -0.5],
            normal_reaction=[0, 5],
            tangential_reaction=[[0.0], [-2.5]],
        ),
        Worked(
            "block of dilatant joints",
            "slides and rises 0.4: alpha = 0.4 W = 2; t_n = 2.5 -+ 2",
            block(),
            frozen([0, 0], dilatancy=0.4),
            load_factor=2,
            velocity=[1, 0.4, 0],
            normal_reaction=[0.5, 4.5],
            tangential_reaction=[[-0.2], [-1.8]],
        ),
        Worked(
            "block of shifted joints",
            "u_y -+ w + s = 0.4 (1 + 2 w), s = 0.3 and 0.1: w = 0.1; alpha and t as without shifts",
            block(),
            lifted,
            load_factor=2,
            velocity=[1, 0.28, 0.1],
            normal_reaction=[0.5, 4.5],
            tangential_reaction=[[-0.2], [-1.8]],
        ),
        Worked(
            "block held by a hinge",
            "'block that slides' against a hinge of moment 1.2: alpha = 0.8 + 1.2; the hinge acts"
            " at the centre, as alpha does, so t_n is as before",
            block([hinge]),
            frozen([0.3, 0.5]),
            load_factor=2,
            velocity=[1, 0, 0],
            stress=([[1.2]],),
            normal_reaction=[1.7, 3.3],
            tangential_reaction=[[-0.3], [-0.5]],
        ),
        Worked(
            "block that is locked",
            "pushed into the floor",
            block(reference=[0, -1, 0]),
            frozen([0.3, 0.5]),
            Status.LOCKED,
        ),
        Worked(
            "two blocks",
            "the upper of two equal blocks is pushed and slides on the lower, which sticks:"
            " alpha = F = 0.8; below, t_n = 5 -+ 0.8 (4 + 2)/2",
            stacked,
            frozen([np.inf, np.inf, 0.3, 0.5]),
            load_factor=0.8,
            velocity=[0, 0, 0, 1, 0, 0],
            normal_reaction=[2.6, 7.4, 1.7, 3.3],
            isostatic=False,  # Softened, the lower block gives way, too.
        ),
        Worked(
            "portal",
            "clamped feet, M_p = 1; H h = 3 on the sway, V l = 2 on the beam, rotations of both:"
            " combined mechanism 6 M_p/(3 + 2) = 1.2 < 4/3 < 2; the corner keeps 3.6 - 3 = 0.6",
            program(
                [cones(np.array(rotations)[:, None], [1] * 5, [1] * 5, name="hinges")],
                nowhere(2),
                [3, 2],
            ),
            frozen(),
            load_factor=1.2,
            velocity=[0.2, 0.2],
            stress=([[1], [0.6], [1], [1], [1]],),
        ),
    ]


RIGID = tuple(_worked())
