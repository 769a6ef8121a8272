"""Curves around folds, and the smoothed projection onto cones that they are followed for (T79)."""

from dataclasses import dataclass
from math import exp

import numpy as np
import pytest

from lacore.numerics.curve import begun, followed
from lacore.numerics.linear_algebra import SingularError
from lacore.numerics.smooth_cone import smoothed


@dataclass
class Scalar:
    """``R(z, s) = f(z) - s``."""

    f: object
    slope: object

    def at(self, place, s):
        return ScalarLocal(self, place, s)


@dataclass
class ScalarLocal:
    own: Scalar
    place: np.ndarray
    s: float

    @property
    def residual(self):
        return self.own.f(self.place) - self.s

    change = np.array([-1.0])

    def linear(self):
        slope = self.own.slope(self.place)
        if slope[0] == 0:
            raise SingularError
        return ScalarLinear(slope)


class ScalarLinear:
    def __init__(self, slope):
        self.slope, self.sign = slope, float(np.sign(slope[0]))

    def solve(self, right):
        return right / self.slope


def test_a_curve_with_two_folds_is_followed_through_both():
    """s = z^3 - 3 z: down from z = 3, up from the fold at z = 1, down again from z = -1."""
    cubic = Scalar(lambda z: z**3 - 3 * z, lambda z: 3 * z**2 - 3)
    start = begun(cubic, np.array([2.0]), 3.0)
    places = []
    for z, s in followed(cubic, start, 3.0):
        places.append((z[0], s))
        # Newton's bar is a hundredth of the smoothing.
        assert abs(z[0] ** 3 - 3 * z[0] - s) <= 0.01 * exp(s)
        if s < -4:
            break
    z, s = np.array(places).T
    assert np.all(np.diff(z) < 0)
    assert z[-1] < -2
    turns = np.flatnonzero(np.diff(np.sign(np.diff(s))))
    assert z[turns + 1] == pytest.approx([1, -1], abs=0.3)


def test_where_there_is_no_solution_no_curve_begins():
    above = Scalar(lambda z: z**2 + 1, lambda z: 2 * z)
    assert begun(above, np.array([1.0]), 0.0) is None


def product(x, y):
    """Of the Jordan algebra of the cone."""
    return np.column_stack([np.sum(x * y, axis=1), x[:, :1] * y[:, 1:] + y[:, :1] * x[:, 1:]])


@pytest.fixture
def places():
    rng = np.random.default_rng(5)
    found = rng.standard_normal((40, 3)) * 10.0 ** rng.integers(-3, 3, (40, 1))
    found[:3] = (1, 0, 0), (-1, 0, 0), (1, 1, 0)  # on the axis, and on the cone
    return found, np.full(40, 1e-3)


def test_a_projection_and_what_is_left_are_nearly_complementary(places):
    z, m = places
    x = smoothed(z, m).value
    y = smoothed(-z, m).value
    size = np.abs(z).max(axis=1)[:, None]
    # Sums and products of numbers of that size.
    assert np.all(np.abs(x - y - z) <= 1e-14 * (1 + size))
    assert np.all(np.abs(product(x, y) - np.outer(m**2, (1, 0, 0))) <= 1e-13 * (1 + size**2))
    for own in (x, y):
        assert np.all(own[:, 0] >= np.linalg.norm(own[:, 1:], axis=1) - 1e-14 * size[:, 0])


def test_derivatives_are_those_of_differences(places):
    z, m = places
    found, h = smoothed(z, m), 1e-6 * m[0]
    matrices = found.blocks(found.slope)
    for axis in range(3):
        step = h * np.eye(3)[axis]
        change = (smoothed(z + step, m).value - smoothed(z - step, m).value) / (2 * h)
        # Round-off of the difference, per step, and its square against the smoothing.
        room = 1e-15 * (1 + np.abs(z).max(axis=1)) / h + 1e-9
        assert np.all(np.abs(change - matrices[:, :, axis]).max(axis=1) <= room)
    later, earlier = (smoothed(z, m * np.exp(s * 1e-5)).value for s in (1, -1))
    assert np.abs((later - earlier) / 2e-5 - found.growth).max() <= 1e-8


def test_what_slopes_lack_of_one_is_not_lost(places):
    z, _ = places
    small = smoothed(z, np.full(40, 1e-12))
    inside = z[:, 0] > 1.1 * np.linalg.norm(z[:, 1:], axis=1)
    assert inside.any()
    spectral = z[:, :1] + np.linalg.norm(z[:, 1:], axis=1)[:, None] * [-1, 1]
    # 1 - p'(s) is m^2/s^2 to the first order.
    assert small.rest[inside, :2] == pytest.approx(1e-24 / spectral[inside] ** 2, rel=1e-9)
    assert np.all(small.rest > 0)
