"""A wall that pushes the ground above a support in its direction: its toe shears off the ground.

Continuous velocities cannot: at the toe the ground would have to move, and not to move. The wedge
above a plane at 45 degrees slides up: the passive pressure of clay on 1 m, a load factor of 2 k.
"""

import pytest

import lacore as la
from lacore.bounds.bracket.track import on_finer
from lacore.bounds.bracket.whole import mesh_of


def above(x):
    return (abs(x[0]) < 1e-9) & (x[1] >= -1 - 1e-9)


def below(x):
    return (abs(x[0]) < 1e-9) & (x[1] <= -1 + 1e-9)


def ground(loads, extra=(), **more):
    mesh = la.meshes.rectangle((0, 2), (-2, 0), 2, 2)
    supports = [
        la.Fix("ground", "bottom"),
        la.Fix("ground", "right", "x"),
        la.Fix("ground", below, "x"),
        *extra,
    ]
    bodies = {"ground": la.Body(mesh, la.VonMises(1.0)), **more.pop("bodies", {})}
    return la.Problem(bodies, loads, supports, **more)


def behind_block():
    wall = la.RigidBlock([(-1, -1), (0, -1), (0, 0), (-1, 0)])
    face = la.Interface(("ground", above), ("wall", lambda x: abs(x[0]) < 1e-9), la.SMOOTH)
    guide = la.Fix("wall", lambda x: x[0] <= 0, "y")
    push = la.PointForce("wall", (-0.5, -0.5), (1, 0))
    return ground([push], [guide], bodies={"wall": wall}, interfaces=[face])


def behind_footing():
    return ground([la.RigidFooting("ground", above, (1, 0), rough=False)])


@pytest.mark.parametrize("problem", [behind_block, behind_footing])
def test_a_bracket_takes_velocities_that_jump_where_others_are_locked(problem):
    found = la.bracket(problem(), 0.01, max_elements=400)
    assert found.lower <= 2 * (1 + 1e-6)
    assert found.upper >= 2 * (1 - 1e-6)
    assert found.width < 0.01
    assert found.strict


def test_a_locked_mesh_says_which_velocities_may_free_it():
    state = la.solve(behind_block())
    assert state.status is la.Status.LOCKED
    assert "proven of the discrete problem" in state.message
    assert "'p2-disc'" in state.message


def test_velocities_jump_after_two_meshes_without_an_upper_bound():
    """The first mesh may be too coarse alone; lower bounds say nothing of it."""
    problem = behind_block()
    finer = mesh_of(problem).refined(1)
    found, missing, lower = (
        {"bound": kind, "solved": value}
        for kind, value in (("upper", 2.1), ("upper", float("nan")), ("lower", float("nan")))
    )

    def space(*rows):
        return on_finer(problem, finer, rows).bodies["ground"].space

    assert space(lower, missing) == space(lower, missing, lower) == "p2-vertex"
    assert space(missing, found) == "p2-vertex"
    assert space(missing, missing) == "p2-disc"
