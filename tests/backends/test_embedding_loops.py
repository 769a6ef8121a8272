"""Loops that numba compiles do what NumPy does."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from backends._embedding.cones import Compliance, Scaling, product
from backends._embedding.frames import Frame
from backends._embedding.loops import plain

compiled = pytest.importorskip("backends._embedding.loops.compiled")
SUMS = 1e-12  # sums of a few terms of order one, in another order


@pytest.fixture
def rng():
    return np.random.default_rng(7)


def near(a, b):
    np.testing.assert_allclose(a, b, rtol=SUMS, atol=SUMS)


def test_stiffness_has_the_same_pattern_and_sum(rng):
    n, m = 23, 8
    elements = [
        np.array([np.sort(rng.choice(n, width, replace=False)) for _ in range(m // 2)])
        for width in (3, 5)
    ]
    both = [loops.pattern(elements, n) for loops in (plain, compiled)]
    for one, other in zip(*both, strict=True):
        for a, b in zip(one, other, strict=True):
            np.testing.assert_array_equal(a, b)
    starts, columns, places = both[0]
    rows = [rng.normal(size=(m // 2, 2, 2, own.shape[1])) for own in elements]
    points = [rng.permutation(m).reshape(m // 2, 2) for _ in elements]
    blocks = [rng.normal(size=(2, 2, m)) for _ in elements]
    blocks = [block + block.transpose(1, 0, 2) for block in blocks]
    given = (columns.size, rows, points, places, blocks)
    near(plain.assembled(*given), compiled.assembled(*given))
    # And both are the sum, its upper triangle.
    whole = np.zeros((n, n))
    for own, row, point, block in zip(elements, rows, points, blocks, strict=True):
        for e, column in enumerate(own):
            for k in range(2):
                r = row[e, k]
                whole[np.ix_(column, column)] += r.T @ block[:, :, point[e, k]] @ r
    found = csr_matrix((compiled.assembled(*given), columns, starts), (n, n)).toarray()
    near(found, np.triu(whole))


@pytest.mark.parametrize("dim", [1, 3])
def test_rows_of_points_are_taken_apart_alike(rng, dim):
    m, n = 12, 17
    rows = rng.normal(size=(m * dim, n)) * (rng.uniform(size=(m * dim, n)) > 0.6)
    rows[: 2 * dim] = 0.0
    matrix = csr_matrix(rows)
    both = [loops.touched(matrix, dim) for loops in (plain, compiled)]
    for one, other in zip(*both, strict=True):
        np.testing.assert_array_equal(one, other)
    starts, columns = both[0]
    point, other = 3, 5
    wide = np.union1d(*(columns[starts[p] : starts[p + 1]] for p in (point, other)))[None]
    for loops in (plain, compiled):
        found = loops.dense(matrix, np.array([[point, other]]), wide, dim)
        each = rows.reshape(m, dim, n)[[point, other]][:, :, wide[0]]
        np.testing.assert_array_equal(found, each[None])


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_rates_and_forces_are_the_same(rng, dim):
    m, n = 9, 11
    dense = rng.normal(size=(m * dim, n)) * (rng.uniform(size=(m * dim, n)) > 0.6)
    matrix, u, z = csr_matrix(dense), rng.normal(size=n), rng.normal(size=(dim, m))
    for loops in (plain, compiled):
        near(loops.rates(matrix, dim, u), (dense @ u).reshape(m, dim).T)
        near(loops.forces(matrix, z), dense.T @ z.T.ravel())


def compliances(rng, dim, m):
    """That of a flowing cone, of ``W^2``, and of none."""
    scaling = Scaling.between(*insides(rng, dim, m))
    flowing = Compliance(rng.uniform(1, 2, m), rng.uniform(0, 2, m), rng.normal(size=(dim, m)))
    none = [Compliance.none(m)] if dim == 1 else []
    return [flowing, Compliance.twice(scaling), *none]


def insides(rng, dim, m):
    points = rng.normal(size=(2, dim, m))
    points[:, 0] = np.linalg.norm(points[:, 1:], axis=1) + 0.1
    return points


def dense(soft):
    """C of each point, shape (m, dim, dim)."""
    mirror = np.eye(soft.w.shape[0])
    mirror[0, 0] = soft.first
    return np.array(
        [
            square * (mirror + rank * np.outer(w, w))
            for square, rank, w in zip(soft.square, soft.rank, soft.w.T, strict=True)
        ]
    )


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_products_of_the_system_are_the_same(rng, dim):
    m, n = 9, 11
    rows = rng.normal(size=(m * dim, n)) * (rng.uniform(size=(m * dim, n)) > 0.6)
    matrix, u, z, a = csr_matrix(rows), rng.normal(size=n), *rng.normal(size=(2, dim, m))
    for soft in compliances(rng, dim, m):
        each = dense(soft)
        near(soft.times(z), np.einsum("mij,jm->im", each, z))
        stiff = soft.inverse(np.full(m, 0.5))
        inverse = np.linalg.inv(each + 0.5 * np.eye(dim))
        near(stiff.blocks, inverse.transpose(1, 2, 0))
        for loops in (plain, compiled):
            force, found = np.ones(n), np.ones((dim, m))
            loops.times(matrix, u, z, soft, force, found)
            near(found, 1 + (rows @ u).reshape(m, dim).T + soft.times(z))
            near(force, 1 + rows.T @ z.T.ravel())
            force = np.ones(n)
            loops.pulled(matrix, stiff, a, force)
            by = np.einsum("mij,jm->im", inverse, a)
            near(force, 1 + rows.T @ by.T.ravel())
            loops.moved(matrix, stiff, u, a, found)
            rest = a - (rows @ u).reshape(m, dim).T
            near(found, np.einsum("mij,jm->im", inverse, rest))


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_what_makes_up_for_rates_along_flows_is_the_same(rng, dim):
    m, free = 13, 1.0
    soft, rates = compliances(rng, dim, m)[0], rng.normal(size=(dim, m))
    flows = np.sum(soft.w**2, axis=0) > free
    assert 0 < flows.sum() < m
    for loops in (plain, compiled):
        z = np.zeros((dim, m))
        loops.along(soft, free, rates, z)
        left = np.sum(soft.w * (rates - soft.times(z)), axis=0)
        near(left[flows], 0.0)
        near(z[:, ~flows], 0.0)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_scalings_and_aims_are_the_same(rng, dim):
    m = 13
    s, z = insides(rng, dim, m)
    ds, dz, products = rng.normal(size=(3, dim, m))
    one, other = plain.scaled(s, z), compiled.scaled(s, z)
    near(one.square, other.square)
    near(one.w, other.w)
    near(one.middle, other.middle)
    near(one.times(z), one.by(s))
    given = (
        ("heights", (products,)),
        ("corrected", (ds, dz, 0.7)),
        ("banded", (ds, dz, 0.4, (0.1, 2.0))),
    )
    for name, rest in given:
        near(getattr(plain, name)(one, *rest), getattr(compiled, name)(one, *rest))
    # The heights are those of points whose products with the middle are given.
    near(product(one.middle, one.by(plain.heights(one, products))), products)


def test_products_are_moved_into_the_band(rng):
    s, z = insides(rng, 3, 13)
    scaling, none = plain.scaled(s, z), np.zeros((3, 13))
    low, high = 0.9 * np.ones(13), 1.1 * np.ones(13)
    found = product(scaling.middle, scaling.middle)
    found += compiled.banded(scaling, none, none, 1.0, (0.9, 1.1))
    length = np.linalg.norm(found[1:], axis=0)
    assert np.all(found[0] - length >= low - SUMS)
    # What is above comes down by no more than the upper end.
    before = product(scaling.middle, scaling.middle)
    above = before[0] + np.linalg.norm(before[1:], axis=0)
    near(found[0] + length, np.maximum(np.clip(above, low, high), above - high))


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_ways_to_the_edge_are_the_same(rng, dim):
    m = 13
    x, change = rng.normal(size=(2, dim, m))
    x[0] = np.linalg.norm(x[1:], axis=0) + 0.1
    share = plain.farthest(x, change)
    assert compiled.farthest(x, change) == pytest.approx(share, rel=1e-9)
    # There it is at the edge of a cone.
    there = x + share * change
    left = there[0] - np.linalg.norm(there[1:], axis=0)
    assert left.min() == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(("sheared", "volumes", "normed", "others"), [(2, 1, 2, 0), (2, 2, 3, 1)])
def test_planes_have_the_same_frames(rng, sheared, volumes, normed, others):
    m, dim, count = 9, sheared + volumes, normed + others
    scaling = Scaling.between(*insides(rng, 1 + sheared, normed * m))
    squares, slope = rng.uniform(0.1, 2, others * m), rng.normal(size=(count, volumes, m))
    each = dense(Compliance.twice(scaling)).reshape(normed, m, 1 + sheared, 1 + sheared)
    whole = np.zeros((m, dim, dim))
    for k in range(count):
        by = np.zeros((m, 1 + sheared, dim))
        by[:, 0, sheared:] = slope[k].T
        square = np.zeros((m, 1 + sheared, 1 + sheared))
        if k < normed:
            by[:, 1:, :sheared], square = np.eye(sheared), each[k]
        else:
            square[:, 0, 0] = squares.reshape(others, m)[k - normed]
        whole += np.einsum("mai,mab,mbj->mij", by, square, by)
    a = rng.normal(size=(dim, m))
    for loops in (plain, compiled):
        frame = Frame(*loops.frames(scaling, squares, slope, sheared), np.ones(m))
        size = float(np.abs(whole).max())
        near(frame.blocks / size, whole.transpose(1, 2, 0) / size)
        found = loops.framed(frame.values, frame.vectors, a)
        near(found / size, np.einsum("mij,jm->im", whole, a) / size)
        stiff = frame.inverse(np.full(m, 0.5)).blocks.transpose(2, 0, 1)
        near(stiff @ (whole + 0.5 * np.eye(dim)), np.eye(dim) * np.ones((m, 1, 1)))


def test_a_plane_without_strength_has_a_frame(rng):
    """Where nothing is felt there is no direction, and both find zero."""
    scaling = Scaling.between(np.ones((3, 0)), np.ones((3, 0)))
    for loops in (plain, compiled):
        values, vectors = loops.frames(scaling, np.ones(4), np.zeros((1, 1, 4)), 2)
        near(values, 0.0)
        near(np.einsum("mij,mik->mjk", vectors, vectors), np.eye(3) * np.ones((4, 1, 1)))


def test_nan_is_no_way_to_go(rng):
    x, change = np.array([[2.0, 2.0], [1.0, 1.0]]), np.array([[np.nan, 1.0], [0.0, 0.0]])
    for loops in (plain, compiled):
        assert not loops.farthest(x, change) < np.inf
