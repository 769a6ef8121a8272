"""Contact points on a plane with analytical solutions, and a sequence of solves in a loop."""

from dataclasses import replace

import numpy as np

from lacore.program.kinematic import KinematicProgram
from lacore.program.reduction import held_shut
from lacore.reporting.status import Status
from lacore_verification.conformance.worked import (
    LENGTH,
    NORMAL,
    UPWARD,
    WEIGHT,
    W,
    Worked,
    cones,
    frozen,
    points,
    program,
    slope,
)


def _contact() -> list[Worked]:
    end_rows = ([[1, 0, 0], [0, 1, 0]], [[[0, 0, 1]], [[0, 0, 1]]])
    beam = program([], points(*end_rows, [1, 0.5]), [-1, 2, 1], [-3, -1, 0])
    rise = 0.8 - 0.4 * 0.6  # horizontal velocity per slip for a dilatancy of 0.4
    pressed = W / (LENGTH * rise)
    solid = points([[0.36, 0.48, 0.8]], [[[0.8, -0.6, 0], [0.48, 0.64, -0.6]]], [LENGTH])
    pushed = np.array([0.8, -0.6, 0]) * 0.6 + np.array([0.48, 0.64, -0.6]) * 0.8
    held = slope(NORMAL)
    torn = held_shut(replace(held, contact=replace(held.contact, tension=np.array([1.5]))))
    return [
        Worked(
            "friction",
            "pushed along x, slides up: alpha = (F + 3)/0.8 = 5.5; L t_n = 4 + 0.6 alpha = 7.3",
            slope([1, 0]),
            frozen([0.7]),
            load_factor=5.5,
            velocity=[1, 0.75],
            normal_reaction=[3.65],
            tangential_reaction=[[-0.7]],
        ),
        Worked(
            "friction down the slope",
            "pushed along -x, slides down: alpha = (F - 3)/0.8 = 0.5; L t_n = 4 - 0.6 alpha = 3.7",
            slope([-1, 0]),
            frozen([1.7]),
            load_factor=0.5,
            velocity=[-1, -0.75],
            normal_reaction=[1.85],
            tangential_reaction=[[1.7]],
        ),
        Worked(
            "driving dead load",
            "a dead load of 5 up the plane as well: alpha = (F + 3 - 5)/0.8 = -0.75",
            slope([1, 0], [4.0, -2.0]),
            frozen([0.7]),
            load_factor=-0.75,
            velocity=[1, 0.75],
            normal_reaction=[1.775],
            tangential_reaction=[[-0.7]],
        ),
        Worked(
            "friction in two directions",
            "a point in three dimensions, pushed along 0.6 t_1 + 0.8 t_2, pressed by 5:"
            " alpha = F = 1.4",
            program([], solid, pushed, -W * np.array([0.36, 0.48, 0.8])),
            frozen([0.7]),
            load_factor=1.4,
            velocity=list(pushed),
            normal_reaction=[2.5],
            tangential_reaction=[[-0.42, -0.56]],
        ),
        Worked(
            "dilatant contact",
            "u = s (t + 0.4 n), 0.56 s = 1: alpha = 5 (0.6 + 0.32) s; upward balance of"
            " L t_n (n - 0.4 t): 0.56 L t_n = 5",
            slope([1, 0]),
            frozen([0.0], dilatancy=0.4),
            load_factor=W * 0.92 / rise,
            velocity=[1, 0.92 / rise],
            normal_reaction=[pressed],
            tangential_reaction=[[-0.4 * pressed]],
        ),
        Worked(
            "dilatant contact with friction",
            "as before, and F = 1.4 against the slip: alpha = (4.6 + 1.4) s; upward"
            " 0.56 L t_n = 5 + 0.6 F",
            slope([1, 0]),
            frozen([0.7], dilatancy=0.4),
            load_factor=(W * 0.92 + 1.4) / rise,
            velocity=[1, 0.92 / rise],
            normal_reaction=[(W + 0.84) / (LENGTH * rise)],
            tangential_reaction=[[-0.7 - 0.4 * (W + 0.84) / (LENGTH * rise)]],
        ),
        Worked(
            "stick",
            "pulled by (1, 3), u_t = 0: u = n/1.8, alpha = 4/1.8; along the plane"
            " L t_t = 3 - 2.6 alpha",
            slope([1, 3]),
            frozen([np.inf]),
            load_factor=4 / 1.8,
            velocity=[-0.6 / 1.8, 0.8 / 1.8],
            normal_reaction=[0],
            tangential_reaction=[[(3 - 2.6 * 4 / 1.8) / LENGTH]],
        ),
        Worked(
            "shift",
            "'friction' with u_n >= -0.3: 0.8 u_t + 0.18 = 1; the load factor, a multiplier, and"
            " the reactions do not feel the shift",
            slope([1, 0]),
            frozen([0.7], shift=0.3),
            load_factor=5.5,
            velocity=[1, 0.6 * 1.025 - 0.24],
            normal_reaction=[3.65],
            tangential_reaction=[[-0.7]],
        ),
        Worked(
            "shift of dilatant contact",
            "'dilatant contact' with u_n >= 0.4 |u_t| - 0.3: 0.56 u_t + 0.18 = 1",
            slope([1, 0]),
            frozen([0.0], dilatancy=0.4, shift=0.3),
            load_factor=W * 0.92 / rise,
            velocity=[1, (0.92 * 0.82 / rise) - 0.24],
            normal_reaction=[pressed],
            tangential_reaction=[[-0.4 * pressed]],
        ),
        Worked(
            "pulled off",
            "'friction' pulled along n with strength 1.5 in tension, a dead load of L 1.5 along -n:"
            " alpha = W 0.8 + L 1.5 = 7, the plane carries t_t = 3/L; t_n = 0 is -1.5",
            torn,
            frozen([1.8]),
            load_factor=7.0,
            velocity=list(NORMAL),
            normal_reaction=[0],
            tangential_reaction=[[1.5]],
        ),
        Worked(
            "both ends closed",
            "a beam on two points, loads 3 and 1 on them, F0 = (-1, 2; 1): lifting the second"
            " costs 1/2, sliding 0.25 + 0.15 = 0.4: slides; L t_n = (3 + alpha, 1 - 2 alpha)",
            beam,
            frozen([0.25, 0.3]),
            load_factor=0.4,
            velocity=[0, 0, 1],
            normal_reaction=[3.4, 0.4],
            tangential_reaction=[[-0.25], [-0.3]],
        ),
        Worked(
            "one end opens",
            "the same beam with friction 0.25 + 0.35 = 0.6: lifts, alpha = 1/2, t_n = (3.5, 0)",
            beam,
            frozen([0.25, 0.7]),
            load_factor=0.5,
            velocity=[0, 0.5, 0],
            normal_reaction=[3.5, 0],
        ),
    ]


