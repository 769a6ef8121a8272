"""Joints of blocks in space: areas by hand and of Voronoi cells, in any order and frame."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

import lacore as la
from lacore.model.bodies.blocks3d.apart import meeting_alone, require_apart
from lacore.model.bodies.blocks3d.joints import find_joints
from lacore.model.bodies.blocks3d.slits import require_no_slits
from lacore.model.bodies.blocks3d.surface import axes_of
from tests.lacore.model.bodies.blocks3d.solids import (
    L_SHAPE,
    box,
    moved,
    prism,
    triangulated,
    voronoi,
)

NEAR = 1e-6
ROUND_OFF = 1e-12  # of sums of a few dozen products of order one


def in_order(joints):
    """Contact points, sorted: what does not depend on numbers."""
    return np.array(
        sorted(joints.points.T.tolist(), key=lambda own: (np.round(own, 9).tolist(), own))
    )


def test_a_block_across_two():
    """Half a face on each, and the head joint between them: corners at the overlaps only."""
    blocks = {
        "left": box((0, 0, 0), (2, 1, 1)),
        "right": box((2, 0, 0), (4, 1, 1)),
        "top": box((1, 0, 1), (3, 1, 2)),
    }
    joints = find_joints(blocks, NEAR)
    assert joints.master.tolist() == [0, 0, 1]
    assert joints.slave.tolist() == [1, 2, 2]
    assert joints.area == pytest.approx([1, 1, 1], rel=ROUND_OFF)
    upwards = np.array([(1, 0, 0), (0, 0, 1), (0, 0, 1)])
    assert np.allclose(joints.normal.T, upwards, atol=ROUND_OFF)
    assert np.bincount(joints.joint).tolist() == [4, 4, 4]
    assert joints.weight == pytest.approx(np.full(12, 0.25), rel=ROUND_OFF)
    own = joints.points[:, joints.joint == 1]
    expected = np.array([(1, 0, 1), (1, 1, 1), (2, 0, 1), (2, 1, 1)])
    assert np.allclose(sorted(np.round(own.T, 9).tolist()), expected)
    faces = blocks["top"].normal[:, joints.slave_face[1:]]
    assert np.allclose(faces, [[0, 0], [0, 0], [-1, -1]])


def test_points_run_counterclockwise_about_the_normal():
    blocks, _ = voronoi(8, 3)
    joints = find_joints(blocks, 1e-8)
    for number in range(joints.count):
        own = joints.points[:, joints.joint == number]
        one, two = axes_of(joints.normal[:, [number]])
        x, y = own.T @ one[:, 0], own.T @ two[:, 0]
        assert np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) > 0


def test_what_two_blocks_share_in_pieces_are_several_joints():
    """A U on a slab stands on two feet; seen from the slab each foot is a joint."""
    u = [(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]
    blocks = {"u": prism(u, 1), "lid": box((0, 2, 0), (3, 3, 1))}
    joints = find_joints(blocks, NEAR)
    assert joints.count == 2
    assert joints.area == pytest.approx([1, 1], rel=ROUND_OFF)
    assert np.allclose(np.sort(joints.centroid[0]), [0.5, 2.5])


def test_a_piece_that_is_not_convex_gets_the_corners_of_its_hull():
    blocks = {"l": prism(L_SHAPE, 1), "slab": box((0, 0, 1), (2, 2, 2))}
    joints = find_joints(blocks, NEAR)
    assert joints.area == pytest.approx([3], rel=ROUND_OFF)
    expected = [(0, 0, 1), (0, 2, 1), (1, 2, 1), (2, 0, 1), (2, 1, 1)]
    assert in_order(joints) == pytest.approx(np.array(expected, dtype=float), abs=ROUND_OFF)


def test_edges_and_corners_make_no_joint():
    blocks = {"a": box((0, 0, 0), (1, 1, 1)), "b": box((1, 1, 0), (2, 2, 1))}
    assert find_joints(blocks, NEAR).count == 0
    one, other, place = meeting_alone(list(blocks.values()), find_joints(blocks, NEAR), NEAR)
    assert (one.tolist(), other.tolist()) == ([0], [1])
    assert place[:2, 0] == pytest.approx([1, 1], abs=NEAR)
    far = {"a": blocks["a"], "b": box((1, 1.1, 0), (2, 2, 1))}
    assert not meeting_alone(list(far.values()), find_joints(far, NEAR), NEAR)[0].size


@settings(deadline=None, max_examples=10)
@given(st.integers(2, 25), st.integers(0, 10**6))
def test_voronoi_cells_share_their_facets_and_fill_the_box(number, seed):
    blocks, shared = voronoi(number, seed)
    joints = find_joints(blocks, 1e-9)
    require_apart(blocks, 1e-9, "blocks")
    names = list(blocks)
    found = {}
    for master, slave, area in zip(joints.master, joints.slave, joints.area, strict=True):
        pair = tuple(sorted((names[master], names[slave])))
        found[pair] = found.get(pair, 0) + area
    areas = {pair: area_of(facet) for pair, facet in shared.items()}
    # Facets that are narrower than the tolerance are none.
    large = {pair: area for pair, area in areas.items() if area > 1e-7}
    assert set(large) <= set(found) <= set(areas)
    assert all(found[pair] == pytest.approx(area, rel=1e-5) for pair, area in large.items())
    assert sum(block.volume for block in blocks.values()) == pytest.approx(1, rel=1e-10)


def area_of(facet):
    """Of a convex polygon in space, by its hull in its plane."""
    middle = facet - facet.mean(axis=0)
    _, _, axes = np.linalg.svd(middle, full_matrices=False)
    flat = middle @ axes[:2].T
    return ConvexHull(flat).volume if np.ptp(flat, axis=0).min() > 1e-9 else 0.0


@settings(deadline=None, max_examples=10)
@given(st.integers(0, 10**6))
def test_joints_do_not_hang_on_the_order_of_the_blocks(seed):
    blocks, _ = voronoi(12, seed)
    names = list(blocks)
    np.random.default_rng(seed).shuffle(names)
    joints = find_joints(blocks, 1e-8)
    other = find_joints({name: blocks[name] for name in names}, 1e-8)
    assert np.array_equal(in_order(joints), in_order(other))
    assert np.array_equal(np.sort(joints.area), np.sort(other.area))


@pytest.mark.parametrize("turn", [0, 1, 2])
def test_triangulated_faces_give_the_same_joints(turn):
    blocks, _ = voronoi(12, 5)
    cut = {name: triangulated(block, turn) for name, block in blocks.items()}
    joints, other = find_joints(blocks, 1e-8), find_joints(cut, 1e-8)
    assert joints.count == other.count
    assert in_order(other) == pytest.approx(in_order(joints), abs=1e-9)
    assert np.sort(other.area) == pytest.approx(np.sort(joints.area), abs=1e-9)


@settings(deadline=None, max_examples=10)
@given(st.integers(0, 10**6), st.sampled_from([1e-3, 1.0, 1e3]))
def test_turned_moved_and_scaled_they_are_the_same_joints(seed, scale):
    blocks, _ = voronoi(8, 7)
    turn = Rotation.random(rng=np.random.default_rng(seed))
    other = {name: moved(own, turn, (5 * scale,) * 3, scale) for name, own in blocks.items()}
    joints, turned = find_joints(blocks, 1e-8), find_joints(other, 1e-8 * scale)
    assert turned.area == pytest.approx(scale**2 * joints.area, rel=1e-9)
    assert turned.normal == pytest.approx(turn.apply(joints.normal.T).T, abs=1e-9)
    number = np.bincount(joints.joint)
    assert np.bincount(turned.joint).tolist() == number.tolist()
    middle = scale * (turn.apply(joints.centroid.T).T + 5)
    assert turned.centroid == pytest.approx(middle, abs=1e-9 * scale)


@pytest.mark.parametrize(("gap", "count"), [(0.9e-3, 1), (-0.9e-3, 1), (1.1e-3, 0)])
def test_a_gap_within_the_tolerance_is_closed_in_its_middle(gap, count):
    blocks = {"a": box((0, 0, 0), (1, 1, 1)), "b": box((0, 0, 1 + gap), (1, 1, 2))}
    require_apart(blocks, 1e-3, "blocks")
    joints = find_joints(blocks, 1e-3)
    assert joints.count == count
    assert joints.points[2] == pytest.approx(np.full(4 * count, 1 + gap / 2), rel=ROUND_OFF)


@pytest.mark.parametrize(
    ("other", "deep"),
    [
        (box((0.9, 0, 0), (2, 1, 1)), 0.1),
        (box((0.9, 0.8, 0.7), (2, 2, 2)), 0.1),
        (box((0.2, 0.3, 0.4), (0.4, 0.5, 0.6)), 0.2),
        (box((-1, -1, -1), (2, 2, 2)), 1),
        (box((0, 0, 0), (1, 1, 1)), 1),
    ],
)
@pytest.mark.parametrize("cut", [False, True])
def test_blocks_in_each_other_are_refused_with_place_and_depth(other, deep, cut):
    own = box((0, 0, 0), (1, 1, 1))
    blocks = {"one": triangulated(own) if cut else own, "other": other}
    with pytest.raises(la.InputError, match=f"'one', 'other'.*overlap at .* {deep:g} m deep"):
        require_apart(blocks, NEAR, "blocks")


def test_a_block_in_the_corner_of_an_l_is_apart_until_it_is_pushed_in():
    l_shape = prism(L_SHAPE, 1)
    require_apart({"l": l_shape, "box": box((1, 1, 0), (2, 2, 1))}, NEAR, "blocks")
    assert find_joints({"l": l_shape, "box": box((1, 1, 0), (2, 2, 1))}, NEAR).count == 2
    with pytest.raises(la.InputError, match=r"0\.01 m deep"):
        require_apart({"l": l_shape, "box": box((0.99, 1, 0), (2, 2, 1))}, NEAR, "blocks")


@pytest.mark.parametrize(
    ("gap", "refused"), [(1e-7, False), (1e-3, True), (6e-3, True), (0.02, False)]
)
@pytest.mark.parametrize("turn", [None, Rotation.from_rotvec([0.3, 0.5, -0.2])])
def test_blocks_that_nearly_touch_are_refused(gap, refused, turn):
    """Up to 1 % of the area of a face over its diagonal, 0.7 of its side."""
    blocks = {"a": box((0, 0, 0), (1, 1, 1)), "b": box((0, 0, 1 + gap), (1, 1, 2))}
    blocks = {name: moved(own, turn) for name, own in blocks.items()}
    if not refused:
        require_no_slits(blocks, NEAR, "blocks")
        return
    with pytest.raises(la.InputError, match=f"'a', 'b'.*a gap of {gap:.3g} m.*such gaps: 1"):
        require_no_slits(blocks, NEAR, "blocks")
    require_no_slits(blocks, 1.1 * gap, "blocks")


def test_a_gap_with_a_shim_in_it_is_meant():
    shim = box((0.4, 0.4, 1), (0.6, 0.6, 1.005))
    blocks = {"a": box((0, 0, 0), (1, 1, 1)), "b": box((0, 0, 1.005), (1, 1, 2)), "shim": shim}
    require_no_slits(blocks, NEAR, "blocks")


def test_what_tilts_away_is_no_slit():
    lid = la.Polyhedron(box((0, 0, 1), (1, 1, 2)).vertices, box((0, 0, 1), (1, 1, 2)).faces)
    leaning = lid.vertices.copy()
    leaning[[1, 2], 2] += 0.05
    blocks = {"a": box((0, 0, 0), (1, 1, 1)), "b": la.Polyhedron(leaning, lid.faces)}
    require_no_slits(blocks, NEAR, "blocks")
