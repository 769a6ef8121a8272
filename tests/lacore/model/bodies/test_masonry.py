"""Builders of walls, stacks and arches."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore.model.bodies.blocks import masonry
from lacore.model.bodies.blocks.masonry import Opening

HALVES, FULL = [0.5, 1, 1, 1, 1, 0.5], [1, 1, 1, 1, 1]
E, U, e, u = [1, 1, 1, 1], [0.5, 1, 1, 1, 0.5], [1, 0.5, -1, 0.5, 1], [0.5, 1, -1, 1, 0.5]
WALLS = {  # rows, blocks, joints: REFERENCES, walls of Ferris & Tin-Loi
    "W1": ([HALVES, FULL] * 3, 33, 83),
    "W2": ([HALVES, FULL] * 5, 55, 141),
    "W3": ([E, U, E, u, e, u, e, u, E, U, E], 46, 102),
}


@pytest.mark.parametrize(("rows", "blocks", "joints"), WALLS.values(), ids=WALLS)
def test_walls_of_the_literature(rows, blocks, joints):
    wall = masonry.running_bond(rows, friction=0.65)
    assert len(wall.names) == blocks + 1  # the base is no block of the wall
    assert wall.names[0] == "base"
    assert wall.joints.count == joints
    assert wall.isolated == ()
    area = 0.4 * 0.175 * sum(w for row in rows for w in row if w > 0)
    assert wall.area[1:].sum() == pytest.approx(area, rel=1e-12)  # sums of 55 terms
    bare = masonry.running_bond(rows, friction=0.65, base=False)
    assert bare.joints.count == joints - sum(w > 0 for w in rows[0])


def test_names_count_blocks_and_not_openings():
    wall = masonry.running_bond([[1, 1, 1], [1, -1, 1]], 0.5, block=(2.0, 1.0))
    assert wall.names == ("base", "c1b1", "c1b2", "c1b3", "c2b1", "c2b2")
    assert wall.centroid[:, wall.names.index("c2b2")] == pytest.approx([5.0, 1.5])
    assert "c1b3|c2b2" in wall.joint_names


@pytest.mark.parametrize(
    ("rows", "parts"),
    [
        ([], ("rows", "no course")),
        ([[1, 1], []], ("rows[1]", "not widths")),
        ([[1, 1], [1, 0, 1]], ("rows[1]", "not widths")),
        ([[1, np.nan]], ("rows[0]", "not widths")),
        ([[1, 1], [1, 0.5]], ("rows[1]", "1.5 blocks wide", "first course 2", "equally wide")),
    ],
)
def test_rows_that_make_no_wall(rows, parts):
    with pytest.raises(la.InputError) as caught:
        masonry.running_bond(rows, 0.5)
    assert all(part in str(caught.value) for part in parts)


def test_regular_bond_makes_the_walls_of_the_literature():
    assert masonry.regular_bond(5, 6, first="halves") == WALLS["W1"][0]
    assert masonry.regular_bond(5, 10, first="halves") == WALLS["W2"][0]
    assert masonry.regular_bond(4, 11, masonry.windows(4, 11, 4)) == WALLS["W3"][0]


def test_openings_cut_blocks():
    rows = masonry.regular_bond(3, 4, [Opening(0.25, 1.5, 0, 2), Opening(2.5, 0.5, 1, 3)])
    assert rows == [
        [0.25, -1.5, 0.25, 1],
        [0.25, -1.5, 0.75, -0.5],
        [1, 1, 0.5, -0.5],
        [0.5, 1, 1, -0.5],
    ]


@pytest.mark.parametrize(
    ("openings", "parts"),
    [
        ([Opening(-0.5, 1, 1, 1)], ("leaves the wall", "move it")),
        ([Opening(2.5, 1, 1, 1)], ("leaves the wall",)),
        ([Opening(1, 1, 3, 2)], ("leaves the wall",)),
        ([Opening(1, 0, 1, 1)], ("leaves the wall",)),
        ([Opening(1, np.nan, 1, 1)], ("Opening(", "no numbers", "in blocks")),
        ([Opening("1", 1, 1, 1)], ("left='1'", "no numbers")),
        ([Opening(0.5, 1, 1, 2), Opening(1, 1, 2, 1)], ("overlap in course 3", "apart")),
    ],
)
def test_openings_that_cannot_be(openings, parts):
    with pytest.raises(la.InputError) as caught:
        masonry.regular_bond(3, 4, openings)
    assert all(part in str(caught.value) for part in parts)


def test_no_window_is_left_without_blocks_that_bear_on_both_sides():
    wall = masonry.running_bond(masonry.regular_bond(20, 50, masonry.windows(20, 50, 6)), 0.65)
    assert len(wall.names) == 990
    assert np.all(supported(wall))


def supported(wall):
    """Whether each block but the base rests on another one."""
    up = wall.joints.normal[1]
    rests = np.zeros(len(wall.names), dtype=bool)
    rests[wall.joints.slave[up > 0.5]] = True
    rests[wall.joints.master[up < -0.5]] = True
    return rests[1:]


@given(seed=st.integers(0, 10**6), courses=st.integers(1, 12), data=st.data())
def test_random_walls_stand(seed, courses, data):
    wide = data.draw(st.integers(1, 12))
    openings = data.draw(st.integers(0, wide * 2 // 5 if courses >= 3 else 0))
    rows = masonry.random_bond(seed, wide, courses, openings)
    assert rows == masonry.random_bond(np.random.default_rng(seed), wide, courses, openings)
    assert len(rows) == courses
    wall = masonry.running_bond(rows, 0.65, block=(1.0, 0.5))
    assert np.all(supported(wall))
    assert min(width for row in rows for width in row if width > 0) > 0.25 - 1e-12
    assert any(width < 0 for row in rows for width in row) == (openings > 0)

    # The resultant of each block's weight meets the ground between its outermost bed joints.
    joints = wall.joints
    beds = np.abs(joints.normal[1]) > 0.5
    upper = np.where(joints.normal[1] > 0, joints.slave, joints.master)[beds]
    ends = np.sort(np.stack([joints.start[0, beds], joints.end[0, beds]]), axis=0)
    left, right = np.full(len(wall.names), np.inf), np.full(len(wall.names), -np.inf)
    np.minimum.at(left, upper, ends[0])
    np.maximum.at(right, upper, ends[1])
    assert np.all((left < wall.centroid[0])[1:] & (wall.centroid[0] < right)[1:])
    if not openings:  # their ends may come near a head joint of the course below
        assert np.all(ends[1] - ends[0] > 0.1 - 1e-12)


def test_random_bond_refuses():
    for wrong in ((0, 5), (5, 0), (5, 2, 1), (4, 5, 2), (5, 5, -1), (5, 5, 1.5)):
        with pytest.raises(la.InputError):
            masonry.random_bond(0, *wrong)


def test_5000_blocks():
    wall = masonry.running_bond(masonry.regular_bond(50, 100), 0.65)
    assert len(wall.names) == 5051
    # Beds: 50 on the base, and two a block (ends of every other course: one) on 99 courses.
    # Heads: 49 or 50 a course.
    assert wall.joints.count == 50 + 99 * 100 + 50 * 49 + 50 * 50


def test_stack():
    pile = masonry.stack([(2.0, 1.0), (1.0, 0.5)], 0.5, {("1", "2"): 0.3})
    assert pile.names == ("base", "1", "2")
    assert pile.joint_names == ("base|1", "1|2")
    assert pile.joints.length == pytest.approx([2.0, 1.0])
    assert pile.joints.coefficient == pytest.approx([0.5, 0.3])
    assert np.allclose(pile.joints.normal, [[0, 0], [1, 1]])


@pytest.mark.parametrize("embrace", [1.0, np.pi, 3.5])
def test_arch(embrace):
    ring = masonry.arch(9, 2.0, 0.3, 0.6, embrace)
    assert set(ring.joint_names) == {"left|1", "right|9"} | {f"{n}|{n + 1}" for n in range(1, 9)}
    assert ring.joints.length == pytest.approx(np.full(10, 0.3), rel=1e-12)
    middle = (ring.joints.start + ring.joints.end) / 2
    radial = middle / np.linalg.norm(middle, axis=0)
    assert np.abs(np.sum(radial * ring.joints.normal, axis=0)).max() < 1e-12  # joints are radial
    assert middle[0].sum() == pytest.approx(0, abs=1e-12)  # symmetric
    # Voussoirs are trapezia between chords of the two circles.
    area = (2.3**2 - 2.0**2) * np.sin(embrace / 9) / 2
    assert ring.area[2:] == pytest.approx(np.full(9, area), rel=1e-12)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: masonry.arch(0, 1, 0.2, 0.6),
        lambda: masonry.arch(9, -1, 0.2, 0.6),
        lambda: masonry.arch(9, 1, 0, 0.6),
        lambda: masonry.arch(9, 1, 0.2, 0.6, embrace=7.0),
        lambda: masonry.arch(1, 1, 0.2, 0.6),
        lambda: masonry.stack([], 0.5),
        lambda: masonry.stack([(1, 0)], 0.5),
        lambda: masonry.running_bond([[1, 1]], 0.5, block=(1, 0)),
        lambda: masonry.running_bond([[1, 1]], -0.5),
        lambda: masonry.fill("wall", [[0, 0], [1, 0], [1, 1]], unit_weight=18e3, level=2),
    ],
)
def test_builders_refuse(wrong):
    with pytest.raises(la.InputError):
        wrong()
