"""Travel, error and length of the steps of a path, and where it may begin."""

from types import SimpleNamespace

import numpy as np
import pytest
from skfem import MeshTri2

import lacore as la
from lacore.paths.pace import Pace
from lacore.paths.schemes import _change
from lacore.paths.stage import staged
from tests.lacore.models import CRITERION, cantilever


@pytest.mark.parametrize("length", [1e-3, 10.0])
@pytest.mark.parametrize("direction", [(0.0, 1.0), (-0.6, 0.8)])
def test_the_travel_of_a_point_is_in_metres(direction, length):
    """A direction has no length: a rigid motion by it is a travel of 1 m for each."""
    problem = cantilever()
    d = la.discretise(problem)
    velocity = np.zeros(d.full.n)
    velocity[d.continua["block"].dofs] = np.reshape(direction, (2, 1))
    for own in (direction, tuple(length * part for part in direction)):
        gauge = la.PointTravel("block", at=(1, 1), direction=own).gauge(problem)
        assert gauge(d, velocity) == pytest.approx(1.0)


def test_the_error_of_a_step_is_that_of_a_velocity_that_changes_evenly():
    """From 1 to 3 over a step of 0.1: half of the change times the step, per size 2."""
    solver = SimpleNamespace(size=2.0)
    here = SimpleNamespace(velocity={"b": np.full((2, 3), 1.0)}, speed=1.0)
    found = SimpleNamespace(velocity={"b": np.full((2, 3), 3.0)})
    evenly = np.mean(np.linspace(1.0, 3.0, 101))  # velocity that moves it as far
    exact = 0.1 * (evenly - 1.0) / 2.0
    assert _change(solver, here, found, 0.1, 1.0) == pytest.approx(exact)
    # Velocities are compared per travel, however fast the load drives them.
    twice = SimpleNamespace(velocity={"b": np.full((2, 3), 6.0)})
    assert _change(solver, here, twice, 0.1, 2.0) == pytest.approx(exact)
    first = SimpleNamespace(velocity=None, speed=1.0)
    assert np.isnan(_change(solver, first, found, 0.1, 1.0))


@pytest.mark.parametrize("ratio", [0.5, 1.0, 1.5])
def test_the_length_of_a_step_goes_with_the_root_of_its_error(ratio):
    """The error is proportional to the square of the length; a tenth is kept in reserve."""
    pace = Pace(la.AdaptiveSteps(tolerance=1e-3), travel=1.0)
    pace.learn(0.1, 1e-3 / ratio**2)
    assert pace.next == pytest.approx(0.1 * 0.9 * ratio)
    if ratio < 1:
        assert pace.shorter(0.1, 1e-3 / ratio**2) == pytest.approx(0.1 * 0.9 * ratio)


@pytest.mark.parametrize("depth", [-0.02, 0.02])
def test_no_middle_of_an_edge_begins_behind_an_obstacle(depth):
    """Corners stand on the obstacle, and the edges between them are bent."""
    mesh = MeshTri2.from_mesh(la.meshes.rectangle((0, 1), (0, 1), 2, 2))
    places = mesh.doflocs.copy()
    middles = (np.abs(places[1]) < 1e-9) & ~np.isin(places[0], [0, 0.5, 1])
    assert middles.sum() == 2
    places[1, middles] -= depth
    bent = MeshTri2(places, mesh.t).with_boundaries({"bottom": lambda x: x[1] < 0.03})
    body = la.Body(bent, CRITERION, space="p2-gauss")
    floor = la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), 0.3)
    problem = la.Problem({"block": body}, [la.BodyForce("block", (0, -1))])
    if depth > 0:
        with pytest.raises(la.InputError, match=r"begins 0\.02 m behind its obstacle"):
            staged(problem, [floor])
    else:
        assert len(staged(problem, [floor]).obstacles) == 1
