"""Contact points at corners, where two interfaces of other directions share a node."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.assembly.discretise import discretise
from lacore.assembly.water import pore_pressures
from tests.lacore.models import CRITERION


def turned_square(angle, n=3):
    flat = la.meshes.rectangle((0, 1), (0, 1), n, n)
    c, s = np.cos(angle), np.sin(angle)
    mesh = type(flat)(np.array([[c, -s], [s, c]]) @ flat.p, flat.t)
    return mesh.with_boundaries({name: own.copy() for name, own in flat.boundaries.items()})


def on_obstacles(angle, **frictions):
    """A square on obstacles at its sides, each with a friction."""
    return la.Problem(
        {"block": la.Body(turned_square(angle), CRITERION)},
        [la.Traction("block", "top", (1, 0))],
        interfaces=[
            la.Interface(("block", side), la.RigidObstacle(), friction)
            for side, friction in frictions.items()
        ],
        dead_loads=[la.Pressure("block", "top", 1.0)],
    )


@pytest.mark.parametrize("angle", np.linspace(0, 3, 8))
def test_a_straight_side_has_no_corner_in_any_direction(angle):
    assert not discretise(on_obstacles(angle, bottom=0.3)).shared_corners.any()


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.0])
@pytest.mark.parametrize(("left", "count"), [(0.2, 2), (la.SMOOTH, 1), (la.Tresca(0.1), 1)])
def test_a_corner_of_two_sides_is_shared_by_the_points_with_friction(angle, left, count):
    """At the lower left corner there is a point of either side; only friction needs a reaction."""
    problem = on_obstacles(angle, bottom=0.3, left=left)
    d = discretise(problem)
    corner = np.linalg.norm(d.points.position, axis=1) < 1e-9
    assert corner.sum() == 2
    assert d.shared_corners.sum() == count
    assert not (d.shared_corners & ~corner).any()


def test_friction_next_to_an_interface_that_sticks_is_undetermined():
    with pytest.raises(la.InputError, match=r"meets an interface that sticks at \[0\. 0\.\]"):
        discretise(on_obstacles(0.0, bottom=0.3, left=la.STICK))
    discretise(on_obstacles(0.0, bottom=la.SMOOTH, left=la.STICK))


def test_two_bodies_at_one_place_have_corners_of_their_own():
    """The lower left corner of one body is where the right side of the other one begins."""
    left = la.meshes.rectangle((-1, 0), (0, 1), 2, 2)
    right = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    problem = la.Problem(
        {"one": la.Body(left, CRITERION), "two": la.Body(right, CRITERION)},
        [la.Traction("one", "top", (1, 0)), la.Traction("two", "top", (1, 0))],
        interfaces=[
            la.Interface(("one", "bottom"), la.RigidObstacle(), 0.3),
            la.Interface(("two", "left"), la.RigidObstacle(), 0.3),
        ],
        dead_loads=[la.Pressure(name, "top", 1.0) for name in ("one", "two")],
    )
    assert not discretise(problem).shared_corners.any()


@pytest.mark.parametrize(("components", "kept"), [("xy", 4), ("y", 7)])
def test_a_point_that_a_support_holds_whole_is_none(components, kept):
    """Three edges have seven control points, one edge three; what slides without friction stays."""
    problem = on_obstacles(0.0, bottom=la.SMOOTH)
    held = la.Fix("block", lambda x: (x[1] == 0) & (x[0] < 1 / 3 + 1e-9), components)
    d = discretise(replace(problem, supports=[held]))
    assert d.full.contact.count == d.points.position.shape[0] == kept


def test_friction_where_a_support_takes_the_normal_force_is_undetermined():
    held = la.Fix("block", lambda x: (x[1] == 0) & (x[0] < 1 / 3 + 1e-9), "y")
    with pytest.raises(la.InputError, match="a support holds the normal velocity"):
        discretise(replace(on_obstacles(0.0, bottom=0.3), supports=[held]))


def test_a_load_along_a_bond_that_cannot_slip_is_accepted():
    """A bond to an obstacle is a support; bodies whose nodes move as one have no slip surface."""
    along = la.Traction("block", "bottom", (1, 0))
    bonded = replace(on_obstacles(0.0, bottom=la.BOND), dead_loads=[along])
    discretise(bonded)
    below = la.Body(la.meshes.rectangle((0, 1), (-1, 0), 3, 2), CRITERION)
    two = replace(
        bonded,
        bodies={**bonded.bodies, "below": below},
        interfaces=[la.Interface(("block", "bottom"), ("below", "top"), la.BOND)],
        supports=[la.Fix("below", "bottom")],
    )
    discretise(two)
    other = la.Body(la.meshes.rectangle((0, 1), (-1, 0), 4, 2), CRITERION)
    with pytest.raises(la.InputError, match="on which side of the slip surface"):
        discretise(replace(two, bodies={**bonded.bodies, "below": other}))


def test_pressures_in_the_pores_are_those_of_bodies_that_have_pores():
    """The load factor multiplies water of reference loads; loads on blocks wet nothing."""
    soil = la.Body(la.meshes.rectangle((0, 1), (0, 2), 1, 2), CRITERION)
    floor = la.BlockAssembly({"floor": [(0, -1), (1, -1), (1, 0), (0, 0)]}, 0.5)
    problem = la.Problem(
        {"soil": soil, "blocks": floor},
        [la.PorePressure("soil", 3.0), la.BodyForce("blocks", (1, 0))],
        [la.Fix("blocks", "floor")],
        [la.Interface(("soil", "bottom"), ("blocks", "floor"), la.BOND)],
        dead_loads=[la.PorePressure("soil", 1.0), la.BodyForce("blocks", (0, -1))],
    )
    (pressure,) = pore_pressures(problem, 0.5).values()
    assert pressure == pytest.approx(1.0 + 0.5 * 3.0)
    dry = la.Problem(
        {"soil": soil},
        [la.Traction("soil", "top", (1, 0))],
        [la.Fix("soil", "bottom")],
        dead_loads=[la.PorePressure("soil", 1.0)],
    )
    assert pore_pressures(dry, np.nan)["soil"] == pytest.approx(1.0)  # an unknown load factor


@pytest.mark.parametrize(("bend", "corners"), [(1e-3, 2), (1e-6, 0)])
def test_a_boundary_that_turns_by_a_thousandth_has_a_corner(bend, corners):
    """Either edge has a point there; a millionth is round-off of coordinates."""
    flat = la.meshes.rectangle((0, 2), (0, 1), 2, 1)
    x, y = flat.p
    down = bend * np.maximum(x - 1, 0.0) * (1 - y)
    mesh = type(flat)(np.stack([x, y - down]), flat.t)
    mesh = mesh.with_boundaries({name: own.copy() for name, own in flat.boundaries.items()})
    problem = la.Problem(
        {"block": la.Body(mesh, CRITERION)},
        [la.Traction("block", "top", (1, 0))],
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle(), 0.3)],
        dead_loads=[la.Pressure("block", "top", 1.0)],
    )
    assert discretise(problem).shared_corners.sum() == corners


@pytest.mark.parametrize(("along", "accepted"), [(1e-7, False), (-1e-7, False), (1e-12, True)])
def test_a_load_acts_along_a_bond_by_more_than_round_off(along, accepted):
    """Across the seam it does not matter which side it acts on."""
    below = la.Body(la.meshes.rectangle((0, 1), (-1, 0), 4, 2), CRITERION)
    stated = on_obstacles(0.0, bottom=la.BOND)
    problem = replace(
        stated,
        bodies={**stated.bodies, "below": below},
        interfaces=[la.Interface(("block", "bottom"), ("below", "top"), la.BOND)],
        supports=[la.Fix("below", "bottom")],
        dead_loads=[la.Traction("block", "bottom", (along, -1))],
    )
    if accepted:
        discretise(problem)
        return
    with pytest.raises(la.InputError, match="on which side of the slip surface"):
        discretise(problem)
