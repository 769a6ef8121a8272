"""Corners that touch corners: refused where nothing else is there, else judged by the mechanism."""

import numpy as np
import pytest

import lacore as la

R = la.masonry.rectangle
WEIGHT, FLOOR = la.BodyForce("b", (0, -1)), la.Fix("b", "base")
BASE = {"base": R(-5, 5, -1, 0)}
BEAM = BASE | {"pier": R(-2, 0, 0, 1), "post": R(3, 4, 0, 1), "beam": R(0, 4, 1, 1.5)}
LEFT, RIGHT = [(-1, 0), (0, 0), (-1, 1)], [(0, 0), (1, 0), (1, 1)]
TIPS = BASE | {"left": LEFT, "right": RIGHT}  # two wedges on a floor, toe to toe
STEP = {"base": [(-5, -1), (5, -1), (5, 2), (0, 2), (0, 0), (-5, 0)], "left": LEFT}
WALL = BASE | {"wall": R(0, 1, 0, 2), "left": LEFT}


def pushed(blocks, *loads, supports=(FLOOR,), friction=0.3, body="b"):
    assembly = la.BlockAssembly(blocks, friction)
    return la.Problem({body: assembly}, loads, supports, dead_loads=[WEIGHT])


def turned(blocks, angle):
    c, s = np.cos(angle), np.sin(angle)
    return {name: np.array(points) @ [[c, s], [-s, c]] for name, points in blocks.items()}


def test_a_beam_whose_corner_rests_on_a_corner():
    """Pulled down at its end it was solved, held by nothing at the other."""
    with pytest.raises(
        la.InputError, match=r"'pier', 'beam'.*touch at \(0, 1\) m with a corner only"
    ):
        pushed(BEAM, la.BodyForce("b", (1, 0), "beam"))


def test_a_corner_in_a_reentrant_corner():
    notch = [(-2, 0), (0, 0), (0, 2), (2, 2), (2, -1), (-2, -1)]
    tip = [(0, 0), (-0.5, 1), (-1, 1)]
    with pytest.raises(la.InputError, match="with a corner only"):
        pushed({"base": notch, "tip": tip}, la.BodyForce("b", (1, 0), "tip"))


def test_what_is_held_may_touch_at_corners():
    """Two steps of a foundation that touch at a corner, and a block on the upper one."""
    blocks = {"low": R(-2, 0, -1, 0), "base": R(0, 2, 0, 1), "block": R(0.5, 1, 1, 1.5)}
    problem = pushed(
        blocks, la.BodyForce("b", (1, 0), "block"), supports=[la.Fix("b", ("low", "base"))]
    )
    assert la.solve(problem, throw=True).load_factor == pytest.approx(0.3, rel=1e-6)
    with pytest.raises(la.InputError, match=r"'low', 'base'.*touch"):
        pushed(blocks, la.BodyForce("b", (1, 0), "block"), supports=[la.Fix("b", "low")])


@pytest.mark.parametrize("coupling", ["certified", "associated", "frictionless"])
@pytest.mark.parametrize("blocks", [TIPS, STEP, WALL])
def test_toes_that_are_pushed_together(blocks, coupling):
    """They slid through each other, solved at the friction of one; the other never felt it."""
    supports = [la.Fix("b", tuple({"base", "wall"} & set(blocks)))]
    problem = pushed(blocks, la.BodyForce("b", (1, 0), "left"), supports=supports)
    state = la.solve(problem, coupling=coupling)
    assert state.status is la.Status.NOT_CERTIFIED
    assert np.isnan(state.load_factor)
    for word in ("corners of", "'left'", "(0, 0)"):
        assert word in state.message
    assert state.rigor is la.Rigor.NOT_CERTIFIED


@pytest.mark.parametrize("angle", [0.0, 0.3, 2.0])
@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("blocks", [TIPS, STEP, WALL])
def test_toes_that_are_pulled_apart(blocks, order, angle):
    """The same blocks the other way: the friction of one, whichever comes first."""
    named = dict(list(turned(blocks, angle).items())[::order])
    push = (-np.cos(angle), -np.sin(angle))
    down = (np.sin(angle), -np.cos(angle))
    problem = la.Problem(
        {"b": la.BlockAssembly(named, 0.3)},
        [la.BodyForce("b", push, "left")],
        [la.Fix("b", tuple({"base", "wall"} & set(blocks)))],
        dead_loads=[la.BodyForce("b", down)],
    )
    state = la.solve(problem, throw=True)
    assert state.load_factor == pytest.approx(0.3, rel=1e-6)


def test_bounds_and_ranges_know_of_corners():
    problem = pushed(TIPS, la.BodyForce("b", (1, 0), "left"))
    found = la.coulomb_range(problem, restarts=0)
    assert found.status is la.Status.NOT_CERTIFIED
    assert np.isnan([found.low, found.high]).all()
    assert found.bracket[1] == np.inf
    law = la.Coulomb(0.3, associated=True)
    bound = la.upper_bound(pushed(TIPS, la.BodyForce("b", (1, 0), "left"), friction=law))
    assert bound.status is la.Status.NOT_CERTIFIED
    assert np.isnan(bound.load_factor)


