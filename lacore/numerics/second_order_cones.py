"""Second-order cones ``x_0 >= ||x_1||`` and what interior-point methods do in them.

Points are arrays of shape (..., c), a cone each; a cone of one component is a half-line. All of it
is the algebra of Andersen, Roos & Terlaky (Math. Program. 95, 2003), as L. Vandenberghe writes it
down in "The CVXOPT linear and quadratic cone program solvers" (2010).
"""

from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Floats


def determinant(x: Floats) -> Floats:
    """``x_0^2 - ||x_1||^2`` without cancellation, shape (...): positive inside, where x_0 is."""
    length = np.linalg.norm(x[..., 1:], axis=-1)
    return np.asarray((x[..., 0] - length) * (x[..., 0] + length))


def outside(x: Floats) -> float:
    """``||x_1|| - x_0`` of the outermost point; -inf of none."""
    out = np.linalg.norm(x[..., 1:], axis=-1) - x[..., 0]
    return float(np.max(out, initial=-np.inf))


def product(x: Floats, y: Floats) -> Floats:
    """``x o y = (x.y, x_0 y_1 + y_0 x_1)``, of the shape of both."""
    found = x[..., :1] * y + y[..., :1] * x
    found[..., 0] = np.sum(x * y, axis=-1)
    return np.asarray(found)


def quotient(x: Floats, y: Floats) -> Floats:
    """The point q with ``x o q = y``, x inside."""
    first = (x[..., 0] * y[..., 0] - np.sum(x[..., 1:] * y[..., 1:], axis=-1)) / determinant(x)
    rest = (y[..., 1:] - first[..., None] * x[..., 1:]) / x[..., :1]
    return np.concatenate([first[..., None], rest], axis=-1)


def farthest(x: Floats, change: Floats) -> float:
    """Largest step along a change that stays in all cones, x inside; inf where all do."""
    size = np.sqrt(determinant(x))[..., None]
    unit, rate = x / size, change / size
    along = unit[..., 0] * rate[..., 0] - np.sum(unit[..., 1:] * rate[..., 1:], axis=-1)
    share = (along + rate[..., 0]) / (unit[..., 0] + 1)
    across = np.linalg.norm(rate[..., 1:] - share[..., None] * unit[..., 1:], axis=-1)
    fastest = float(np.max(across - along, initial=0.0))
    return np.inf if fastest == 0 else 1 / fastest


@dataclass(frozen=True)
class Scaling:
    """The symmetric map W of Nesterov & Todd between two inner points: ``W z = W^-1 s``.

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
        """That of points s and z, inside."""
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
        """The identity, of cones as those of points."""
        size = of.shape[-1]
        every = np.broadcast_to(np.eye(size), (*of.shape, size))
        return cls(every, np.ones(of.shape[:-1]), np.zeros_like(of))

    def times(self, z: Floats) -> Floats:
        """``W z``, of the shape of z."""
        mirror = _mirror(z)
        return self.stretch[..., None] * mirror * applied(self.inverse, mirror * z)


def _mirror(of: Floats) -> Floats:
    return np.append(1.0, -np.ones(of.shape[-1] - 1))


def applied(matrices: Floats, x: Floats) -> Floats:
    """Products of matrices, shape (..., r, c), with points, shape (..., c): shape (..., r)."""
    return np.asarray((matrices @ x[..., None])[..., 0])
