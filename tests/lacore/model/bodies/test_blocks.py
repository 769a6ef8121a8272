"""Block assemblies: joints, friction, outlines, and what is refused."""

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore.model.bodies.blocks import masonry


def box(x0, x1, y0, y1):
    return masonry.rectangle(x0, x1, y0, y1)


LOW, HIGH = box(0, 2, 0, 1), box(0.5, 3, 1, 2)
PAIR = la.BlockAssembly({"low": LOW, "high": HIGH}, friction=0.4)


def test_a_joint_is_the_shared_part_of_two_edges():
    joints = PAIR.joints
    assert PAIR.joint_names == ("low|high",)
    assert (joints.master.tolist(), joints.slave.tolist()) == ([0], [1])
    ends = np.sort(np.stack([joints.start[:, 0], joints.end[:, 0]], axis=1), axis=1)
    assert ends == pytest.approx(np.array([[0.5, 2.0], [1.0, 1.0]]), abs=1e-15)
    assert joints.normal[:, 0] == pytest.approx([0, 1])  # from low into high
    assert joints.length == pytest.approx([1.5])
    assert (joints.coefficient, joints.limit, joints.dilatancy) == ([0.4], [0.0], [0.0])


def test_measures():
    assert PAIR.area == pytest.approx([2.0, 2.5])
    assert PAIR.centroid == pytest.approx(np.array([[1.0, 1.75], [0.5, 1.5]]))
    assert PAIR.radius == pytest.approx(np.hypot([1.0, 1.25], 0.5))
    assert PAIR.size == pytest.approx(np.hypot(3, 2))
    edges = PAIR.edges
    assert np.bincount(edges.block).tolist() == [4, 4]
    outward = (edges.start + edges.end) / 2 - PAIR.centroid[:, edges.block]
    assert np.all(np.sum(outward * edges.normal, axis=0) > 0)


def test_sense_and_closing_vertex_do_not_matter():
    other = la.BlockAssembly({"low": LOW[::-1], "high": [*HIGH, HIGH[0]]}, friction=0.4)
    assert other.area == pytest.approx(PAIR.area)
    assert other.joints.length == pytest.approx(PAIR.joints.length)
    assert np.array_equal(other.joints.normal, PAIR.joints.normal)
    assert len(other.polygons["high"]) == 4


def test_a_sequence_is_numbered():
    assert la.BlockAssembly([LOW, HIGH], 0.4).names == ("0", "1")
    assert la.RigidBlock(LOW).names == ("block",)
    assert la.RigidBlock(LOW).isolated == ("block",)


def test_corner_contacts_are_no_joints():
    diamond = [(1, 1), (1.5, 1.5), (1, 2), (0.5, 1.5)]
    corners = la.BlockAssembly({"low": LOW, "diamond": diamond, "right": box(2, 3, 1, 2)}, 0.4)
    assert corners.joints.count == 0
    assert corners.isolated == ("low", "diamond", "right")


def test_copies_and_pickles():
    some = la.BlockAssembly({"a": LOW, "b": HIGH}, la.STICK, {("a", "b"): la.Tresca(2.0)})
    for twin in (pickle.loads(pickle.dumps(some)), copy.deepcopy(some), replace(some)):
        assert twin.names == some.names
        assert twin.tolerance == pytest.approx(some.tolerance, rel=0)
        assert np.array_equal(twin.joints.limit, [2.0])
        assert twin != some


def refused(parts, blocks, friction=0.4, joint_friction=None, tolerance=None):
    with pytest.raises(la.InputError) as caught:
        la.BlockAssembly(blocks, friction, joint_friction, tolerance)
    message = str(caught.value)
    assert all(part in message for part in parts), message


