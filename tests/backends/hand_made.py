"""Small programs with load factors known by hand, for the backends that solve them exactly."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from lacore.program.certificate import certify
from lacore.program.kinematic import ContactRows, DissipationGroup, FrozenContact, KinematicProgram


def group(rows, bound, *, dim=1, weight=1.0, volumetric=None, name="body"):
    """Cones of `dim` rows; weight and bound are those of each cone."""
    rows = np.atleast_2d(np.asarray(rows, float))
    count, n = rows.shape[0] // dim, rows.shape[1]
    return DissipationGroup(
        name=name,
        rows=csr_matrix(rows),
        dim=dim,
        weights=np.full(count, weight, float),
        bound=np.full(count, bound, float),
        volumetric=csr_matrix(np.zeros((count, n)) if volumetric is None else volumetric),
        volumetric_factor=1.0,
    )


def contact(normal, tangential, weights, tangent_dim=1):
    """Contact rows; the laws are what a test freezes."""
    zero = np.zeros(len(weights))
    return ContactRows(
        normal=csr_matrix(np.asarray(normal, float)),
        tangential=csr_matrix(np.asarray(tangential, float)),
        tangent_dim=tangent_dim,
        weights=np.asarray(weights, float),
        coefficient=zero,
        limit=zero,
        dilatancy=zero,
        interface=zero.astype(int),
    )


def program(reference, groups=(), rows=None, dead=None):
    reference = np.asarray(reference, float)
    if rows is None:
        rows = contact(np.zeros((0, reference.size)), np.zeros((0, reference.size)), [])
    dead = np.zeros(reference.size) if dead is None else np.asarray(dead, float)
    return KinematicProgram(tuple(groups), rows, reference, dead)


def frozen(bound=(), dilatancy=0.0, shift=0.0):
    bound = np.array(bound, dtype=float)
    return FrozenContact(bound, np.zeros(bound.size) + dilatancy, np.zeros(bound.size) + shift)


NO_CONTACT = frozen()
LENGTH, M_P = 3.0, 2.0


def clamped_beam(load, elements=8, ends=2):
    """A beam of `elements` rigid segments, hinges at all nodes, the unknowns its deflections.

    `ends`: how many of its two ends are clamped; a pinned end has no hinge.
    """
    h, inner = LENGTH / elements, elements - 1
    deflection = np.vstack([np.zeros(inner), np.eye(inner), np.zeros(inner)])
    slopes = np.diff(deflection, axis=0) / h
    hinges = np.diff(slopes, axis=0)
    if ends >= 1:
        hinges = np.vstack([slopes[:1], hinges])
    if ends == 2:
        hinges = np.vstack([hinges, -slopes[-1:]])
    return program(load(inner, h), [group(hinges, M_P, name="hinges")])


def mid_load(inner, h):
    return np.eye(inner)[inner // 2]


def uniform_load(inner, h):
    return np.full(inner, h)


AREA, WEIGHT = 2.0, 5.0  # one contact point of weight AREA under a dead load WEIGHT


def sliding_block(reference=(0.0, 1.0), dead=(-WEIGHT, 0.0)):
    """Unknowns (u_n, u_t) of one contact point."""
    return program(reference, rows=contact([[1, 0]], [[0, 1]], [AREA]), dead=dead)


def block_in_space():
    """Unknowns (u_n, u_1, u_2), pulled along (0.6, 0.8)."""
    rows = contact([[1, 0, 0]], [[0, 1, 0], [0, 0, 1]], [AREA], tangent_dim=2)
    return program([0, 0.6, 0.8], rows=rows, dead=[-WEIGHT, 0, 0])


@dataclass(frozen=True)
class HandMade:
    """A program, the contact to solve it with, and what is known of the answer.

    `velocity`, `stress`, `normal` and `tangential` are given where they are unique.
    """

    program: KinematicProgram
    load_factor: float
    contact: FrozenContact = NO_CONTACT
    velocity: tuple | None = None
    stress: tuple | None = None
    normal: tuple | None = None
    tangential: tuple | None = None


square = np.eye(2)
LINEAR = {
    # Clamped: hinges at both ends and under the load, rotating 2, 4 and 2 times u/L.
    "clamped beam": HandMade(
        clamped_beam(mid_load),
        8 * M_P / LENGTH,
        velocity=tuple(np.minimum(np.arange(1, 8), np.arange(7, 0, -1)) / 4),
        stress=tuple(M_P * np.array([1, 0.5, 0, -0.5, -1, -0.5, 0, 0.5, 1])),
    ),
    "pinned beam": HandMade(clamped_beam(mid_load, ends=0), 4 * M_P / LENGTH),
    "uniformly loaded beam": HandMade(clamped_beam(uniform_load), 16 * M_P / LENGTH**2),
    "frozen friction": HandMade(
        sliding_block(),
        AREA * 0.7,
        frozen([0.7]),
        velocity=(0, 1),
        normal=(WEIGHT / AREA,),
        tangential=(-0.7,),
    ),
    "frozen friction, the other way": HandMade(
        sliding_block((0.0, -1.0)),
        AREA * 0.7,
        frozen([0.7]),
        velocity=(0, -1),
        normal=(WEIGHT / AREA,),
        tangential=(0.7,),
    ),
    "dilatancy": HandMade(
        sliding_block(),
        WEIGHT * 0.4,
        frozen([0.0], 0.4),
        velocity=(0.4, 1),
        normal=(WEIGHT / AREA,),
        tangential=(-0.4 * WEIGHT / AREA,),
    ),
    "friction and dilatancy": HandMade(
        sliding_block((0.0, -1.0)),
        AREA * 0.7 + WEIGHT * 0.4,
        frozen([0.7], 0.4),
        velocity=(0.4, -1),
        normal=(WEIGHT / AREA,),
        tangential=(0.7 + 0.4 * WEIGHT / AREA,),
    ),
    "shift": HandMade(
        sliding_block(),
        WEIGHT * 0.4,
        frozen([0.0], 0.4, 0.3),
        velocity=(0.1, 1),
        normal=(WEIGHT / AREA,),
    ),
    "smooth": HandMade(sliding_block(), 0.0, frozen([0.0]), velocity=(0, 1), tangential=(0,)),
    "stick": HandMade(
        sliding_block((1.0, 3.0)),
        WEIGHT,
        frozen([np.inf]),
        velocity=(1, 0),
        normal=(0,),
        tangential=(-3 * WEIGHT / AREA,),
    ),
    "opening": HandMade(
        sliding_block((1.0, 0.0)), WEIGHT, frozen([0.7]), velocity=(1, 0), normal=(0,)
    ),
    "driving dead load": HandMade(
        sliding_block(dead=(-WEIGHT, 3.0)), AREA * 0.7 - 3.0, frozen([0.7]), velocity=(0, 1)
    ),
    # A rod of strength 3 beside an empty group, dragged over a point of friction 0.7.
    "empty group and friction": HandMade(
        program(
            [0, 1],
            [
                group(np.zeros((0, 2)), 1.0, dim=2, name="empty"),
                group([[0, 1]], 3.0, weight=2.0),
            ],
            contact([[1, 0]], [[0, 1]], [AREA]),
            [-WEIGHT, 0],
        ),
        2 * 3 + AREA * 0.7,
        frozen([0.7]),
        velocity=(0, 1),
        tangential=(-0.7,),
    ),
    # u_0 = u_1 said three times over; the mean stresses are not unique, their sum is.
    "redundant rows": HandMade(
        program(
            [1, 0],
            [group([[1, 0], [0, 1], [1, 0]], 3.0, weight=2.0, volumetric=[[1, -1]] * 3)],
        ),
        18.0,
        velocity=(1, 1),
    ),
    "two groups": HandMade(
        program([1, 1], [group([[1, 0]], 1.0), group([[0, 1]], 4.0, weight=0.01)]),
        0.04,
        velocity=(0, 1),
    ),
}
CONIC = {
    # min 2 * 3 ||U||, (0.6, 0.8).U = 1: U = F0, w s = alpha F0.
    "cone": HandMade(
        program([0.6, 0.8], [group(square, 3.0, dim=2, weight=2.0)]),
        6.0,
        velocity=(0.6, 0.8),
        stress=(1.8, 2.4),
    ),
    "cone with a volume": HandMade(
        program([1, 0], [group(square, 3.0, dim=2, weight=2.0, volumetric=[[1, -1]])]),
        6 * np.sqrt(2),
        velocity=(1, 1),
        stress=(3 / np.sqrt(2), 3 / np.sqrt(2)),
    ),
    "cone beside a bar": HandMade(
        program(
            [0.6, 0.8],
            [group(square, 3.0, dim=2, weight=2.0), group([[0.6, 0.8]], 1.5, name="bar")],
        ),
        7.5,
        velocity=(0.6, 0.8),
    ),
    "friction in space": HandMade(
        block_in_space(),
        AREA * 0.7,
        frozen([0.7]),
        velocity=(0, 0.6, 0.8),
        normal=(WEIGHT / AREA,),
        tangential=(-0.42, -0.56),
    ),
    "dilatancy in space": HandMade(
        block_in_space(),
        WEIGHT * 0.4,
        frozen([0.0], 0.4),
        velocity=(0.4, 0.6, 0.8),
        normal=(WEIGHT / AREA,),
        tangential=(-0.6, -0.8),
    ),
}

LOCKED = {
    "into the obstacle": (sliding_block((-1.0, 0.0)), frozen([0.5])),
    "by stick": (sliding_block(), frozen([np.inf])),
    "by incompressibility": (
        program([0, 1], [group([[1, 0]], 1.0, volumetric=[[0, 1]])]),
        frozen(),
    ),
}
UNSAFE = {
    # A dead load of 3 along a frozen friction of 1.4.
    "dead load slides it": (sliding_block((1.0, 0.0), (-WEIGHT, 3.0)), frozen([0.7])),
    "dead load lifts it": (sliding_block(dead=(WEIGHT, 0.0)), frozen([0.7])),
}


def random_linear_program(seed):
    """Cones of one row, enough of them that nothing moves freely, four contact points."""
    rng = np.random.default_rng(seed)
    n, cones, points = 12, 14, 4
    body = DissipationGroup(
        name="body",
        rows=csr_matrix(rng.uniform(-1, 1, (cones, n))),
        dim=1,
        weights=10 ** rng.uniform(-2, 0, cones),
        bound=rng.uniform(0.5, 2, cones),
        volumetric=csr_matrix(np.zeros((cones, n))),
        volumetric_factor=1.0,
    )
    rows = contact(
        rng.uniform(-1, 1, (points, n)),
        rng.uniform(-1, 1, (points, n)),
        rng.uniform(0.1, 1, points),
    )
    return program(rng.uniform(-1, 1, n), [body], rows, 1e-3 * rng.uniform(-1, 1, n))


def random_contact(rng, points=4):
    """Any mixture of stick, friction, dilatancy and shifts."""
    bound = rng.choice([0.0, 0.3, np.inf], points)
    dilatancy = np.where(np.isinf(bound), 0.0, rng.choice([0.0, 0.5], points))
    return FrozenContact(bound, dilatancy, rng.choice([0.0, 0.2], points))


def check_answer(known, point, tolerance):
    """The known numbers of a program against a point, and the certificate of the point.

    Numbers are close to `tolerance` of the load factor.
    """
    scale = max(1.0, abs(known.load_factor))

    def close(found, expected):
        if expected is not None:
            np.testing.assert_allclose(np.ravel(found), expected, atol=tolerance * scale)

    close(point.load_factor, known.load_factor)
    close(point.velocity, known.velocity)
    close(point.normal_reaction, known.normal)
    close(point.tangential_reaction, known.tangential)
    if known.stress is not None:
        close(np.concatenate([stress.ravel() for stress in point.stress]), known.stress)
    # A certificate knows of no shift, and where no power is turned over it has nothing to scale by.
    if known.load_factor and not known.contact.shift.any():
        certificate = certify(known.program, point, known.contact)
        assert certificate.holds(tolerance), certificate
