"""Ten assemblies of rigid blocks, each with a base at rest, for tests."""

import numpy as np

import lacore as la

DOWN, RIGHT = (0.0, -1.0), (1.0, 0.0)
E, U, e, u = [1, 1, 1, 1], [0.5, 1, 1, 1, 0.5], [1, 0.5, -1, 0.5, 1], [0.5, 1, -1, 1, 0.5]
A, B = [0.5, 1, 1, 1, 1, 0.5], [1, 1, 1, 1, 1]
WALLS = {"wall-1": [A, B] * 3, "wall-2": [A, B] * 5, "wall-3": [E, U, E, u, e, u, e, u, E, U, E]}


def box(x0, x1, y0, y1):
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], dtype=float)


def problem(blocks, live, mu, fixed=("base",), dead=(), **friction):
    """Blocks under their own weight (1 per area) and further dead loads."""
    bodies = {"blocks": la.BlockAssembly(blocks, mu, **friction)}
    return la.Problem(
        bodies,
        live,
        [la.Fix("blocks", tuple(fixed))],
        dead_loads=[la.BodyForce("blocks", DOWN), *dead],
    )


def block_slide(mu=0.3):
    return problem(
        {"base": box(-1, 3, -1, 0), "block": box(0, 2, 0, 1)},
        [la.PointForce("blocks", (0.0, 0.5), RIGHT)],
        mu,
    )


def block_topple(mu=0.6):
    return problem(
        {"base": box(-1, 3, -1, 0), "block": box(0, 1, 0, 3)},
        [la.PointForce("blocks", (0.0, 2.0), RIGHT)],
        mu,
    )


def incline(mu=0.5, slope=0.3):
    turn = np.array([[np.cos(slope), -np.sin(slope)], [np.sin(slope), np.cos(slope)]])
    blocks = {"base": box(-3, 5, -1, 0) @ turn.T, "block": box(0, 2, 0, 0.5) @ turn.T}
    return problem(blocks, [la.BodyForce("blocks", RIGHT, "block")], mu)


def stack(mu=0.3):
    blocks = {"base": box(-1, 3, -1, 0)} | {
        f"b{i}": box(0, 1, 0.5 * i, 0.5 * (i + 1)) for i in range(4)
    }
    return problem(blocks, [la.BodyForce("blocks", RIGHT)], mu)


def portal(mu=0.6):
    """Two columns and a lintel, pushed sideways."""
    return problem(
        {
            "base": box(-1, 5, -1, 0),
            "left": box(0, 1, 0, 2),
            "right": box(3, 4, 0, 2),
            "lintel": box(0, 4, 2, 2.5),
        },
        [la.BodyForce("blocks", RIGHT)],
        mu,
    )


def wedge(mu=0.3, half_angle=0.2, up=False):
    """A wedge between two blocks on the floor, pushed down or pulled up."""
    t, h = np.tan(half_angle), 1.0
    blocks = {
        "base": box(-8, 8, -1, 0),
        "wedge": [(-0.5, 0.2), (0.5, 0.2), (0.5 + h * t, 0.2 + h), (-0.5 - h * t, 0.2 + h)],
        "left": np.array([(-5, 0), (-0.5 + 0.2 * t, 0), (-0.5 - h * t, 0.2 + h), (-5, 0.2 + h)]),
        "right": np.array([(0.5 - 0.2 * t, 0), (5, 0), (5, 0.2 + h), (0.5 + h * t, 0.2 + h)]),
    }
    return problem(blocks, [la.PointForce("blocks", "wedge", (0, 1) if up else DOWN)], mu)


def wedge_extraction(mu=0.5, half_angle=0.2):
    return wedge(mu, half_angle, up=True)


def wall(name, mu=0.65):
    body = la.masonry.running_bond(WALLS[name], friction=mu)
    return la.Problem(
        {"blocks": body},
        [la.BodyForce("blocks", RIGHT)],
        [la.Fix("blocks", "base")],
        dead_loads=[la.BodyForce("blocks", DOWN)],
    )


PROBLEMS = {
    "block-slide": block_slide,
    "block-topple": block_topple,
    "incline": incline,
    "stack": stack,
    "portal": portal,
    "wedge": wedge,
    "wedge-extraction": wedge_extraction,
    **{name: lambda mu=0.65, name=name: wall(name, mu) for name in WALLS},
}