@pytest.mark.parametrize(
    ("blocks", "parts"),
    [
        ({}, ("BlockAssembly.blocks", "there is no block")),
        ([], ("there is no block",)),
        ("block", ("not polygons",)),
        (3, ("not polygons",)),
        ({"a": [(0, 0), (1, 0)]}, ("blocks['a']", "2 vertices", "at least 3")),
        ({"a": [(0, 0), (1, 0), (0, 0)]}, ("blocks['a']", "2 vertices")),
        ({"a": [(0, 0), (1, 0), (np.nan, 1)]}, ("blocks['a']", "not finite")),
        ({"a": [(0, 0), (1, 0), (1, np.inf)]}, ("blocks['a']", "not finite")),
        ({"a": [(0, 0, 0), (1, 0, 0), (1, 1, 0)]}, ("blocks['a']", "shape (3, 3)")),
        ({"a": "abc"}, ("blocks['a']", "not a polygon")),
        ({"a": None}, ("blocks['a']", "not a polygon")),
        ({1: LOW}, ("1", "not the name of a block")),
        ({"": LOW}, ("not the name of a block",)),
        ({"a|b": LOW}, ("'a|b'", "not the name of a block")),
        ({"a": LOW, "b": [(5, 0), (6, 0), (7, 0)]}, ("'b'", "without area")),
        ({"a": [(1, 1)] * 4}, ("'a'", "without area")),
        ({"a": [(0, 0), (1, 1), (1, 0), (0, 1)]}, ("'a'", "cross", "Self-intersection[0.5 0.5]")),
        ({"a": [(0, 0), (2, 0), (1, 0), (1, 1)]}, ("'a'", "cross or touch themselves")),
        ({"a": LOW, "b": box(1, 3, 0.9, 2)}, ("('a', 'b')", "overlap", "0.1 m^2")),
        ({"a": LOW, "b": LOW}, ("('a', 'b')", "overlap")),
        ({"a": LOW, "b": box(0.5, 0.6, 0.5, 0.6)}, ("('a', 'b')", "overlap")),
        ({"a": LOW, "b": box(0, 2, 1.001, 2)}, ("('a', 'b')", "gap of 0.001 m", "close the gap")),
        ({"a": box(1e9, 1e9 + 1, 0, 1)}, ("tolerance", "origin")),
    ],
)
def test_blocks_that_cannot_be(blocks, parts):
    refused(parts, blocks)


@pytest.mark.parametrize(
    ("friction", "joint_friction", "parts"),
    [
        (-0.1, None, ("BlockAssembly.friction = -0.1", "mu >= 0")),
        (np.nan, None, ("BlockAssembly.friction", "mu >= 0")),
        ("rough", None, ("BlockAssembly.friction = 'rough'", "not a friction law")),
        (0.4, {("a", "b"): -1.0}, ("joint_friction[('a', 'b')] = -1.0",)),
        (0.4, {("a", "b"): 0.1, ("b", "a"): 0.2}, ("('b', 'a')", "given twice")),
        (0.4, {("a", "hgih"): 0.1}, ("('a', 'hgih')", "no such block", "did you mean 'high'")),
        (0.4, {("a", "high"): 0.1}, ("('a', 'high')", "no joint")),
        (0.4, {("a", "a"): 0.1}, ("('a', 'a')", "no joint")),
        (0.4, {"a|b": 0.1}, ("'a|b'", "not a pair")),
    ],
)
def test_friction_that_cannot_be(friction, joint_friction, parts):
    blocks = {"a": LOW, "b": HIGH, "high": box(5, 6, 0, 1)}
    refused(parts, blocks, friction, joint_friction)


@pytest.mark.parametrize("tolerance", [0, -1e-6, np.nan, 1e-18, 3.0])
def test_tolerances_that_cannot_be(tolerance):
    refused(("tolerance",), [LOW, HIGH], tolerance=tolerance)


