"""Polyhedra: volumes, centroids, plane faces, and what is none."""

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

import lacore as la
from tests.lacore.model.bodies.blocks3d.solids import (
    BOX,
    L_SHAPE,
    box,
    corners,
    moved,
    prism,
    triangulated,
)

ROUND_OFF = 1e-12  # of sums of a few dozen products of order one
UNIT = corners((0, 0, 0), (1, 1, 1))


def test_a_box():
    block = box((1, 2, 3), (2, 4, 6))
    assert block.volume == pytest.approx(6, rel=ROUND_OFF)
    assert block.centroid == pytest.approx([1.5, 3, 4.5], rel=ROUND_OFF)
    assert block.radius == pytest.approx(np.sqrt(1 + 4 + 9) / 2, rel=ROUND_OFF)
    assert sorted(block.area) == pytest.approx([2, 2, 3, 3, 6, 6], rel=ROUND_OFF)
    assert np.sum(block.area * block.normal, axis=1) == pytest.approx([0, 0, 0], abs=ROUND_OFF)
    assert block.edges.shape == (2, 12)
    assert block.convex


def test_an_l_is_not_convex_and_has_its_moments():
    block = prism(L_SHAPE, 1)
    assert block.volume == pytest.approx(3, rel=ROUND_OFF)
    assert block.centroid == pytest.approx([5 / 6, 5 / 6, 1 / 2], rel=ROUND_OFF)
    assert not block.convex
    assert len(block.pieces) == 2  # the plane of one face at the reentrant edge cuts it


def test_a_hole_through_a_block_is_kept():
    """A square ring, cut into four: its top is one plane face with two rings."""
    outer, inner = [(0, 0), (3, 0), (3, 3), (0, 3)], [(1, 1), (2, 1), (2, 2), (1, 2)]
    points = [(x, y, z) for z in (0, 1) for x, y in (*outer, *inner)]
    faces = []
    for i, j in ((0, 1), (1, 2), (2, 3), (3, 0)):
        faces += [(i, j, 4 + j, 4 + i), (8 + i, 8 + j, 12 + j, 12 + i)]
        faces += [(i, j, 8 + j, 8 + i), (4 + i, 4 + j, 12 + j, 12 + i)]
    block = la.Polyhedron(points, faces)
    assert block.volume == pytest.approx(8, rel=ROUND_OFF)
    assert block.area.size == 10
    assert np.bincount(block.ring_face).max() == 2
    assert sorted(block.area)[-2:] == pytest.approx([8, 8], rel=ROUND_OFF)
    assert not block.convex


@pytest.mark.parametrize("block", [box((0, 0, 0), (1, 2, 3)), prism(L_SHAPE, 1)])
@pytest.mark.parametrize("turn", [0, 1])
def test_triangles_in_one_plane_are_one_face(block, turn):
    cut = triangulated(block, turn) if block.convex else fanned_l()
    assert cut.area.size == block.area.size
    assert sorted(cut.area) == pytest.approx(sorted(block.area), rel=ROUND_OFF)
    assert cut.volume == pytest.approx(block.volume, rel=ROUND_OFF)
    assert cut.edges.shape == block.edges.shape


def fanned_l():
    block = prism(L_SHAPE, 1)
    ends = [(0, *pair) for pair in ((1, 2), (2, 3), (3, 4), (4, 5))]
    cut = [face[::-1] for face in ends] + [tuple(6 + n for n in face) for face in ends]
    cut += [(a, b, c) for a, b, c, d in block.faces[2:]] + [
        (a, c, d) for a, b, c, d in block.faces[2:]
    ]
    return la.Polyhedron(block.vertices, cut)


@settings(deadline=None, max_examples=25)
@given(st.integers(5, 30), st.integers(0, 10**6))
def test_hulls_of_random_points_are_those_of_scipy(number, seed):
    points = np.random.default_rng(seed).normal(size=(number, 3))
    hull = ConvexHull(points)
    used = np.unique(hull.simplices)
    block = la.Polyhedron(points[used], np.searchsorted(used, hull.simplices).tolist())
    middle = points.mean(axis=0)
    tetrahedra = points[hull.simplices] - middle
    parts = np.abs(np.linalg.det(tetrahedra)) / 6
    assert block.volume == pytest.approx(hull.volume, rel=1e-10)
    centroid = middle + parts @ tetrahedra.sum(axis=1) / 4 / parts.sum()
    # Flat hulls lose digits in the ratio of their volume to that of a ball.
    assert block.centroid == pytest.approx(centroid, abs=1e-9)
    assert np.sum(block.area) == pytest.approx(hull.area, rel=1e-10)
    assert block.convex


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 10**6), st.floats(-3, 3), st.booleans())
def test_moved_turned_and_scaled_it_is_the_same_block(seed, power, hollow):
    block = prism(L_SHAPE, 1) if hollow else box((0, 0, 0), (1, 2, 3))
    turn = Rotation.random(rng=np.random.default_rng(seed))
    shift, scale = np.array([3.0, -2.0, 1.0]), 10.0**power
    other = moved(block, turn, scale * shift, scale)
    assert other.volume == pytest.approx(scale**3 * block.volume, rel=1e-11)
    assert other.centroid == pytest.approx(
        scale * (turn.apply(block.centroid) + shift), abs=1e-11 * scale
    )
    assert other.normal == pytest.approx(turn.apply(block.normal.T).T, abs=1e-11)
    assert other.radius == pytest.approx(scale * block.radius, rel=1e-11)
    assert other.convex == block.convex


