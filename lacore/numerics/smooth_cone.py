"""Projection onto second-order cones of dimension 3, smoothed, with its derivatives.

``P_m(z)`` applies ``(s + sqrt(s^2 + 4 m^2))/2`` to the two spectral values ``z_0 -+ ||z_t||`` of z.
``x = P_m(x - y)`` says that x and y lie in the cone and ``x o y = m^2 e`` (of Chen, Harker, Kanzow
and Smale; on cones Fukushima, Luo & Tseng 2002): at m = 0 they are complementary. Where derivatives
are nearly the identity what they lack of it counts, which has a formula of its own.
"""

from dataclasses import dataclass

import numpy as np

from lacore.arrays import Floats

_APART = 1e-6  # of the larger spectral value: closer ones are one, to round-off of their difference


@dataclass(frozen=True, eq=False)
class Smoothed:
    """The smoothed projection of m places.

    Attributes:
        value: (m, 3).
        vectors: orthonormal eigenvectors of the derivative, (m, 3, 3), one a row.
        slope: eigenvalues of the derivative, (m, 3), in (0, 1).
        rest: 1 less these, without cancellation.
        growth: derivative of the value by the logarithm of the smoothing, (m, 3).
    """

    value: Floats
    vectors: Floats
    slope: Floats
    rest: Floats
    growth: Floats

    def blocks(self, eigenvalues: Floats) -> Floats:
        """Matrices (m, 3, 3) with these eigenvalues, (m, 3), and the eigenvectors."""
        return np.asarray(np.swapaxes(self.vectors, 1, 2) * eigenvalues[:, None, :] @ self.vectors)


def smoothed(places: Floats, smoothing: Floats) -> Smoothed:
    """The projection of places (m, 3), the axis of the cone first, smoothed by some (m,) > 0."""
    tangential = places[:, 1:]
    length = np.linalg.norm(tangential, axis=1)
    ahead = np.where(length[:, None] > 0, tangential, (1.0, 0.0))
    ahead /= np.linalg.norm(ahead, axis=1)[:, None]
    along = places[:, :1] + np.stack([-length, length], axis=1)
    m = smoothing[:, None]
    root = np.hypot(along, 2 * m)
    large = (root + np.abs(along)) / 2
    small = m**2 / large
    ahead_of = np.where(along > 0, large, small)  # at z
    behind = np.where(along > 0, small, large)  # at -z
    slope, rest = ahead_of / root, behind / root
    wide = 2 * length
    distinct = wide > _APART * np.abs(along).max(axis=1) + _APART * smoothing
    wide = np.where(distinct, wide, 1.0)
    across = np.where(distinct, (ahead_of[:, 1] - ahead_of[:, 0]) / wide, slope.mean(axis=1))
    not_across = np.where(distinct, (behind[:, 0] - behind[:, 1]) / wide, rest.mean(axis=1))
    half = np.full((len(places), 1), np.sqrt(0.5))
    vectors = np.stack(
        [
            np.hstack([half, -half * ahead]),
            np.hstack([half, half * ahead]),
            np.column_stack([np.zeros(len(places)), -ahead[:, 1], ahead[:, 0]]),
        ],
        axis=1,
    )
    spectral = np.sqrt(0.5) * np.stack([ahead_of, 2 * m**2 / root])
    value, growth = np.einsum("kms,msx->kmx", spectral, vectors[:, :2])
    return Smoothed(
        np.asarray(value),
        vectors,
        np.column_stack([slope, across]),
        np.column_stack([rest, not_across]),
        np.asarray(growth),
    )