def test_toes_that_hold_each_other_up_are_not_unsafe():
    """On the sides of a valley, toe to toe: without the corner both slide down."""
    valley = {
        "base": [(-3, -1), (3, -1), (3, 3), (0, 0), (-3, 3)],
        "left": [(0, 0), (-1, 3), (-2, 2)],
        "right": [(0, 0), (2, 2), (1, 3)],
    }
    state = la.solve(pushed(valley, la.BodyForce("b", (0.1, 0.1), "left"), friction=0.2))
    assert state.status is la.Status.NOT_CERTIFIED
    assert "corners" in state.message


def test_a_wall_of_crosses_that_overhangs_falls():
    """Two columns in stack bond, one beside the floor: it falls, and no corner is in its way."""
    blocks = {f"{i}{j}": R(i, i + 1, j, j + 1) for i in range(-1, 1) for j in range(3)}
    state = la.solve(pushed({"base": R(-3, 0, -1, 0)} | blocks, la.BodyForce("b", (1, 0))))
    assert state.status is la.Status.UNSAFE


@pytest.mark.parametrize("friction", [0.3, 0.65])
def test_a_wall_of_crosses_is_solved(friction):
    """Stack bond: corners of four blocks everywhere, and none is driven into another.

    Sliding needs mu; four courses of three columns, each on its own, topple at width over height
    of a column, 1/2, or together later.
    """
    blocks = {f"{i}{j}": R(i, i + 1, j / 2, (j + 1) / 2) for i in range(3) for j in range(4)}
    wall = la.BlockAssembly({"base": R(-1, 4, -1, 0)} | blocks, friction)
    assert wall.meetings.count == 12  # six crosses, two pairs each
    assert wall.meetings.linked.all()
    problem = la.Problem({"b": wall}, [la.BodyForce("b", (1, 0))], [FLOOR], dead_loads=[WEIGHT])
    state = la.solve(problem, throw=True)
    assert 0 < state.load_factor <= friction * (1 + 1e-6)
    if friction < 0.5:
        assert state.load_factor == pytest.approx(friction, rel=1e-6)


def test_opening_of_two_convex_corners():
    """Squares that touch diagonally: free to pass on either side, not through each other."""
    met = la.BlockAssembly({"a": R(-1, 0, -1, 0), "b": R(0, 1, 0, 1)}, 0.3).meetings
    assert met.count == 1
    assert met.opening(np.array([[1.0], [2.0]])) == pytest.approx(-1)
    assert met.opening(np.array([[1.0], [-0.5]])) == pytest.approx(0.5)
    assert met.opening(np.array([[0.0], [1.0]])) == pytest.approx(0)
    assert met.opening(np.array([[-1.0], [-2.0]])) == pytest.approx(2)


def test_opening_of_random_corners_is_that_of_the_polygons():
    """Against shapely: moved a little, sectors overlap just where a speed is below 0."""
    from shapely.affinity import translate
    from shapely.geometry import Polygon

    rng, seen = np.random.default_rng(3), set()
    for _ in range(200):
        cuts = np.sort(rng.uniform(0, 2 * np.pi, 4))
        if np.min(np.append(np.diff(cuts), cuts[0] + 2 * np.pi - cuts[3])) < 0.2:
            continue
        fans = []
        for low, high in ((cuts[0], cuts[1]), (cuts[2], cuts[3])):
            angle = np.linspace(low, high, 9)
            fans.append(np.concatenate([[[0, 0]], np.stack([np.cos(angle), np.sin(angle)], 1)]))
        met = la.BlockAssembly(fans, 0.3).meetings
        assert met.count == 1
        seen.add(bool(met.reentrant[0]))
        for direction in rng.normal(size=(8, 2)):
            opening = met.opening(direction[:, None])[0]
            one = translate(Polygon(fans[0]), *(1e-3 * direction))
            overlap = one.intersection(Polygon(fans[1])).area
            if abs(opening) > 1e-2:
                assert (overlap > 1e-12) == (opening < 0), (fans, direction)
    assert seen == {True, False}


def meshed(x, y):
    return la.Body(la.meshes.rectangle(x=x, y=y, nx=2, ny=2), la.VonMises(1.0))


def interfaces_at_corners(slave, bodies, master="top"):
    return la.Problem(
        bodies,
        [la.BodyForce("upper", (1, 0))],
        [la.Fix("lower", "bottom" if isinstance(bodies["lower"], la.Body) else "low")],
        [la.Interface(("upper", slave), ("lower", master), 0.3)],
        dead_loads=[la.BodyForce("upper", (0, -1))],
    )


def test_an_interface_that_touches_with_a_corner_beside_a_face():
    """A block stands on one stone, and touches the next with a corner alone."""
    stones = {"low": R(0, 1, 0, 1), "next": R(2, 3, 0, 1)}
    lower = la.BlockAssembly(stones | {"tie": R(0, 3, -1, 0)}, 0.3)
    whole = la.meshes.rectangle(x=(0, 2), y=(1, 2), nx=4, ny=2)
    upper = la.Body(whole, la.VonMises(1.0))
    with pytest.raises(la.InputError, match=r"with a corner only at \[2. 1.\]"):
        interfaces_at_corners("bottom", {"upper": upper, "lower": lower}, ("low", "next"))
    assert interfaces_at_corners("bottom", {"upper": upper, "lower": lower}, "low")


def test_deformable_bodies_that_touch_at_a_corner_alone():
    bodies = {"upper": meshed((1, 2), (1, 2)), "lower": meshed((0, 1), (0, 1))}
    with pytest.raises(la.InputError, match="does not touch"):
        interfaces_at_corners("bottom", bodies)
