"""What interior-point methods do in second-order cones, against its definitions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lacore.numerics.second_order_cones import (
    Scaling,
    applied,
    determinant,
    farthest,
    outside,
    product,
    quotient,
)

SIZES = st.integers(1, 4)
SEEDS = st.integers(0, 10**6)
NEAR = st.sampled_from([1.0, 1e-3, 1e-8])


def inner(rng, size, near):
    """Points of three kinds at five places, as close to the edge as `near` of their length."""
    rest = rng.normal(size=(5, 3, size - 1))
    length = np.linalg.norm(rest, axis=-1, keepdims=True)
    first = length + near * (rng.uniform(0.1, 1, length.shape) + length)
    return np.concatenate([first, rest], axis=-1)


@given(SEEDS, SIZES, NEAR)
def test_the_scaling_maps_one_point_to_the_mirror_of_the_other(seed, size, near):
    """``W z = W^-1 s`` with W^-1 symmetric and ``W W^-1 = 1``; the middle is inside."""
    rng = np.random.default_rng(seed)
    s, z = inner(rng, size, near), inner(rng, size, 1.0)
    scaling = Scaling.between(s, z)
    # W^-1 holds numbers whose quotient is that of s to its distance from the edge, 1/near.
    close = {"rtol": 1e-12 / near, "atol": 1e-12}
    np.testing.assert_allclose(scaling.inverse, np.swapaxes(scaling.inverse, -1, -2))
    np.testing.assert_allclose(scaling.times(z), scaling.middle, **close)
    np.testing.assert_allclose(applied(scaling.inverse, scaling.times(s)), s, **close)
    assert outside(scaling.middle) < 0
    # Of both points the product of sizes is that of the middle, squared.
    sizes = determinant(s) * determinant(z)
    np.testing.assert_allclose(determinant(scaling.middle) ** 2, sizes, rtol=1e-6)


@given(SEEDS, SIZES)
def test_a_quotient_times_its_divisor(seed, size):
    rng = np.random.default_rng(seed)
    x, y = inner(rng, size, 1.0), rng.normal(size=(5, 3, size))
    np.testing.assert_allclose(product(x, quotient(x, y)), y, rtol=1e-9, atol=1e-9)


@given(SEEDS, SIZES)
def test_the_farthest_step_ends_on_an_edge(seed, size):
    rng = np.random.default_rng(seed)
    x, change = inner(rng, size, 1.0), rng.normal(size=(5, 3, size))
    step = farthest(x, change)
    assert outside(x + step * change) == pytest.approx(0, abs=1e-9 * (1 + step))
    assert outside(x + 0.999 * step * change) < 0
    assert farthest(x, x) == np.inf


def test_a_determinant_has_no_cancellation():
    """A point 1e-12 inside: of squares nothing would be left."""
    point = np.array([1.0 + 1e-12, 0.6, 0.8])
    # The distance itself is known to the round-off of 1.
    assert determinant(point) == pytest.approx(2e-12, rel=1e-3)
    assert outside(point) == pytest.approx(-1e-12, rel=1e-3)
    assert outside(np.zeros((0, 3))) == -np.inf
