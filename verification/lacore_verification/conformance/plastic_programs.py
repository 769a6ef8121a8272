"""Programs of cones alone with analytical solutions, and a long chain without one."""

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.program.kinematic import KinematicProgram
from lacore_verification.conformance.worked import Worked, cones, frozen, nowhere, program


def _turned(angle: float) -> Floats:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def _plasticity() -> list[Worked]:
    one = cones([np.eye(2)], [2], [3])
    f = np.array([0.6, 0.8])
    flowing = cones([[[1, 0, 0], [0, 1, 0]]], [0.5], [2], [[1, 1, -1]])
    halves = cones([[[1, 0, 0], [0, 1, 0]]] * 2, [0.3, 0.2], [2, 2], [[1, 1, -1]] * 2)
    first, apart = np.eye(2, 4), np.eye(2, 4, 2) - np.eye(2, 4)
    root = np.sqrt(5)
    return [
        Worked(
            "one cone",
            "min 6 |U| with F0.U = 1, |F0| = 1: U = F0, alpha = 6, w s = alpha F0",
            program([one], nowhere(2), f),
            frozen(),
            load_factor=6,
            velocity=f,
            stress=(3 * f[None],),
        ),
        Worked(
            "volumetric row",
            "U_2 = U_0 + U_1 leaves (2, 1).(U_0, U_1) = 1, w b = 1: alpha = 1/sqrt 5;"
            " equilibrium of U_2: w p = -alpha",
            program([flowing], nowhere(3), [1, 0, 1]),
            frozen(),
            load_factor=1 / root,
            velocity=[0.4, 0.2, 0.6],
            stress=([[4 / root, 2 / root]],),
            mean_stress=([-2 / root],),
            isostatic=False,
        ),
        Worked(
            "redundant row",
            "the cone of 'volumetric row' cut in two: the same row of theta twice",
            program([halves], nowhere(3), [1, 0, 1]),
            frozen(),
            load_factor=1 / root,
            velocity=[0.4, 0.2, 0.6],
            stress=([[4 / root, 2 / root]] * 2,),
            isostatic=False,
        ),
        Worked(
            "several cones",
            "two nodes: ground to first carries 2, first to second 0.5 + 0.75: the second flows"
            " alone, alpha = 1.25; the stress on the way is alpha F0",
            program(
                [cones([first], [1], [2]), cones([apart, apart], [0.5, 0.25], [1, 3])],
                nowhere(4),
                [0, 0, *f],
            ),
            frozen(),
            load_factor=1.25,
            velocity=[0, 0, *f],
            stress=(1.25 * f[None], np.array([f, 3 * f])),
        ),
        Worked(
            "cone of five rows",
            "min 1.5 |U| with F0.U = 1, F0 = (1, 2, 2, 4, 0)/5 of length 1, one row unused",
            program([cones([np.eye(5)], [0.5], [3])], nowhere(5), [0.2, 0.4, 0.4, 0.8, 0]),
            frozen(),
            load_factor=1.5,
            velocity=[0.2, 0.4, 0.4, 0.8, 0],
            stress=([[0.6, 1.2, 1.2, 2.4, 0]],),
        ),
        Worked(
            "dead load across",
            "Fd = F0 + 3.6 g, g across F0: U = F0 + y g, min 6 sqrt(1 + y^2) - 1 - 3.6 y at"
            " y = 0.75: alpha = 3.8, U = (0, 1.25), w s = alpha F0 + Fd = (0, 6)",
            program([one], nowhere(2), f, f + 3.6 * np.array([-0.8, 0.6])),
            frozen(),
            load_factor=3.8,
            velocity=[0, 1.25],
            stress=([[0, 3]],),
        ),
        Worked(
            "empty group",
            "'one cone' next to a group without cones",
            program(
                [cones(np.zeros((0, 3, 2)), [], [], np.zeros((0, 2)), name="none"), one],
                nowhere(2),
                f,
            ),
            frozen(),
            load_factor=6,
            velocity=f,
            stress=(None, 3 * f[None]),
        ),
        _graded(f),
        _beam(),
    ]


def _graded(f: Floats) -> Worked:
    """Return elements of size h = 1 ... 1e-4: strain rates as 1/h, weights as h^2, down to 1e-8."""
    sizes = 10.0 ** -np.arange(5)
    n = 2 * (1 + sizes.size)
    strong, weak, stress = [], [], []
    for number, h in enumerate(sizes):
        own = np.zeros((2, n))
        own[:, 2 * number : 2 * number + 2] = _turned(number + 1.0) / h
        last = np.zeros((2, n))
        last[:, -2:] = _turned(number + 1.0) / h
        strong.append(own)
        weak.append(last - own)
        stress.append(_turned(number + 1.0) @ f)
    weights = list(sizes**2)
    return Worked(
        "badly scaled",
        "to the loaded node lead five chains of a strong and a weak element of size h: the weak"
        " flow, alpha = sum h = 1.1111; the stress of both is F0, turned as their rows",
        program(
            [cones(strong, weights, [2] * 5), cones(weak, weights, [1] * 5)],
            nowhere(n),
            [0] * (n - 2) + list(f),
        ),
        frozen(),
        load_factor=float(sizes.sum()),
        velocity=[0] * (n - 2) + list(f),
        stress=(np.array(stress), np.array(stress)),
    )


def _beam() -> Worked:
    rates = [[1, 0, 0], [2, -1, 0], [-1, 2, -1], [0, -1, 2], [0, 0, 1]]
    return Worked(
        "plastic hinges",
        "clamped beam, span 4, M_p = 1.5, P = 2 at midspan, deflections of the quarter points:"
        " hinges at the ends and the middle, alpha = 8 M_p/(P span) = 1.5; no moment between",
        program([cones(np.array(rates)[:, None], [1] * 5, [1.5] * 5)], nowhere(3), [0, 2, 0]),
        frozen(),
        load_factor=1.5,
        velocity=[0.25, 0.5, 0.25],
        stress=([[1.5], [0], [1.5], [0], [1.5]],),
    )


PLASTIC = tuple(_plasticity())


def many_cones(dim: int = 2, count: int = 150) -> KinematicProgram:
    """Return a chain of rotated cones of random strength, long enough for tests of limits.

    It has no analytical solution. Node i depends on node i - 1, and on node i - 7 if there is one;
    F0 acts at every node.
    """
    rng = np.random.default_rng(0)
    n = dim * count
    rows = []
    for node in range(count):
        for back in (1, 7):
            own = np.zeros((dim, n))
            turn = np.linalg.qr(rng.normal(size=(dim, dim)))[0]
            own[:, dim * node : dim * (node + 1)] = turn
            if node >= back:
                own[:, dim * (node - back) : dim * (node - back + 1)] = -turn
            rows.append(own)
    size = len(rows)
    group = cones(rows, list(rng.uniform(0.5, 1, size)), list(rng.uniform(0.5, 2, size)))
    load = rng.normal(size=n)
    return program([group], nowhere(n), load / np.linalg.norm(load))
