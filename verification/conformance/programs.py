"""Small programs solved by hand: what a backend must find, number by number.

Contact points stand on a plane that rises at 3 in 4: unit normal n = (-0.6, 0.8) away from it, unit
tangent t = (0.8, 0.6) up it, so that nothing lies along an axis. A body on it weighs W = 5, that is
4 against the plane and 3 down it; its contact length is L = 2, so F = L g is its friction.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_matrix

from lacore.arrays import Floats
from lacore.program import ContactRows, DissipationGroup, FrozenContact, KinematicProgram
from lacore.regularization import Penalties
from lacore.status import Status

W, LENGTH = 5.0, 2.0
NORMAL, UPWARD = (-0.6, 0.8), (0.8, 0.6)
WEIGHT = (0.0, -W)


@dataclass(frozen=True)
class Worked:
    """A program and its answer. What is None is not unique, or not known.

    Attributes:
        name: of the program.
        hand: the calculation, for a reader with a pencil.
        program, contact: what the backend is given.
        status: what it must come to.
        load_factor: alpha, the multiplier of ``F0.U = 1``.
        velocity: U, shape (n,).
        stress: of each group, shape (m, dim).
        mean_stress: of each group, shape (m,).
        normal_reaction, tangential_reaction: t_n, shape (m,), and t_t, shape (m, tangent_dim).
        isostatic: equilibrium and the yielding cones alone give the load factor, the stresses and
            the reactions, so that viscosity and penalties change none of them.
        softened: the load factor of the regularised program at given penalties, where it is known.
        unsoftened: why no regularised law says this; empty where one does.
    """

    name: str
    hand: str
    program: KinematicProgram
    contact: FrozenContact
    status: Status = Status.SOLVED
    load_factor: float | None = None
    velocity: npt.ArrayLike | None = None
    stress: tuple[Any, ...] | None = None
    mean_stress: tuple[Any, ...] | None = None
    normal_reaction: npt.ArrayLike | None = None
    tangential_reaction: npt.ArrayLike | None = None
    isostatic: bool = True
    softened: Callable[[Penalties], float] | None = None
    unsoftened: str = ""


def cones(
    rows: npt.ArrayLike,
    weights: Sequence[float],
    bounds: Sequence[float],
    volumetric: npt.ArrayLike | None = None,
    factor: float = 1 / np.sqrt(3),
    name: str = "body",
) -> DissipationGroup:
    """A group of cones; rows of shape (m, dim, n), volumetric (m, n), none is a row of zeros."""
    stacked = np.asarray(rows, dtype=float)
    count, dim, n = stacked.shape
    theta = np.zeros((count, n)) if volumetric is None else np.asarray(volumetric, dtype=float)
    return DissipationGroup(
        name=name,
        rows=csr_matrix(stacked.reshape(count * dim, n)),
        dim=dim,
        weights=np.array(weights, dtype=float),
        bound=np.array(bounds, dtype=float),
        volumetric=csr_matrix(theta),
        volumetric_factor=factor,
    )


def points(
    normal: npt.ArrayLike, tangential: npt.ArrayLike, weights: Sequence[float]
) -> ContactRows:
    """Contact points; rows of shape (m, n) and (m, tangent_dim, n). Their laws are frozen."""
    n_rows, t_rows = np.asarray(normal, dtype=float), np.asarray(tangential, dtype=float)
    count, dim, n = t_rows.shape
    zero = np.zeros(count)
    return ContactRows(
        normal=csr_matrix(n_rows),
        tangential=csr_matrix(t_rows.reshape(count * dim, n)),
        tangent_dim=dim,
        weights=np.array(weights, dtype=float),
        coefficient=zero,
        limit=zero,
        dilatancy=zero,
        interface=zero.astype(int),
    )


def nowhere(n: int) -> ContactRows:
    """No contact points, for n unknowns."""
    return points(np.zeros((0, n)), np.zeros((0, 1, n)), [])


def program(
    groups: Sequence[DissipationGroup],
    contact: ContactRows,
    reference: Sequence[float] | Floats,
    dead: Sequence[float] | Floats | None = None,
) -> KinematicProgram:
    """A program in which every unit is 1."""
    load = np.array(reference, dtype=float)
    weight = np.zeros(load.size) if dead is None else np.array(dead, dtype=float)
    return KinematicProgram(tuple(groups), contact, load, weight)


def frozen(
    bound: Sequence[float] = (), dilatancy: float = 0.0, shift: float = 0.0
) -> FrozenContact:
    """Frozen friction bounds, with one dilatancy and one shift for all points."""
    g = np.array(bound, dtype=float)
    return FrozenContact(g, np.full(g.size, dilatancy), np.full(g.size, shift))


def slope(
    reference: Sequence[float], dead: Sequence[float] = WEIGHT, copies: int = 1
) -> KinematicProgram:
    """A body on the plane, one contact point, no plasticity; or several, each on its own."""
    return program(
        [],
        points(
            np.kron(np.eye(copies), NORMAL),
            np.kron(np.eye(copies), UPWARD).reshape(copies, 1, 2 * copies),
            [LENGTH] * copies,
        ),
        reference,
        dead,
    )


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
            "'one cone' beside a group without cones",
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
    """Elements of size h = 1 ... 1e-4: strain rates as 1/h, weights as h^2, down to 1e-8."""
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


def _contact() -> list[Worked]:
    end_rows = ([[1, 0, 0], [0, 1, 0]], [[[0, 0, 1]], [[0, 0, 1]]])
    beam = program([], points(*end_rows, [1, 0.5]), [-1, 2, 1], [-3, -1, 0])
    rise = 0.8 - 0.4 * 0.6  # horizontal velocity per slip under dilatancy 0.4
    pressed = W / (LENGTH * rise)
    solid = points([[0.36, 0.48, 0.8]], [[[0.8, -0.6, 0], [0.48, 0.64, -0.6]]], [LENGTH])
    pushed = np.array([0.8, -0.6, 0]) * 0.6 + np.array([0.48, 0.64, -0.6]) * 0.8
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
            "a point in space, pushed along 0.6 t_1 + 0.8 t_2, pressed by 5: alpha = F = 1.4",
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
            unsoftened="the regularised law has no friction bound at a dilatant point (T18)",
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
    """Plasticity and contact: a block on the plane, tied to the ground by a cone.

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
        isostatic=False,  # penetration turns the softened flow of the cone
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


WORKED = (*_plasticity(), *_contact(), _mixed(), *_hopeless())


def two_blocks() -> KinematicProgram:
    """Two bodies on planes of their own: one is pushed along x, the other just lies there."""
    return slope([1, 0, 0, 0], [*WEIGHT, *WEIGHT], copies=2)


def sequence() -> list[Worked]:
    """What a loop may ask of one prepared solver: bounds, then rows, then what has no answer."""

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


def many_cones(dim: int = 2, count: int = 150) -> KinematicProgram:
    """No hand calculation: a chain of turned cones of random strength, long enough for limits.

    Node i hangs on node i - 1, and on node i - 7 where there is one; F0 pulls at every node.
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
