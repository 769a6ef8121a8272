"""Shapes of tools: their distances are those of shapely, their normals the slopes of these."""

import numpy as np
import pytest
import shapely

import lacore as la
from lacore.paths.tools.carrier import moved_shape

LETTER = [(-1, -1), (1.5, -1), (1.5, 0), (0, 0), (0, 2), (-1, 1.5)]
PLACES = np.random.default_rng(0).uniform(-3, 3, (2, 400))
LOW, HIGH = np.array([-30.0, -30.0]), np.array([30.0, 30.0])
SHAPES = {
    "letter": (la.shapes.outline(LETTER), 1e-12),
    "backwards": (la.shapes.outline(LETTER[::-1]), 1e-12),
    "rounded": (la.shapes.outline(LETTER, [0.2, 0.3, 0.1, 0.5, 0, 0.2]), 5e-4),  # drawn by chords
    "wedge": (la.shapes.wedge((0.3, -0.2), 30, (1, 1)), 1e-12),
    "disc": (la.shapes.disc((0.5, 0.2), 1.5), 2e-3),
}


def slope(shape, axis, step=1e-6):
    shift = step * np.eye(2)[:, [axis]]
    return (shape.distance(PLACES + shift) - shape.distance(PLACES - shift)) / (2 * step)


@pytest.mark.parametrize(("shape", "drawn"), SHAPES.values(), ids=SHAPES)
def test_distances_are_signed_and_normals_are_their_slopes(shape, drawn):
    solid, points = shapely.Polygon(shape.outline(LOW, HIGH).T), shapely.points(PLACES.T)
    away = shapely.distance(points, solid.exterior)
    known = np.where(shapely.contains(solid, points), -away, away)
    assert shape.distance(PLACES) == pytest.approx(known, abs=drawn)
    normal = shape.normal(PLACES)
    assert np.linalg.norm(normal, axis=0) == pytest.approx(np.ones(400), rel=1e-12)
    wrong = np.abs(normal - np.stack([slope(shape, axis) for axis in (0, 1)])).max(axis=0)
    assert np.sum(wrong > 1e-6) <= 1  # a place may be as close to two faces


@pytest.mark.parametrize(("shape", "_"), SHAPES.values(), ids=SHAPES)
def test_a_shape_that_moves_twice_is_where_both_motions_lead(shape, _):
    about = np.array([[0.4], [0.1]])
    once = moved_shape(shape, about, np.array([[1.0], [0.3], [0.5]]))
    twice = moved_shape(once, np.array([[1.0], [0.3]]), np.array([[0.4], [0.1], [-0.5]]))
    assert twice.distance(PLACES) == pytest.approx(shape.distance(PLACES), abs=1e-12)
    assert twice.normal(PLACES) == pytest.approx(shape.normal(PLACES), abs=1e-9)
    c, s = np.cos(0.5), np.sin(0.5)
    places = np.array([[c, -s], [s, c]]) @ (PLACES - about) + np.array([[1.0], [0.3]])
    assert once.distance(places) == pytest.approx(shape.distance(PLACES), abs=1e-12)


def test_the_tip_of_a_wedge_faces_along_its_axis():
    wedge = la.shapes.wedge((0, 0), 20)
    places = np.array([[0.0, 0.0], [0.0, -1.0]])
    assert wedge.normal(places) == pytest.approx(np.array([[0.0, 0.0], [-1.0, -1.0]]))
    assert wedge.distance(places) == pytest.approx([0.0, 1.0])