def test_the_tolerance_closes_gaps_and_swallows_overlaps():
    for move in (1e-3, -1e-3):
        blocks = {"low": LOW, "high": HIGH + np.array([0, move])}
        with pytest.raises(la.InputError):
            la.BlockAssembly(blocks, 0.4)
        assert la.BlockAssembly(blocks, 0.4, tolerance=1.1e-3).joints.count == 1


def test_a_gap_that_another_block_holds_open_is_meant():
    low, high = box(0, 2, 0, 1), box(0, 2, 1.01, 2)
    shims = {"shim 1": box(0.2, 0.4, 1, 1.01), "shim 2": box(1.6, 1.8, 1, 1.01)}
    assert la.BlockAssembly({"low": low, "high": high, **shims}, 0.4).joints.count == 4
    refused(("('low', 'high')", "gap of 0.01 m"), {"low": low, "high": high})


def test_non_convex_blocks_share_several_joints():
    horseshoe = [(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]
    blocks = {"shoe": horseshoe, "key": box(1, 2, 1, 2), "lid": box(0, 3, 2, 3)}
    nested = la.BlockAssembly(blocks, 0.4, {("key", "shoe"): 0.2})
    assert sorted(nested.joint_names) == sorted(
        ["shoe|key", "shoe|key#2", "shoe|key#3", "shoe|lid", "shoe|lid#2", "key|lid"]
    )
    of_key = (nested.joints.slave == 1) & (nested.joints.master == 0)
    assert np.allclose(nested.joints.coefficient, np.where(of_key, 0.2, 0.4))


def test_friction_laws_reach_the_joints():
    blocks = [box(0, 1, n, n + 1) for n in range(4)]
    laws = {("1", "0"): la.Coulomb(0.3, associated=True), ("1", "2"): la.Tresca(5.0)}
    joints = la.BlockAssembly(blocks, la.Coulomb(0.6), laws).joints
    assert joints.coefficient == pytest.approx([0, 0, 0.6])
    assert joints.limit == pytest.approx([0, 5.0, 0])
    assert joints.dilatancy == pytest.approx([0.3, 0, 0])


def test_outline():
    def names(where):
        chosen = PAIR.outline(where, "Fix.where")
        return [PAIR.names[block] for block in PAIR.edges.block[chosen]]

    assert names("high") == ["high"] * 4
    assert names(("low", "high")) == ["low"] * 4 + ["high"] * 4
    assert names(lambda x: x[1] == 0) == ["low"]
    assert names(lambda x: x[1] == 1) == ["low", "high"]
    assert names(lambda x: x[1] >= 1) == ["low"] + ["high"] * 4


@pytest.mark.parametrize(
    ("where", "parts"),
    [
        ("lwo", ("Fix.where = 'lwo'", "did you mean 'low'")),
        (("low", "hihg"), ("'hihg'", "did you mean 'high'")),
        ((), ("empty outline",)),
        (lambda x: x[1] > 5, ("empty outline",)),
        (lambda x: x[0] < 1, ("inside an edge of block 'low'", "put a vertex")),
        (lambda x: 1.0, ("one bool a point",)),
        (7, ("no part of the blocks",)),
    ],
)
def test_outlines_that_cannot_be(where, parts):
    with pytest.raises(la.InputError) as caught:
        PAIR.outline(where, "Fix.where")
    assert all(part in str(caught.value) for part in parts)


@st.composite
def tilings(draw):
    """Rectangles that fill the unit square: cut at random, again and again."""
    whole = [(0.0, 1.0, 0.0, 1.0)]
    cuts = draw(
        st.lists(
            st.tuples(st.floats(0, 0.999), st.booleans(), st.floats(0.1, 0.9)),
            min_size=1,
            max_size=14,
        )
    )
    for which, upright, share in cuts:
        x0, x1, y0, y1 = whole.pop(int(which * len(whole)))
        if upright:
            x = x0 + share * (x1 - x0)
            whole += [(x0, x, y0, y1), (x, x1, y0, y1)]
        else:
            y = y0 + share * (y1 - y0)
            whole += [(x0, x1, y0, y), (x0, x1, y, y1)]
    return {str(n): box(*corners) for n, corners in enumerate(whole)}


def slack(assembly):
    """Overlaps not longer than the tolerance are no joints: one at each end of each edge."""
    return 2 * assembly.edges.start.shape[1] * assembly.tolerance


@given(blocks=tilings())
def test_joints_of_a_tiling_cover_all_inner_edges(blocks):
    tiling = la.BlockAssembly(blocks, 0.5, tolerance=1e-9)
    around = sum(2 * np.ptp(block, axis=0).sum() for block in blocks.values())
    assert abs(tiling.joints.length.sum() - (around - 4) / 2) < slack(tiling)
    assert tiling.area.sum() == pytest.approx(1, rel=1e-12)
    assert tiling.isolated == ()


@given(
    blocks=tilings(),
    angle=st.floats(-np.pi, np.pi),
    shift=st.tuples(st.floats(-100, 100), st.floats(-100, 100)),
    scale=st.sampled_from([1e-3, 1.0, 1e3]),
    mirror=st.booleans(),
)
def test_moved_turned_scaled_and_mirrored(blocks, angle, shift, scale, mirror):
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s], [s, c]]) @ np.diag([-1.0 if mirror else 1.0, 1.0])
    moved = {name: scale * (block @ turn.T + shift) for name, block in blocks.items()}
    tolerance = 1e-9
    first = la.BlockAssembly(blocks, 0.5, tolerance=tolerance)
    second = la.BlockAssembly(moved, 0.5, tolerance=tolerance * scale)
    # Coordinates up to 142 sides keep 3e-14 of the side, and products of them 1e-11.
    near = {"rtol": 0.0, "atol": 1e-10}
    assert second.size <= scale * np.sqrt(2) * first.size
    assert np.allclose(second.area, scale**2 * first.area, rtol=0.0, atol=1e-10 * scale**2)
    assert np.allclose(second.radius / scale, first.radius, **near)
    assert np.allclose(
        second.centroid / scale, turn @ first.centroid + np.reshape(shift, (2, 1)), **near
    )
    old, new = sides(first), sides(second)
    for pair in old.keys() | new.keys():  # an overlap of one tolerance may count or not
        assert abs(old.get(pair, 0.0) - new.get(pair, 0.0) / scale) < 1.1 * tolerance
    if old.keys() == new.keys():
        assert sorted(first.joint_names) == sorted(second.joint_names)
        _, i = np.unique(first.joint_names, return_index=True)
        _, j = np.unique(second.joint_names, return_index=True)
        assert np.allclose(second.joints.normal[:, j], turn @ first.joints.normal[:, i], **near)


def sides(assembly):
    """Length of contact of each pair of blocks."""
    shared = {}
    joints = assembly.joints
    for a, b, length in zip(joints.slave, joints.master, joints.length, strict=True):
        pair = frozenset((assembly.names[a], assembly.names[b]))
        shared[pair] = shared.get(pair, 0.0) + float(length)
    return shared


@given(blocks=tilings(), seed=st.integers(0, 1000))
def test_the_order_of_the_blocks_names_master_and_slave_and_no_more(blocks, seed):
    order = np.random.default_rng(seed).permutation(len(blocks))
    names = list(blocks)
    first = la.BlockAssembly(blocks, 0.5)
    second = la.BlockAssembly({names[n]: blocks[names[n]] for n in order}, 0.5)
    old, new = sides(first), sides(second)
    assert old.keys() == new.keys()
    assert all(abs(old[pair] - new[pair]) < 1e-12 for pair in old)
    for assembly in (first, second):
        joints = assembly.joints
        assert np.all(joints.master < joints.slave)
        across = assembly.centroid[:, joints.slave] - assembly.centroid[:, joints.master]
        assert np.all(np.sum(across * joints.normal, axis=0) > 0)