def _mixed() -> Worked:
    """Return plasticity and contact: a block on the plane, tied to the ground by a cone.

    min 2.4 |U| - Fd.U with F0 = (0.8, 0.6) up the plane: alpha = F + 3 + 2.4 for u = t; the cone
    pulls back along t with 2.4, so across the plane only the weight acts: L t_n = 4.
    """
    return Worked(
        "plasticity on a rough plane",
        "up the plane: alpha = F + 3 + w b = 1.4 + 3 + 2.4; w s = 2.4 t; L t_n = 4",
        program(
            [cones([np.eye(2)], [0.8], [3])],
            points([NORMAL], [[UPWARD]], [LENGTH]),
            UPWARD,
            WEIGHT,
        ),
        frozen([0.7]),
        load_factor=6.8,
        velocity=UPWARD,
        stress=([[2.4, 1.8]],),
        normal_reaction=[2],
        tangential_reaction=[[-0.7]],
        isostatic=False,  # Penetration changes the direction of the softened flow of the cone.
    )


CONTACT = (*_contact(), _mixed())


def two_blocks() -> KinematicProgram:
    """Return two bodies on separate planes: one is pushed along x, the other is at rest."""
    return slope([1, 0, 0, 0], [*WEIGHT, *WEIGHT], copies=2)


def sequence() -> list[Worked]:
    """Return the requests of a loop to one prepared solver.

    Bounds, then rows, then unsolvable ones.
    """

    def ask(what: str, pushed: float, lying: float, dilatancy: float = 0.0) -> Worked:
        held = replace(frozen([pushed, lying]), dilatancy=np.array([dilatancy, 0.0]))
        rise = 0.8 - 0.6 * dilatancy
        status, value = Status.SOLVED, (3 + 4 * dilatancy + LENGTH * pushed) / rise
        if np.isinf(pushed):
            status = Status.LOCKED
        elif LENGTH * lying < 3:
            status = Status.UNSAFE
        return Worked(
            f"repeated: {what}",
            "alpha = (3 + 4 d + F)/(0.8 - 0.6 d) of the pushed body; the other needs F >= 3",
            two_blocks(),
            held,
            status,
            load_factor=value if status is Status.SOLVED else None,
        )

    return [
        ask("first", 0.7, 2),
        ask("less friction", 0.2, 2),
        ask("the same again", 0.2, 2),
        ask("unsafe", 0.2, 1),
        ask("safe again", 1.1, 2.5),
        ask("locked by stick", np.inf, 2),
        ask("dilatant", 0.0, 2, 0.4),
        ask("more dilatant", 0.0, 2, 0.6),
        ask("first again", 0.7, 2),
    ]
