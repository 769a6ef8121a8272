"""Loops that numba compiles do what NumPy does."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from backends._embedding import plain

compiled = pytest.importorskip("backends._embedding.compiled")
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


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_rates_and_forces_are_the_same(rng, dim):
    m, n = 9, 11
    dense = rng.normal(size=(m * dim, n)) * (rng.uniform(size=(m * dim, n)) > 0.6)
    matrix, u, z = csr_matrix(dense), rng.normal(size=n), rng.normal(size=(dim, m))
    for loops in (plain, compiled):
        near(loops.rates(matrix, dim, u), (dense @ u).reshape(m, dim).T)
        near(loops.forces(matrix, z), dense.T @ z.T.ravel())
        force, found = np.ones(n), np.empty((dim, m))
        loops.both(matrix, u, z, force, found)
        near(found, loops.rates(matrix, dim, u))
        near(force, 1 + loops.forces(matrix, z))


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_cones_are_the_same(rng, dim):
    m = 13
    w, z = rng.normal(size=(2, dim, m))
    scale, share = rng.uniform(1, 2, m), rng.normal(size=m)
    near(plain.stretched(scale, share, w, z), compiled.stretched(scale, share, w, z))
    x, change = rng.normal(size=(2, dim, m))
    x[0] = np.linalg.norm(x[1:], axis=0) + 0.1
    share = plain.farthest(x, change)
    assert compiled.farthest(x, change) == pytest.approx(share, rel=1e-9)
    # There it is at the edge of a cone.
    there = x + share * change
    left = there[0] - np.linalg.norm(there[1:], axis=0)
    assert left.min() == pytest.approx(0, abs=1e-9)


def test_nan_is_no_way_to_go(rng):
    x, change = np.array([[2.0, 2.0], [1.0, 1.0]]), np.array([[np.nan, 1.0], [0.0, 0.0]])
    for loops in (plain, compiled):
        assert not loops.farthest(x, change) < np.inf
