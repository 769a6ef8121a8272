"""A traction on a boundary that something holds acts on what holds it."""

from dataclasses import replace

import pytest

import lacore as la

CLAY = la.VonMises(1.0)
TRACTIONS = (0.9, 1.1, -3.0)
SAME = 1e-9  # of load factors of programs that differ by round-off
TILES = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
CUBES = la.meshes.box((0, 1), (0, 1), (0, 1), 1, 1, 1)


def wall(*dead, space="p2-vertex"):
    """A block held below, pushed off a smooth wall: it slips past its support at the corner."""
    return la.Problem(
        bodies={"block": la.Body(TILES, CLAY, space=space)},
        supports=[la.Fix("block", "bottom")],
        interfaces=[la.Interface(("block", "left"), la.RigidObstacle(), la.SMOOTH)],
        reference_loads=[la.BodyForce("block", (1, 0))],
        dead_loads=dead,
    )


def cube(*dead, space="p2-disc"):
    return la.Problem(
        bodies={"block": la.Body(CUBES, CLAY, kinematics="3d", space=space)},
        supports=[la.Fix("block", "bottom", "xyz")],
        reference_loads=[la.BodyForce("block", (1, 0, 0))],
        dead_loads=dead,
    )


def pushed(*dead, space="p2-vertex"):
    """A block under a rough footing that moves sideways."""
    return la.Problem(
        bodies={"block": la.Body(TILES, CLAY, space=space)},
        supports=[la.Fix("block", "bottom")],
        interfaces=[la.Interface(("block", "left"), la.RigidObstacle(), la.SMOOTH)],
        reference_loads=[la.RigidFooting("block", "top", (1, 0), rough=True)],
        dead_loads=dead,
    )


def factors(problem):
    """Upper bound, load factor of a solve, lower bound."""
    bounds = la.upper_bound(problem), la.lower_bound(problem)
    upper, lower = (bound.load_factor for bound in bounds)
    return upper, la.solve(problem).load_factor, lower


@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc"])
@pytest.mark.parametrize("traction", TRACTIONS)
def test_a_support_takes_a_traction(space, traction):
    free = factors(wall(space=space))
    loaded = factors(wall(la.Traction("block", "bottom", (traction, 0)), space=space))
    assert loaded == pytest.approx(free, rel=SAME)


@pytest.mark.parametrize("space", ["p1-disc", "p2-disc"])
def test_a_support_in_space_takes_a_traction(space):
    free = factors(cube(space=space))
    loaded = factors(cube(la.Traction("block", "bottom", (0.9, -0.4, 0)), space=space))
    assert loaded == pytest.approx(free, rel=1e-7)  # as solvers find them


@pytest.mark.parametrize("traction", [0.5, -0.25])
def test_a_rough_footing_moves_with_a_traction(traction):
    """Its load factor is the mean pressure along its way: the traction takes its part of it."""
    upper, solved, lower = factors(pushed())
    loaded = factors(pushed(la.Traction("block", "top", (traction, 0))))
    assert loaded == pytest.approx(
        (upper - traction, solved - traction, lower - traction), rel=1e-6
    )


@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc"])
@pytest.mark.parametrize("where", ["reference_loads", "dead_loads"])
def test_supports_carry_a_traction_that_they_take(space, where):
    """Of a unit block: the support balances the body force, the traction, and the wall."""
    stated = wall(space=space)
    traction = la.Traction("block", "bottom", (0.5, -0.25))
    state = la.solve(replace(stated, **{where: [*getattr(stated, where), traction]}), throw=True)
    held, contact = state.support_reactions, state.reactions
    pressed = float((contact["length"] * contact["t_n"]).sum())
    times = state.load_factor if where == "reference_loads" else 1.0
    along = -state.load_factor - times * 0.5 - pressed
    assert held["force_x"].sum() == pytest.approx(along, abs=1e-6)  # the accuracy of solves
    assert held["force_y"].sum() == pytest.approx(times * 0.25, abs=1e-6)


@pytest.mark.parametrize("space", ["p1-disc", "p2-disc"])
def test_a_support_in_space_carries_a_traction_that_it_takes(space):
    state = la.solve(cube(la.Traction("block", "bottom", (0.9, -0.4, 0.3)), space=space))
    held = state.support_reactions[["force_x", "force_y", "force_z"]].sum()
    assert held.to_numpy() == pytest.approx([-0.9 - state.load_factor, 0.4, -0.3], abs=1e-6)


def test_a_rough_footing_exerts_its_own_load_alone():
    """The traction reaches the footing, so the net force on the body below is the driving load."""
    state = la.solve(pushed(la.Traction("block", "top", (0.25, 0))), throw=True)
    held = state.support_reactions
    top = held[held["y"] == 1.0]
    assert top["force_x"].sum() == pytest.approx(state.load_factor, abs=1e-6)


def test_the_safety_of_a_loaded_footing_is_bounded_from_both_sides():
    found = la.safety_factor(pushed(la.Traction("block", "top", (0.25, 0))))
    assert found.lower <= found.upper


@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc"])
def test_a_traction_inside_a_seam_is_rejected(space):
    below = la.meshes.rectangle((0, 1), (-1, 0), 3, 2)
    bonded = la.Problem(
        bodies={
            "upper": la.Body(TILES, CLAY, space=space),
            "lower": la.Body(below, CLAY, space=space),
        },
        supports=[la.Fix("lower", "bottom")],
        interfaces=[la.Interface(("upper", "bottom"), ("lower", "top"), la.BOND)],
        reference_loads=[la.Traction("upper", "bottom", (1.0, 0.0))],
    )
    with pytest.raises(la.InputError, match="on which side of the slip surface"):
        la.solve(bonded)


def test_a_traction_along_what_sticks_is_rejected_where_the_body_slips():
    stated = la.Problem(
        bodies={"block": la.Body(TILES, CLAY)},
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle(), la.STICK)],
        reference_loads=[la.RigidFooting("block", "left", (1, 0))],
        dead_loads=[la.Traction("block", "bottom", (0.5, 0.0)), la.Pressure("block", "top", 3.0)],
    )
    with pytest.raises(la.InputError, match="on which side of the slip surface"):
        la.upper_bound(stated)
