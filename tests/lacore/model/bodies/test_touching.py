"""Which edges touch, and where."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lacore.model.bodies.touching import Edges, near_misses, touching

TOLERANCE = 1e-9


def chain(points, left=True):
    """Edges from point to point, outward to the left of the way or to the right."""
    points = np.asarray(points, dtype=float).T
    start, end = points[:, :-1], points[:, 1:]
    along = (end - start) / np.linalg.norm(end - start, axis=0)
    normal = np.stack([-along[1], along[0]])
    return Edges(start, end, normal if left else -normal)


def line(x, y=0.0, up=True):
    """Edges on a level line between the abscissae `x`."""
    x = np.asarray(x, dtype=float)
    return chain(np.stack([x, np.full(x.size, y)], axis=1), left=up)


def test_the_shared_part_lies_on_the_first_edge():
    shared = touching(line([0, 2]), line([0.5, 3], up=False), TOLERANCE)
    assert (shared.first.tolist(), shared.second.tolist()) == ([0], [0])
    assert shared.start[:, 0] == pytest.approx([0.5, 0.0])
    assert shared.end[:, 0] == pytest.approx([2.0, 0.0])
    assert shared.length == pytest.approx([1.5])
    assert shared.gap == pytest.approx([0.0])


@pytest.mark.parametrize(
    "second",
    [
        line([0, 1]),  # outward on the same side
        line([1, 2], up=False),  # end to end
        line([1 - 1e-10, 2], up=False),  # overlap within the tolerance
        line([0, 1], y=1e-8, up=False),  # apart
        line([0, 1], y=-1e-8, up=False),  # overlapping deeper than the tolerance
        chain([(0, 0), (1, 1e-3)], left=False),  # touching at an end
        chain([(0, 0), (0, 1)], left=False),  # across
        chain([(0.5, 0), (0.5 + 1e-9, 1e-9)], left=False),  # short enough, but turned by 45 degrees
    ],
)
def test_what_does_not_touch(second):
    assert touching(line([0, 1]), second, TOLERANCE).first.size == 0
    assert touching(second, line([0, 1]), TOLERANCE).first.size == 0


def test_gap_is_the_largest_distance_with_its_sign():
    tilted = chain([(0, 1e-3), (1, 3e-3)], left=False)
    assert touching(line([0, 1]), tilted, 4e-3).gap == pytest.approx([3e-3])
    sunk = chain([(0, 1e-3), (1, -3e-3)], left=False)
    assert touching(line([0, 1]), sunk, 4e-3).gap == pytest.approx([-3e-3])
    assert touching(line([0, 1]), tilted, 2e-3).first.size == 0


def test_near_misses():
    floor, tolerance = line([0, 1]), 1e-6

    def missed(second):
        return near_misses(floor, second, tolerance).gap.tolist()

    assert missed(line([0, 1], y=5e-3, up=False)) == pytest.approx([5e-3])
    assert missed(line([0, 0.1], y=5e-4, up=False)) == pytest.approx([5e-4])
    assert missed(line([0, 0.1], y=5e-3, up=False)) == []  # more than 1 % of the short edge
    assert missed(line([0, 1], y=2e-2, up=False)) == []
    assert missed(line([0, 1], y=1e-7, up=False)) == []  # touches
    assert missed(line([0, 1], y=-5e-3, up=False)) == []  # the far side of something thin
    assert missed(line([1 - 1e-3, 2], y=5e-3, up=False)) == []  # corner by corner
    assert near_misses(floor, line([0, 1], y=0.04, up=False), tolerance, 0.05).first.size == 1


cuts = st.lists(st.integers(1, 999), max_size=20, unique=True).map(
    lambda inner: np.array([0, *sorted(inner), 1000]) / 1000
)


@given(first=cuts, second=cuts, angle=st.floats(-np.pi, np.pi), reverse=st.booleans())
def test_common_refinement(first, second, angle, reverse):
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    def edges(x, left):
        return chain(np.stack([x, np.zeros(x.size)], axis=1) @ turn.T, left)

    a, b = edges(first, True), edges(second[::-1] if reverse else second, reverse)
    shared = touching(a, b, TOLERANCE)
    knots = np.union1d(first, second)
    assert np.allclose(shared.length, np.diff(knots), rtol=0, atol=1e-12)
    assert np.allclose(turn.T @ shared.start, [knots[:-1], 0 * knots[:-1]], rtol=0, atol=1e-12)
    for side, number in ((a, shared.first), (b, shared.second)):
        for point in (shared.start, shared.end):  # inside the edge that is named
            along = (side.end - side.start)[:, number] / side.length[number]
            place = np.sum((point - side.start[:, number]) * along, axis=0)
            assert np.all((place > -1e-12) & (place < side.length[number] + 1e-12))
    swapped = touching(b, a, TOLERANCE)
    assert set(zip(shared.first, shared.second, strict=True)) == set(
        zip(swapped.second, swapped.first, strict=True)
    )


def test_arcs_that_are_cut_differently_touch_within_the_sagitta():
    def arc(n, left):
        angle = np.linspace(0, np.pi, n + 1)
        return chain(np.stack([np.cos(angle), np.sin(angle)], axis=1), left)

    coarse, fine = arc(12, False), arc(31, True)
    sagitta = 1 - np.cos(np.pi / 24)
    shared = touching(coarse, fine, 1.01 * sagitta)
    # All of the coarse arc, but for slivers at its corners that only one of two edges sees.
    assert abs(shared.length.sum() - coarse.length.sum()) < 11 * sagitta
    assert np.abs(shared.gap).max() <= 1.01 * sagitta
    assert touching(coarse, fine, 0.1 * sagitta).length.sum() < coarse.length.sum() / 2


def test_20000_edges():
    """Of each side: a search over all pairs would want gigabytes."""
    n = 20_000
    random = np.sort(np.random.default_rng(0).uniform(size=n - 1))
    first, second = line(np.linspace(0, 1, n + 1)), line([0, *random, 1], up=False)
    shared = touching(first, second, 1e-12)
    assert shared.first.size > 2 * n - 10
    assert shared.length.sum() == pytest.approx(1, abs=1e-7)  # slivers: 2 n of 1e-12
