"""Loops that numba compiles do what NumPy does."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from lacore_backends._embedding.cones import Compliance, Compliances, Scaling, product
from lacore_backends._embedding.frames import Frame
from lacore_backends._embedding.loops import plain
from lacore_backends._embedding.rows import Rows, stacked
from lacore_backends._embedding.stiffness import Stiffness

compiled = pytest.importorskip("lacore_backends._embedding.loops.compiled")
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


@pytest.mark.parametrize("loops", [plain, compiled])
def test_stiffness_of_elements_and_of_single_points_is_the_sum(rng, loops):
    """Three points of an element share unknowns, but for some; points of another kind do not."""
    n, elements = 19, 12
    each = np.zeros((2, elements, 3, 2, n))
    for e in range(elements):
        own = rng.choice(n, 5, replace=False)
        each[0, e][:, :, own] = rng.normal(size=(3, 2, 5))
        each[0, e, 1, :, own[0]] = 0.0
    each[1] = rng.normal(size=each[1].shape) * (rng.uniform(size=each[1].shape) > 0.8)
    rows = [own.reshape(-1, n) for own in each]
    m = 3 * elements
    kinds = [Rows.of(csr_matrix(own), 2, np.ones(m), loops) for own in rows]
    blocks = [block + block.transpose(1, 0, 2) for block in rng.normal(size=(2, 2, 2, m))]
    whole = np.zeros((n, n))
    for own, block in zip(rows, blocks, strict=True):
        points = own.reshape(m, 2, n)
        whole += np.einsum("mia,ijm,mjb->ab", points, block, points)
    near(Stiffness(kinds, loops).upper(blocks).toarray(), np.triu(whole))


@pytest.mark.parametrize("dim", [1, 3])
def test_rows_of_points_are_taken_apart_alike(rng, dim):
    m, n = 12, 17
    rows = rng.normal(size=(m * dim, n)) * (rng.uniform(size=(m * dim, n)) > 0.6)
    rows[: 2 * dim] = 0.0
    matrix = csr_matrix(rows)
    given = matrix.indptr, matrix.indices, dim, n
    both = [loops.touched(*given) for loops in (plain, compiled)]
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


@pytest.fixture
def kinds(rng):
    """Rows of several kinds, some of no point, their compliances, and where the array has them."""
    n, sizes = 11, [(2, 9), (3, 4), (1, 7), (2, 0), (1, 5)]
    each = [rng.normal(size=(m * dim, n)) for dim, m in sizes]
    each = [own * (rng.uniform(size=own.shape) > 0.6) for own in each]
    rows = [
        Rows.of(csr_matrix(own), dim, np.ones(m), plain)
        for own, (dim, m) in zip(each, sizes, strict=True)
    ]
    soft = [compliances(rng, dim, m)[k % 2] for k, (dim, m) in enumerate(sizes[:-1])]
    soft.append(Compliance.none(sizes[-1][1]))
    gaps = [0, 0, 3, 0, 2]  # what is not of these kinds
    places = n + np.cumsum(
        [gap + a * b for gap, (a, b) in zip(gaps, [(0, 0), *sizes], strict=False)]
    )
    stack = stacked(rows, places.tolist())
    return stack, each, soft, int(places[-1]) + 5 + 2


def of_kind(stack, x, k):
    dim, count, _, _, place = stack.spans[k]
    return x[place : place + dim * count].reshape(dim, count)


def test_products_of_the_system_are_the_same(rng, kinds):
    stack, each, soft, size = kinds
    flat, n = Compliances.of(soft), each[0].shape[1]
    delta = np.full(stack.spans[:, 1].sum(), 0.5)
    x, right = rng.normal(size=(2, size))
    inverses = []
    for k, own in enumerate(soft):
        mean = dense(own).reshape(-1, own.w.shape[0], own.w.shape[0])
        near(own.times(of_kind(stack, x, k)), np.einsum("mij,jm->im", mean, of_kind(stack, x, k)))
        inverses.append(np.linalg.inv(mean + 0.5 * np.eye(own.w.shape[0])))
    for loops in (plain, compiled):
        stiff = loops.inverted(stack, flat, delta)
        for block, inverse in zip(loops.blocks(stack, stiff), inverses, strict=True):
            near(block, inverse.transpose(1, 2, 0))
        out, force, found = np.ones(size), np.ones(n), x.copy()
        loops.times(stack, flat, x, out)
        loops.pulled(stack, stiff, right, force)
        loops.moved(stack, stiff, right, found)
        forces, pulls, touched = np.ones(n), np.ones(n), np.zeros(size, dtype=bool)
        for k, (rows, own, inverse) in enumerate(zip(each, soft, inverses, strict=True)):
            z, a = of_kind(stack, x, k), of_kind(stack, right, k)
            rates = (rows @ x[:n]).reshape(*z.T.shape).T
            near(of_kind(stack, out, k), 1 + rates + own.times(z))
            near(of_kind(stack, found, k), np.einsum("mij,jm->im", inverse, a - rates))
            forces += rows.T @ z.T.ravel()
            pulls += rows.T @ np.einsum("mij,jm->im", inverse, a).T.ravel()
            of_kind(stack, touched, k)[:] = True
        near(out[:n], forces)
        near(force, pulls)
        touched[:n] = True  # of `times`
        near(out[~touched], 1.0)
        touched[:n] = False
        near(found[~touched], x[~touched])


def test_what_makes_up_for_rates_along_flows_is_the_same(rng, kinds):
    stack, _, soft, size = kinds
    steep, left = 1.0, rng.normal(size=size)
    for loops in (plain, compiled):
        x = np.zeros(size)
        loops.along(stack, Compliances.of(soft), steep, left, x)
        some = 0
        for k, own in enumerate(soft):
            z, rates = of_kind(stack, x, k), of_kind(stack, left, k)
            if own.first > 0:
                flows, edge = np.sum(own.w**2, axis=0) > steep, own.w
            else:
                flows = (own.w[0] ** 2 > steep) & (own.w.shape[0] > 1)
                edge = np.vstack(
                    [np.ones(z.shape[1]), own.w[1:] / np.linalg.norm(own.w[1:], axis=0)]
                )
            near(np.sum(edge * (rates - own.times(z)), axis=0)[flows], 0.0)
            near(z[:, ~flows], 0.0)
            some += flows.sum()
        assert some > 3


@pytest.mark.parametrize("dim", [2, 3])
def test_leads_are_eliminated_alike(rng, dim):
    """And what is left is the whole: t, rates and stresses with ``dz_0 = c dtau + h dt``."""
    m, tau, dtau, share = 13, 0.7, 0.3, 0.4
    scaling = plain.scaled(*insides(rng, dim, m))
    cost, rise, lead = rng.uniform(0.1, 2, (3, m))
    height, missed, z = rng.normal(size=(dim, m)), *rng.normal(size=(2, dim - 1, m))
    both = [loops.eliminated(scaling, cost, rise, lead, tau) for loops in (plain, compiled)]
    for name in ("raised", "by_tau", "across", "rank", "slope"):
        near(getattr(both[0], name), getattr(both[1], name))
    for loops in (plain, compiled):
        own, right = both[0], np.empty((dim - 1, m))
        given = loops.reduced(own, rise, height, missed, share, right)
        step = loops.strained(scaling, own, (cost, rise), (given, height), dtau, z)
        full = np.vstack([cost * dtau + rise * step[0], z])
        near(step, height - Compliance.twice(scaling).times(full))
        near(loops.flowed(scaling, height, full), step)
        soft = Compliance(scaling.square, own.rank, scaling.w[1:])
        near(step[1:] - share * missed, right - soft.times(z) - dtau * cost * own.across)


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
