"""What is told by name: sides of contact, angles, bodies that touch nothing, gaps beside stones."""

import numpy as np
import pytest

import lacore as la

R = la.masonry.rectangle
DOWN, RIGHT = (0, -1), (1, 0)


def tower(**given):
    return la.BlockAssembly({"floor": R(-2, 2, -1, 0), "wall": R(-1, 1, 0, 1)}, 0.3, **given)


def soil(y=(-1, 0)):
    return la.Body(la.meshes.rectangle((-2, 2), y, 4, 1), la.VonMises(100.0))


def test_reactions_name_slave_and_master():
    """A wall of two blocks on soil, and a soil on rock: blocks by their own names."""
    blocks = la.BlockAssembly({"top": R(-1, 1, 1, 2), "foot": R(-1, 1, 0, 1)}, 0.3)
    problem = la.Problem(
        {"wall": blocks, "soil": soil()},
        [la.BodyForce("wall", RIGHT)],
        interfaces=[
            la.Interface(("wall", lambda x: x[1] == 0), ("soil", "top"), 0.4),
            la.Interface(("soil", "bottom"), la.RigidObstacle(), la.STICK),
        ],
        dead_loads=[la.BodyForce("wall", DOWN)],
    )
    table = la.solve(problem, throw=True).reactions
    told = {
        (row.interface, row.slave, row.master)
        for row in table[["interface", "slave", "master"]].itertuples()
    }
    assert told == {
        (problem.interfaces[0].name, "foot", "soil"),
        (problem.interfaces[1].name, "soil", "obstacle"),
        ("wall: top|foot", "foot", "top"),
    }
    # The normal points from the master into the slave.
    joint = table[table["slave"] == "foot"]
    below, above = (joint[joint["master"] == name] for name in ("soil", "top"))
    assert np.all(below["n_y"] == 1)
    assert np.all(above["n_y"] == -1)


def test_reactions_of_several_assemblies_and_frames():
    frame = la.Frame({"A": (0, 0), "B": (0, 1)}, {"post": ("A", "B")}, 1.0)
    problem = la.Problem(
        {
            "one": tower(),
            "post": frame,
            "two": la.BlockAssembly({"a": R(4, 5, 0, 1), "b": R(4, 5, 1, 2)}, 0.3),
        },
        [la.BodyForce("one", RIGHT, "wall")],
        [la.Fix("one", "floor"), la.Fix("two", "a"), la.Fix("post", "A", "clamped")],
        dead_loads=[la.BodyForce(name, DOWN) for name in ("one", "two")],
    )
    table = la.solve(problem, throw=True).reactions
    assert set(table[["slave", "master"]].apply(tuple, axis=1)) == {("wall", "floor"), ("b", "a")}


@pytest.mark.parametrize("degrees", [5, 30, 30.0, np.float64(45), 89.9])
def test_degrees_are_asked_about(degrees):
    tangent = f"{np.tan(np.radians(degrees)):.4g}"
    with pytest.raises(la.InputError, match="degrees") as caught:
        la.BlockAssembly({"a": R(0, 1, 0, 1)}, degrees)
    assert tangent in str(caught.value)
    for build in (
        lambda: la.Interface(("a", "top"), la.RigidObstacle(), degrees),
        lambda: tower(joint_friction={("floor", "wall"): degrees}),
    ):
        with pytest.raises(la.InputError, match="degrees"):
            build()
    # Said as a law it is meant.
    assert tower(joint_friction={("floor", "wall"): la.Coulomb(float(degrees))}).joints.coefficient


@pytest.mark.parametrize("mu", [0.0, 4.9, 90, 1e4])
def test_coefficients_are_taken(mu):
    assert la.Interface(("a", "top"), la.RigidObstacle(), mu).law == la.Coulomb(mu)


def test_a_body_that_touches_nothing_is_named():
    loads, supports = [la.BodyForce("wall", RIGHT, "wall")], [la.Fix("wall", "floor")]
    dead = [la.BodyForce("wall", DOWN)]
    with pytest.raises(la.InputError, match=r"'soil'.*touches nothing"):
        la.Problem({"wall": tower(), "soil": soil()}, loads, supports, dead_loads=dead)
    held = [*supports, la.Fix("soil", "bottom")]
    la.Problem({"wall": tower(), "soil": soil()}, loads, held, dead_loads=dead)
    la.Problem({"wall": tower()}, loads, supports, dead_loads=dead)


@pytest.mark.parametrize("gap", [3e-4, 3e-5, 2e-3])
def test_a_gap_beside_small_stones_is_no_joint(gap):
    """Blocks of a kilometre and stones of a centimetre: 1e-6 of the mean is 5 % of a stone."""
    stone = 1e-2
    blocks = {
        "rock": R(-1000, 1000, -1000, 0),
        "left": R(0, stone, 0, stone),
        "right": R(stone + gap, 2 * stone + gap, 0, stone),
    }
    if gap < 1e-2 * stone:  # named, so that the user decides
        with pytest.raises(la.InputError, match="nearly touch"):
            la.BlockAssembly(blocks, 0.3)
        return
    body = la.BlockAssembly(blocks, 0.3)
    assert body.joint_names == ("rock|left", "rock|right")
    assert body.tolerance == pytest.approx(1e-3 * stone)


def test_the_tolerance_of_blocks_alike_is_that_of_their_size():
    """Nor does a sliver of an edge, shorter than it, change it."""
    wall = la.masonry.running_bond([[1, 1], [0.5, 1, 0.5]], 0.4)
    size = np.sqrt(wall.area).mean()
    assert wall.tolerance == pytest.approx(1e-6 * size)
    cut = [(0, 0), (1, 0), (1, 1 - 1e-8), (1 - 1e-8, 1), (0, 1)]
    assert la.BlockAssembly({"a": cut}, 0.3).tolerance == pytest.approx(1e-6)
