"""Vertices at which strain rates may be unbounded, and the elements that they need."""

import numpy as np
import pytest

import lacore as la
from lacore.bounds.bracket.singular_points import (
    friction_of,
    sectors_for,
    singular_points,
    singular_vertices,
)
from lacore.bounds.bracket.whole import mesh_of
from tests.lacore.models import CRITERION

SIZE = np.sqrt(5.0)  # of a body of 2 m x 1 m


def strip(criterion, *, weight=0.0, loaded=lambda x: (x[1] == 1) & (x[0] <= 1), **more):
    """A body of 2 m x 1 m on a rough base, with a load on a part of its top."""
    body = la.Body(la.meshes.rectangle((0, 2), (0, 1), 4, 2), criterion)
    dead = [la.BodyForce("b", (0, -weight))] if weight else []
    loads = [la.Pressure("b", loaded)]
    return la.Problem({"b": body}, loads, [la.Fix("b", "bottom")], dead_loads=dead, **more)


def places(problem):
    return mesh_of(problem).p[:, singular_vertices(problem)].T.tolist()


def test_a_load_that_ends_on_a_straight_edge_is_singular_and_at_a_corner_it_is_not():
    """A corner of 90 degrees where the support ends has bounded strain rates, too."""
    assert places(strip(CRITERION)) == [[1.0, 1.0]]
    assert places(strip(CRITERION, loaded="top")) == []


@pytest.mark.parametrize("angle", [0.0, 30.0, 77.0])
@pytest.mark.parametrize("rise", [-0.3, 0.3])
def test_only_corners_of_more_than_180_degrees_are_singular(angle, rise):
    """The middle of one side moves in or out, whatever its direction; no condition ends there."""
    mesh = la.meshes.rectangle((0, 2), (0, 1), 2, 1)
    p = mesh.p.copy()
    p[1, (p[0] == 1) & (p[1] == 1)] += rise
    turn = np.radians(angle)
    p = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]) @ p
    moved = type(mesh)(p, mesh.t).with_boundaries(mesh.boundaries)
    loads, supports = [la.BodyForce("b", (1, 0))], [la.Fix("b", "bottom")]
    problem = la.Problem({"b": la.Body(moved, CRITERION)}, loads, supports)
    found = mesh.p[:, singular_points(problem, "b")].T.tolist()
    assert found == ([[1.0, 1.0]] if rise < 0 else [])


@pytest.mark.parametrize(("share", "counts"), [(0.9, False), (1.1, True)])
@pytest.mark.parametrize("angle", [10.0, 35.0])
def test_a_free_edge_of_heavy_soil_without_cohesion_is_not_singular(share, counts, angle):
    """Its strength there, 2 c cos(phi)/(1 - sin(phi)), is below a thousandth of weight and size."""
    phi, weight = np.radians(angle), 50.0
    cohesion = share * 1e-3 * weight * SIZE * (1 - np.sin(phi)) / (2 * np.cos(phi))
    problem = strip(la.MohrCoulomb(cohesion, angle), weight=weight)
    assert places(problem) == ([[1.0, 1.0]] if counts else [])
    covered = [la.Pressure("b", "top", 1.0)]
    pressed = la.Problem(
        problem.bodies,
        problem.reference_loads,
        problem.supports,
        dead_loads=[*problem.dead_loads, *covered],
    )
    assert places(pressed) == [[1.0, 1.0]]  # Its edge is not free.


@pytest.mark.parametrize("criterion", [la.Rankine(1e-6), la.Rankine(1e-6, 1e9)], ids=str)
def test_a_free_edge_that_fails_in_tension_alone_is_not_loose(criterion):
    """Its strength in compression has no limit, or a large one, however small that in tension."""
    assert places(strip(criterion, weight=50.0)) == [[1.0, 1.0]]


@pytest.mark.parametrize(("angle", "times"), [(0.0, 1.0), (20.0, 2.6), (30.0, 3.7)])
@pytest.mark.parametrize("width", [0.1, 0.01, 1e-3])
def test_sectors_cost_less_than_half_of_the_width_and_not_much_less(angle, times, width):
    """The load of a punch increases by ``1/(4 n^2)`` with n sectors in 90 degrees (T26b)."""
    friction = friction_of(la.Body(mesh_of(strip(CRITERION)), la.MohrCoulomb(1.0, angle)))
    assert friction == pytest.approx(np.tan(np.radians(angle)))
    half = sectors_for(width, friction) / 2
    assert times / (4 * half**2) <= width / 2
    assert times / (4 * (0.75 * half - 1) ** 2) >= width / 2
