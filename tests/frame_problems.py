"""Portal frames on fixed feet and on feet that slide, for tests."""

import numpy as np
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

import lacore as la

FLOOR = la.RigidObstacle((0.0, 0.0), (0.0, 1.0))
DOWN, RIGHT = (0.0, -1.0), (1.0, 0.0)


def portal(h=2.0, span=4.0, m_p=1.0, **given):
    return la.Frame(
        nodes={"A": (0, 0), "B": (0, h), "C": (span, h), "D": (span, 0)},
        members={"left": ("A", "B"), "beam": ("B", "C"), "right": ("D", "C")},
        plastic_moment=m_p,
        **given,
    )


def storeys(draw):
    """Two storeys with diagonals: nodes, and members c.. (columns), b. (beams) and d."""
    span, high = draw.uniform(2, 5), draw.uniform(2, 4)
    nodes = {f"{x}{y}": (x * span, y * high) for x in (0, 1) for y in (0, 1, 2)}
    members = {f"c{x}{y}": (f"{x}{y}", f"{x}{y + 1}") for x in (0, 1) for y in (0, 1)}
    members |= {f"b{y}": (f"0{y}", f"1{y}") for y in (1, 2)}
    return nodes, members | {"d": ("00", "11")}


def force(node, vector):
    return la.PointForce("frame", node, vector)


def solved(frame, loads, supports, dead=(), backend="highs", **options):
    fixed = [la.Fix("frame", where, components) for where, components in supports]
    problem = la.Problem({"frame": frame}, loads, fixed, dead_loads=dead)
    return la.solve(problem, backend=backend, throw=True, **options)


def storeys_both_ways(frame, live, dead):
    """The load factor of storeys on clamped feet, and that of an independent linear program.

    live, dead: forces (N, 2) on nodes.
    """
    feet = np.array([name[1] == "0" for name in frame.names])
    loads, permanent = (
        [force(name, tuple(vector)) for name, vector in zip(frame.names, own, strict=True)]
        for own in (live, dead)
    )
    state = solved(frame, loads, [(("00", "10"), "clamped")], permanent)
    return state.load_factor, static_load_factor(frame, live, dead, feet)


def resting(mu, p, loads, h, span, m_p):
    """A portal whose feet rest on a floor, under p on each column; the same, clamped, mu None."""
    feet = {"interfaces": [la.Interface(("frame", ("A", "D")), FLOOR, mu)]}
    clamped = {"supports": [la.Fix("frame", ("A", "D"), "clamped")]}
    dead = [la.PointForce("frame", node, (0, -p)) for node in "BC"] if p > 0 else []
    return la.Problem(
        {"frame": portal(h, span, m_p)},
        loads,
        dead_loads=dead,
        **(clamped if mu is None else feet),
    )


def pushed(mu, p, h=2.0, span=4.0, m_p=1.0):
    """CLOSED_FORMS C11."""
    return resting(mu, p, [la.PointForce("frame", "B", RIGHT)], h, span, m_p)


def pushed_exact(mu, p, h=2.0, span=4.0, m_p=1.0):
    sliding = (mu * p + m_p / h) / (1 + mu * h / span)
    return min(2 * m_p / h, 2 * mu * p, sliding, p * span / h)


def pressed(mu, p, h=2.0, span=4.0, m_p=1.0):
    """CLOSED_FORMS C12; with p = 0 frame-feet of REFERENCES."""
    return resting(mu, p, [la.PointForce("frame", (span / 2, h), DOWN)], h, span, m_p)


def pressed_exact(mu, p, h=2.0, span=4.0, m_p=1.0):
    thrust = span - 2 * mu * h
    spread = 4 * (m_p + mu * h * p) / thrust if thrust > 0 else np.inf
    return min(8 * m_p / span, spread)


def static_load_factor(frame, live, dead, clamped):
    """Largest alpha by the static theorem, an independent LP in forces.

    Unknown are alpha and, of each piece, its tension N and the moments M_i, M_j that act on its
    ends, all anticlockwise; each node that is not clamped is in balance.

    live, dead: forces (N, 2) on nodes. clamped: (N,) bool. Sections with an axial limit are held by
    inequalities, side by side of their polygons.
    """
    pieces, count = frame.pieces, len(frame.names)
    e = (frame.position[:, pieces.end] - frame.position[:, pieces.start]) / pieces.length
    columns = 1 + 3 * pieces.length.size
    balance, right = np.zeros((count, 3, columns)), np.zeros((count, 3))
    balance[:, :2, 0], right[:, :2] = live, -dead
    for k, (i, j) in enumerate(pieces.nodes):
        tension, first, second = range(1 + 3 * k, 4 + 3 * k)
        across = np.array([-e[1, k], e[0, k]]) / pieces.length[k]
        for node, sign, moment in ((i, 1, first), (j, -1, second)):
            balance[node, :2, tension] += sign * e[:, k]
            # The shear on the far end holds M_i + M_j: V L = -(M_i + M_j); the node gets -V.
            balance[node, :2, first] -= sign * across
            balance[node, :2, second] -= sign * across
            balance[node, 2, moment] -= 1
    bounds, within = [(None, None)], []
    for k, m_p in enumerate(pieces.plastic_moment):
        bounds += [(None, None), (-m_p, m_p), (-m_p, m_p)]
        section = frame.section_of[pieces.member[k]]
        if not section.extends:
            continue
        upper, lower = section.chains
        around = np.concatenate([upper, lower[::-1]])
        hull = (
            ConvexHull(around[np.any(around != np.roll(around, 1, axis=0), axis=1)])
            if m_p
            else None
        )
        if hull is None:
            bounds[-3] = (-section.squash_load, section.squash_load)
            continue
        for n, m, off in hull.equations:
            for end, sags in ((2, -1), (3, 1)):  # of the moment on the end, anticlockwise
                row = np.zeros(columns + 1)
                row[[1 + 3 * k, end + 3 * k, -1]] = n, sags * m, -off
                within.append(row)
    free = ~clamped
    sides = np.array(within).reshape(-1, columns + 1)
    answer = linprog(
        -np.eye(columns)[0],
        A_eq=balance[free].reshape(-1, columns),
        b_eq=right[free].ravel(),
        A_ub=sides[:, :-1],
        b_ub=sides[:, -1],
        bounds=bounds,
    )
    assert answer.status == 0, answer.message
    return answer.x[0]
