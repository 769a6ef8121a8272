"""Programs of rigid blocks written down by hand: points of contact, weights, loads."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import csr_matrix

from lacore.program.kinematic import ContactRows, KinematicProgram

FIXED = -1  # the number of the world


@dataclass(frozen=True)
class Touch:
    """A contact point: `normal` points from the master into the slave."""

    slave: int
    master: int
    at: tuple
    normal: tuple
    mu: float


def edge(slave, master, start, end, normal, mu):
    """The two ends of a joint."""
    return [Touch(slave, master, at, normal, mu) for at in (start, end)]


def blocks(centres, touches, reference, dead):
    """Unknowns (u_x, u_y, omega) a block; loads are forces (f_x, f_y) at the centres."""
    centres = np.array(centres, float)
    n, m = 3 * len(centres), len(touches)

    def rows(direction):
        entries = np.zeros((m, n))
        for row, touch in enumerate(touches):
            d = direction(np.array(touch.normal, float))
            for body, sign in ((touch.slave, 1.0), (touch.master, -1.0)):
                if body != FIXED:
                    x, y = np.array(touch.at) - centres[body]
                    entries[row, 3 * body : 3 * body + 3] += sign * np.array(
                        [d[0], d[1], x * d[1] - y * d[0]]
                    )
        return csr_matrix(entries)

    def load(forces):
        return np.column_stack([np.array(forces, float), np.zeros(len(centres))]).ravel()

    return KinematicProgram(
        groups=(),
        contact=ContactRows(
            normal=rows(lambda n: n),
            tangential=rows(lambda n: np.array([-n[1], n[0]])),
            tangent_dim=1,
            weights=np.ones(m),
            coefficient=np.array([touch.mu for touch in touches]),
            limit=np.zeros(m),
            dilatancy=np.zeros(m),
            interface=np.arange(m) // 2,
        ),
        reference_load=load(reference),
        dead_load=load(dead),
    )


def rough_stop(mu_floor=0.3, mu_joint=0.5, mu_wall=0.4, lower=2.0, upper=1.0):
    """CLOSED_FORMS C5b: the lower block is pulled to the right from under one held by a stop.

    The upper block is held at its right face, so the stop's normal points to the left.
    """
    return blocks(
        centres=[(0, 0.5), (0, 1.5)],
        touches=[
            *edge(0, FIXED, (-2, 0), (2, 0), (0, 1), mu_floor),
            *edge(1, 0, (-1, 1), (1, 1), (0, 1), mu_joint),
            *edge(1, FIXED, (1, 1), (1, 2), (-1, 0), mu_wall),
        ],
        reference=[(1, 0), (0, 0)],
        dead=[(0, -lower), (0, -upper)],
    )


def plug(mu=0.5, mu_floor=0.4, weight=1.0, side=2.0):
    """CLOSED_FORMS C7, beta = 0: a plug with vertical faces pressed down between two blocks."""
    return blocks(
        centres=[(-1, 0.5), (0, 0.5), (1, 0.5)],
        touches=[
            *edge(0, FIXED, (-1.5, 0), (-0.5, 0), (0, 1), mu_floor),
            *edge(2, FIXED, (0.5, 0), (1.5, 0), (0, 1), mu_floor),
            *edge(1, 0, (-0.5, 0.2), (-0.5, 1), (1, 0), mu),
            *edge(1, 2, (0.5, 0.2), (0.5, 1), (-1, 0), mu),
        ],
        reference=[(0, 0), (0, -1), (0, 0)],
        dead=[(0, -side), (0, -weight), (0, -side)],
    )


def between_walls(mu=0.5, weight=1.0):
    """REFERENCES: a block lifted between two rigid walls, every wedging force is possible."""
    return blocks(
        centres=[(0, 0.5)],
        touches=[
            *edge(0, FIXED, (-0.5, 0), (-0.5, 1), (1, 0), mu),
            *edge(0, FIXED, (0.5, 0), (0.5, 1), (-1, 0), mu),
        ],
        reference=[(0, 1)],
        dead=[(0, -weight)],
    )


def sliding_block(mu=0.3, weight=1.0):
    """CLOSED_FORMS C1: a unit block pushed along a floor at its centre."""
    return blocks(
        centres=[(0, 0.5)],
        touches=edge(0, FIXED, (-0.5, 0), (0.5, 0), (0, 1), mu),
        reference=[(1, 0)],
        dead=[(0, -weight)],
    )


def wall(courses=((1, 1, 1), (0.5, 1, 1, 0.5), (1, 1, 1)), mu=0.65, high=0.4):
    """Running bond on a floor, pushed sideways by the weights."""
    boxes = []
    for course, widths in enumerate(courses):
        ends = np.concatenate([[0], np.cumsum(widths)])
        boxes += [(a, b, course) for a, b in pairwise(ends)]
    touches = []
    for i, (left, right, course) in enumerate(boxes):
        y = course * high
        if course == 0:
            touches += edge(i, FIXED, (left, y), (right, y), (0, 1), mu)
        for j, (start, end, other) in enumerate(boxes):
            a, b = max(left, start), min(right, end)
            if other == course - 1 and b > a:
                touches += edge(i, j, (a, y), (b, y), (0, 1), mu)
            if other == course and np.isclose(start, right):
                touches += edge(j, i, (right, y), (right, y + high), (1, 0), mu)
    weights = np.array([(b - a) * high for a, b, _ in boxes])
    return blocks(
        centres=[((a + b) / 2, (course + 0.5) * high) for a, b, course in boxes],
        touches=touches,
        reference=np.column_stack([weights, 0 * weights]),
        dead=np.column_stack([0 * weights, -weights]),
    )
