"""Shapes of tools: their distances are those of shapely, their normals the slopes of these."""

import json

import ezdxf
import numpy as np
import pytest
import shapely

import lacore as la
from lacore.paths.tools.carrier import moved_shape
from lacore.reporting.errors import InputError

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


def drawn(folder, *rings, layer="die"):
    """A GeoJSON file of polygons."""
    features = [
        {
            "type": "Feature",
            "properties": {"layer": layer},
            "geometry": {"type": "Polygon", "coordinates": [[*ring, ring[0]]]},
        }
        for ring in rings
    ]
    file = folder / "die.geojson"
    file.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return file


SQUARE = [[0, 0], [20, 0], [20, 10], [0, 10]]


def test_an_outline_is_read_from_geojson(tmp_path):
    read = la.shapes.read_outline(drawn(tmp_path, SQUARE), unit="mm", rounding=0.002)
    stated = la.shapes.outline([(0, 0), (0.02, 0), (0.02, 0.01), (0, 0.01)], rounding=0.002)
    places = np.random.default_rng(0).uniform(-0.01, 0.03, (2, 200))
    assert read.distance(places) == pytest.approx(stated.distance(places), abs=1e-12)


def test_arcs_of_a_drawing_become_chords(tmp_path):
    """Of a DXF in its own unit: half a disc that a bulge closes."""
    drawing = ezdxf.new(units=4)  # mm
    half = [(-10, 0, 0, 0, 0), (10, 0, 0, 0, 1)]
    drawing.modelspace().add_lwpolyline(half, close=True)
    drawing.saveas(tmp_path / "punch.dxf")
    read = la.shapes.read_outline(tmp_path / "punch.dxf", sagitta=1e-5)
    angle = np.linspace(0.1, 3.0, 50)
    arc = 0.01 * np.stack([np.cos(angle), np.sin(angle)])
    assert np.abs(read.distance(arc)).max() < 1.1e-5
    with pytest.raises(InputError, match="a curve, where blocks have straight edges"):
        la.shapes.read_outline(tmp_path / "punch.dxf")


@pytest.mark.parametrize(
    ("rings", "given", "said"),
    [
        ([SQUARE], {}, "unit: .*says no unit"),
        ([SQUARE], {"unit": "mm", "layer": "dye"}, "layer = 'dye': .*'die'"),
        ([SQUARE], {"unit": "ell"}, "unit = 'ell': no unit of drawings"),
        ([SQUARE, [[30, 0], [40, 0], [40, 9]]], {"unit": "m"}, "2 closed outlines in this layer"),
        ([], {"unit": "m"}, "the drawing has 0 layers"),
    ],
)
def test_drawings_that_are_no_outline(tmp_path, rings, given, said):
    with pytest.raises(InputError, match=said):
        la.shapes.read_outline(drawn(tmp_path, *rings), **given)


def test_references_of_shapes():
    """The point that the velocity of a tool moves: centre, tip, centroid of the area."""
    assert la.shapes.disc((0.5, 0.2), 1.5).reference == (0.5, 0.2)
    assert la.shapes.wedge((0.3, -0.2), 30).reference == (0.3, -0.2)
    assert la.shapes.outline([(0, 0), (3, 0), (0, 3)]).reference == pytest.approx((1.0, 1.0))
    plane = la.shapes.plane((0, 1), (0, -2))
    assert plane.distance(np.array([[5.0, 5.0], [0.0, 3.0]])) == pytest.approx([1.0, -2.0])


def test_sharp_corners_stand_out_or_are_surrounded():
    """Of a letter L five corners stand out and one is between its arms, of 1 and 2 m."""
    letter = la.shapes.outline([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)])
    assert letter.corners.shape == (2, 5)
    assert not np.any(np.all(letter.corners.T == (1, 1), axis=1))
    (inner,) = letter.inner
    assert inner.place.tolist() == [1, 1]
    assert inner.reach == 2
    assert inner.normals.T.tolist() == [[0, 1], [1, 0]]
    rounded = la.shapes.outline(
        [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], [0, 0, 0, 0.2, 0, 0]
    )
    assert rounded.inner == []
