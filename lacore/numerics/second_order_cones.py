"""Second-order cones ``x_0 >= ||x_1||`` and their operations in interior-point methods.

Points are arrays of shape (..., c), one cone each; a cone of one component is a half-line. The
algebra is that of Andersen, Roos & Terlaky (Math. Program. 95, 2003), in the form of L.
Vandenberghe, "The CVXOPT linear and quadratic cone program solvers" (2010).
"""

from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Floats


def determinant(x: Floats) -> Floats:
    """Return ``x_0^2 - ||x_1||^2`` without cancellation, shape (...).

    It is positive inside, where x_0 is positive.
    """
    length = np.linalg.norm(x[..., 1:], axis=-1)
    return np.asarray((x[..., 0] - length) * (x[..., 0] + length))


def outside(x: Floats) -> float:
    """Return ``||x_1|| - x_0`` of the outermost point; -inf without points."""
    out = np.linalg.norm(x[..., 1:], axis=-1) - x[..., 0]
    return float(np.max(out, initial=-np.inf))


def product(x: Floats, y: Floats) -> Floats:
    """Return ``x o y = (x.y, x_0 y_1 + y_0 x_1)``, of the shape of both."""
    found = x[..., :1] * y + y[..., :1] * x
    found[..., 0] = np.sum(x * y, axis=-1)
    return np.asarray(found)


def quotient(x: Floats, y: Floats) -> Floats:
    """Return the point q with ``x o q = y``, x inside."""
    first = (x[..., 0] * y[..., 0] - np.sum(x[..., 1:] * y[..., 1:], axis=-1)) / determinant(x)
    rest = (y[..., 1:] - first[..., None] * x[..., 1:]) / x[..., :1]
    return np.concatenate([first[..., None], rest], axis=-1)


def farthest(x: Floats, change: Floats) -> float:
    """Return the largest step along a change that stays in all cones; inf if there is no limit."""
    size = np.sqrt(determinant(x))[..., None]
    unit, rate = x / size, change / size
    along = unit[..., 0] * rate[..., 0] - np.sum(unit[..., 1:] * rate[..., 1:], axis=-1)
    share = (along + rate[..., 0]) / (unit[..., 0] + 1)
    across = np.linalg.norm(rate[..., 1:] - share[..., None] * unit[..., 1:], axis=-1)
    fastest = float(np.max(across - along, initial=0.0))
    return np.inf if fastest == 0 else 1 / fastest


@dataclass(frozen=True)
class Scaling:
    """Symmetric map W of Nesterov & Todd between two interior points: ``W z = W^-1 s``.

    Attributes:
        inverse: W^-1, shape (..., c, c).
        stretch: ``W = stretch J W^-1 J`` with the mirror J = diag(1, -1, ...), shape (...).
        middle: ``W z``, where both meet, shape (..., c).
    """

    inverse: Floats
    stretch: Floats
    middle: Floats

    @classmethod
    def between(cls, s: Floats, z: Floats) -> "Scaling":
        """Return the scaling of interior points s and z."""
        s_size, z_size = np.sqrt(determinant(s)), np.sqrt(determinant(z))
        unit, other = s / s_size[..., None], z / z_size[..., None]
        mirror = _mirror(s)
        half = np.sqrt((1 + np.sum(unit * other, axis=-1)) / 2)
        centre = (unit + mirror * other) / (2 * half)[..., None]
        root = centre.copy()
        root[..., 0] += 1
        root = mirror * root / np.sqrt(2 * (centre[..., :1] + 1))
        square = 2 * root[..., :, None] * root[..., None, :] - np.diag(mirror)
        inverse = square * np.sqrt(z_size / s_size)[..., None, None]
        return cls(inverse, s_size / z_size, applied(inverse, s))

    @classmethod
    def none(cls, of: Floats) -> "Scaling":
        """Return the identity for cones like those of points."""
        size = of.shape[-1]
        every = np.broadcast_to(np.eye(size), (*of.shape, size))
        return cls(every, np.ones(of.shape[:-1]), np.zeros_like(of))

    def times(self, z: Floats) -> Floats:
        """Return ``W z``, of the shape of z."""
        mirror = _mirror(z)
        return self.stretch[..., None] * mirror * applied(self.inverse, mirror * z)


def _mirror(of: Floats) -> Floats:
    return np.append(1.0, -np.ones(of.shape[-1] - 1))


def applied(matrices: Floats, x: Floats) -> Floats:
    """Return the products of matrices, shape (..., r, c), and points, (..., c): shape (..., r)."""
    return np.asarray((matrices @ x[..., None])[..., 0])
