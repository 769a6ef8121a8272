"""Programs without a solution: no velocity with ``F0.U = 1``, or unbounded work of dead loads."""

import numpy as np

from lacore.reporting.status import Status
from lacore_verification.conformance.worked import (
    UPWARD,
    Worked,
    cones,
    frozen,
    nowhere,
    program,
    slope,
)


def _hopeless() -> list[Worked]:
    locked, unsafe = Status.LOCKED, Status.UNSAFE
    incompressible = cones([[[0.8, 0.6]]], [1], [1], [[-0.6, 0.8]])
    return [
        Worked(
            "locked by an obstacle",
            "pressed into the plane, F > 3 holds it there: F0.u = -u_n = 1 is impossible",
            slope([0.6, -0.8]),
            frozen([1.7]),
            locked,
        ),
        Worked(
            "locked by stick",
            "F0 along the plane, u_t = 0",
            slope(UPWARD),
            frozen([np.inf]),
            locked,
        ),
        Worked(
            "locked by incompressibility",
            "F0.U is theta, which is 0",
            program([incompressible], nowhere(2), [-0.6, 0.8]),
            frozen(),
            locked,
        ),
        Worked(
            "unsafe on friction",
            "lifted; 3 down the plane against F = 1.4",
            slope([-0.6, 0.8]),
            frozen([0.7]),
            unsafe,
        ),
        Worked(
            "unsafe in plasticity",
            "7 across F0 against w b = 6",
            program([cones([np.eye(2)], [2], [3])], nowhere(2), [0.6, 0.8], [-5.6, 4.2]),
            frozen(),
            unsafe,
        ),
    ]


HOPELESS = tuple(_hopeless())
