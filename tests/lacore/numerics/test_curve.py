"""Curves of what has to stay positive, followed around their folds (T79)."""

from dataclasses import dataclass

import numpy as np

from lacore.numerics.curve import Change, followed
from lacore.numerics.linear_algebra import SingularError


@dataclass
class Folded:
    """``F(x, y) = (x y, y - f(x))``, x and y positive."""

    f: object
    slope: object

    def residual(self, z):
        return np.array([z[0] * z[1], z[1] - self.f(z[0])])

    def linear(self, z):
        return Matrix(np.array([[z[1], z[0]], [-self.slope(z[0]), 1.0]]))

    def changes(self, z, dz):
        own = dz / z
        return Change(own, own.min(), own.max())

    def off(self, z, aim):
        if not (z > 0).all():
            return np.inf
        return max(abs(z[0] * z[1] / aim[0] - 1), abs(z[1] - self.f(z[0]) - aim[1]) / z[1])


class Matrix:
    def __init__(self, matrix):
        self.matrix, self.sign = matrix, float(np.sign(np.linalg.det(matrix)))
        if self.sign == 0:
            raise SingularError

    def solve(self, right):
        return np.linalg.solve(self.matrix, right)


FOLDED = Folded(
    lambda x: np.exp(3 * np.sin(np.log(x))),
    lambda x: 3 * np.cos(np.log(x)) / x * np.exp(3 * np.sin(np.log(x))),
)
START = np.array([np.exp(2 * np.pi), 1.0])
"""On ``y = f(x)``. There theta is ``x f(x)``, with two folds in each factor of exp(2 pi) of x."""


def test_a_curve_with_folds_is_followed_through_them():
    places = []
    for place in followed(FOLDED, START):
        places.append(place)
        theta = FOLDED.residual(place.z)[0] / FOLDED.residual(START)[0]
        assert abs(theta / np.exp(place.level) - 1) <= 0.6  # what is near enough after one step
        if place.level < -15:
            break
    levels, x = np.array([p.level for p in places]), np.array([p.z[0] for p in places])
    turns = np.flatnonzero(np.diff(np.sign(np.diff(levels))))
    assert levels[-1] < -15
    assert np.all(np.diff(x) < 0)  # the curve was never followed back
    # dlog(theta)/dlog(x) = 1 + 3 cos(log x) is zero there, between one place and the next.
    low, high = np.log(x[-1]), 2 * np.pi
    zeros = [s * np.arccos(-1 / 3) + k * 2 * np.pi for k in range(-9, 3) for s in (-1, 1)]
    assert len(turns) == sum(low < zero < high for zero in zeros) > 2
    counts = [place.count for place in places]
    assert counts == sorted(counts)


class Nowhere(Folded):
    def off(self, z, aim):
        return np.inf


def test_a_curve_whose_next_place_is_not_found_ends():
    found = list(followed(Nowhere(FOLDED.f, FOLDED.slope), START))
    assert [place.level for place in found] == [0.0]


def test_where_the_derivative_is_singular_no_curve_begins():
    singular = Folded(lambda x: 1 - x, lambda x: -1.0)
    assert not list(followed(singular, np.array([1.0, 1.0])))
