"""Obstacles: a plane is what it is, however long its normal is given."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore.model.contact.obstacles import Plane
from tests.lacore.models import CRITERION

PLACE = st.floats(-10, 10)


@given(st.tuples(PLACE, PLACE), st.floats(0, 2 * np.pi), st.floats(0.01, 100.0), st.integers(0, 99))
def test_distances_and_normals_of_a_plane(point, angle, length, seed):
    direction = np.array([np.cos(angle), np.sin(angle)])
    plane = Plane.through(np.array(point), length * direction)
    places = np.random.default_rng(seed).uniform(-10, 10, (2, 7))
    normals, distance = plane.normal(places), plane.distance(places)
    assert np.linalg.norm(normals, axis=0) == pytest.approx(np.ones(7))
    # What lies a distance behind each place is on the plane, to round-off of coordinates of 10.
    assert plane.distance(places - distance * normals) == pytest.approx(np.zeros(7), abs=1e-13)
    assert plane.distance(places + normals) == pytest.approx(distance + 1)
    line = plane.outline(np.array([-1.0, -2.0]), np.array([3.0, 4.0]))
    assert plane.distance(line) == pytest.approx(np.zeros(line.shape[1]), abs=1e-12)
    assert np.linalg.norm(line[:, -1] - line[:, 0]) >= np.hypot(4, 6)


@pytest.mark.parametrize("length", [0.1, 1.0, 7.0])
def test_a_normal_has_a_direction_only(length):
    """Of a foot on a slope, where the normal is that of the obstacle: 30 degrees, friction 0.2."""
    slope = la.RigidObstacle((0, 0), (-0.5 * length, np.sqrt(0.75) * length))
    frame = la.Frame({"foot": (0.0, 0.0), "head": (0.0, 1.0)}, {"post": ("foot", "head")}, 1.0)
    problem = la.Problem(
        {"post": frame},
        [la.PointForce("post", "foot", (1.0, 0.0))],
        [la.Fix("post", "foot", "rotation")],
        [la.Interface(("post", "foot"), slope, 0.2)],
        dead_loads=[la.PointForce("post", "foot", (0.0, -1.0))],
    )
    tangent = np.tan(np.radians(30))
    exact = (tangent + 0.2) / (1 - 0.2 * tangent)  # up the slope, against friction
    assert la.solve(problem).load_factor == pytest.approx(exact, rel=1e-6)


def test_another_shape_in_place_of_a_plane():
    body = la.Body(la.meshes.rectangle((0, 4), (0, 1), 4, 1), CRITERION)

    def sliding(master):
        return la.solve(
            la.Problem(
                {"block": body},
                [la.Traction("block", "left", (1.0, 0.0))],
                interfaces=[la.Interface(("block", "bottom"), master, 0.2)],
                dead_loads=[la.Traction("block", "top", (0.0, -1.0))],
            )
        )

    plane = la.RigidObstacle((0, 0), (0, 1))
    shaped = la.RigidObstacle(shape=Plane((0.0, 0.0), (0.0, 1.0)))
    assert sliding(shaped).load_factor == sliding(plane).load_factor


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"point": (0, 0), "normal": (0, 1), "shape": Plane((0, 0), (0, 1))}, "another shape"),
        ({"shape": 3.0}, "not a shape"),
    ],
)
def test_a_shape_is_one_thing(given, told):
    with pytest.raises(la.InputError, match=told):
        la.RigidObstacle(**given)