@pytest.mark.parametrize("turned", [(), (0,), (1, 4), range(6)])
def test_faces_may_be_given_in_either_sense(turned):
    faces = [face[::-1] if n in turned else face for n, face in enumerate(BOX)]
    block = la.Polyhedron(UNIT, faces)
    assert block.volume == pytest.approx(1, rel=ROUND_OFF)
    assert np.all(np.sum(block.normal * (block.face_centroid - 0.5), axis=0) > 0.4)


def test_it_pickles():
    block = pickle.loads(pickle.dumps(prism(L_SHAPE, 1)))
    assert block.volume == pytest.approx(3, rel=ROUND_OFF)


def lifted(by):
    points = UNIT.copy()
    points[6, 2] += by
    return points


def two_shells():
    return np.concatenate([UNIT, UNIT + 3]), [*BOX, *(tuple(n + 8 for n in f) for f in BOX)]


def sharing_an_edge():
    """Two boxes that touch in the edge from (1, 1, 0) to (1, 1, 1), as one surface."""
    new = {0: 2, 4: 6}  # corners of the second that are those of the first
    names = {n: new.get(n, 8 + k) for k, n in enumerate(range(8))}
    points = np.concatenate([UNIT, UNIT + np.array([1, 1, 0])])
    return points, [*BOX, *(tuple(names[n] for n in face) for face in BOX)]


def crossing_itself():
    """A Z whose one leg runs through the other: closed, orientable, and no solid."""
    outline = [(0, 0), (4, 0), (4, 3), (3, 3), (3, 1), (1, 1), (1, 2), (5, 2), (5, 2.5), (0, 2.5)]
    points = [(x, y, z) for z in (0, 1) for x, y in outline]
    k = len(outline)
    return points, [(i, (i + 1) % k, k + (i + 1) % k, k + i) for i in range(k)] + [
        tuple(range(k)),
        tuple(range(k, 2 * k)),
    ]


def piercing():
    """A pyramid whose apex is pushed through its own base."""
    points = [(0, 0, 0), (4, 0, 0), (4, 4, 0), (0, 4, 0), (2, 2, 1), (2.2, 2.1, -1)]
    lower = [(0, 1, 2, 3)]
    upper = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
    turned = [(a, b, 5 if c == 4 and a == 0 else c) for a, b, c in upper]
    turned += [(1, 4, 5), (0, 5, 4)]
    return points, lower + turned


@pytest.mark.parametrize(
    ("points", "faces", "words"),
    [
        (UNIT, BOX[:5], r"the edge from .* is open"),
        (UNIT, [], "there is no face"),
        (UNIT, [(0, 1)], "fewer than 3"),
        (UNIT, [(0, 1, 2, 8)], "there is no vertex 8"),
        (UNIT, [(0, 1, 1, 2)], "stands there twice"),
        (UNIT, [(0.0, 1.0, 2.0)], "whole numbers"),
        (UNIT, 3, "no faces"),
        (UNIT[:3], BOX, "shape \\(n, 3\\)"),
        (UNIT[:, :2], BOX, "shape \\(n, 3\\)"),
        (lifted(np.nan), BOX, "not finite"),
        (lifted(0.01), BOX, r"warped face: vertex .* off its plane"),
        (np.concatenate([UNIT, [(5, 5, 5)]]), BOX, "no face has vertex 8"),
        (UNIT * (1, 1, 0), BOX, "without area"),
        (UNIT, [*BOX[2:], (0, 2, 3, 1), (4, 5, 6, 7)], "(crosses|is open)"),
        (*two_shells(), "falls into 2 parts"),
        (*sharing_an_edge(), "joins 4 faces|no face has vertex"),
        (*crossing_itself(), "crosses or touches itself"),
        (*piercing(), "crosses itself near"),
        (1e70 * UNIT, BOX, "overflow"),
    ],
)
def test_what_is_no_block_is_refused_with_its_place(points, faces, words):
    with pytest.raises(la.InputError, match=words):
        la.Polyhedron(points, faces)


def test_a_larger_tolerance_takes_a_warped_face_as_plane():
    with pytest.raises(la.InputError, match="warped"):
        la.Polyhedron(lifted(1e-4), BOX)
    assert la.Polyhedron(lifted(1e-4), BOX, tolerance=1e-4).area.size == 6


def test_a_moebius_band_with_a_lid_is_refused():
    """The projective plane: six vertices, ten triangles, closed, and with one side only."""
    faces = [(0, 1, 4), (0, 1, 5), (0, 2, 3), (0, 2, 4), (0, 3, 5)]
    faces += [(1, 2, 3), (1, 2, 5), (1, 3, 4), (2, 4, 5), (3, 4, 5)]
    points = np.random.default_rng(0).normal(size=(6, 3))
    with pytest.raises(la.InputError, match="one side only"):
        la.Polyhedron(points, faces)
