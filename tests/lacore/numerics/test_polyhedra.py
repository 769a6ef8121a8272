"""Nearest points of polyhedra, against the least distance by Lawson and Hanson."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import nnls

from lacore.numerics.polyhedra import far_edges, nearest


def by_least_distance(normals, bounds, point):
    """min ||y|| with -N y >= N x - b, y = z - x, as non-negative least squares (their LDP)."""
    matrix = np.vstack([-normals.T, normals @ point - bounds])
    wanted = np.eye(len(matrix))[-1]
    shares, _ = nnls(matrix, wanted)
    left = matrix @ shares - wanted
    return point - left[:-1] / left[-1]


@given(
    seed=st.integers(0, 10**6),
    planes=st.integers(1, 6),
    unknowns=st.integers(1, 3),
    far=st.sampled_from([0.0, 1.0, 100.0]),
)
def test_the_nearest_point(seed, planes, unknowns, far):
    rng = np.random.default_rng(seed)
    normals = rng.normal(size=(5, planes, unknowns))
    bounds = rng.uniform(0, 1, (5, planes))  # 0 is within
    points = far * rng.normal(size=(5, unknowns))
    found = nearest(normals, bounds, points).points
    for own, bound, point, one in zip(normals, bounds, points, found, strict=True):
        assert np.all(own @ one <= bound + 1e-12 * (1 + far) * np.linalg.norm(own, axis=1))
        wanted = by_least_distance(own, bound, point)
        # Distances are equal to round-off; of flat angles points are apart by the root of it.
        reached = np.linalg.norm(one - point)
        assert reached == pytest.approx(np.linalg.norm(wanted - point), rel=1e-7, abs=1e-10)


def test_planes_given_twice_and_parallel_ones():
    """A slab, one side of it stated twice: parallel planes have no edge, and need none."""
    normals = np.array([[[1.0, 0.0], [2.0, 0.0], [-1.0, 0.0]]])
    found = nearest(normals, np.array([[1.0, 2.0, 1.0]]), np.array([[3.0, 5.0]]))
    assert found.points == pytest.approx(np.array([[1.0, 5.0]]))
    assert found.along == pytest.approx(np.array([[[0.0, 0.0], [0.0, 1.0]]]))


def test_points_within_stay_and_none_is_no_trouble():
    inside = np.array([[0.25, -0.5]])
    found = nearest(np.array([[[1.0, 1.0]]]), np.array([[1.0]]), inside)
    assert np.array_equal(found.points, inside)
    assert np.array_equal(found.along, np.eye(2)[None])
    none = nearest(np.zeros((0, 1, 2)), np.zeros((0, 1)), np.zeros((0, 2)))
    assert none.points.shape == (0, 2)
    assert none.along.shape == (0, 2, 2)


def test_ways_to_infinity_are_said_once():
    """Maximum shear in (r, z): four planes meet along one line, that of mean stresses."""
    shear = np.array([[1.0, 0.0, 0.0], [1.0, -1.0, 1.0], [1.0, 1.0, -1.0], [-1.0, 0.0, 0.0]])
    edges = far_edges(np.stack([shear, 2.0 * shear]))
    assert edges.shape == (2, 2, 3)
    assert np.sort(edges[:, :, 1], axis=1) == pytest.approx(np.array([[-1.0, 1.0]] * 2))
    assert edges[:, :, 1] == pytest.approx(edges[:, :, 2])


def test_of_a_bounded_polyhedron_there_is_none():
    box = np.array([[[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]])
    assert np.array_equal(far_edges(box), np.zeros((1, 1, 2)))
