"""Directions in two or three components."""

import numpy as np

from lacore.arrays import Floats

_NEARLY = 1 - 1.5e-6  # cosine of a tenth of a degree


def corners(k: int) -> Floats:
    """Between the axes, of length 1, shape (2^k, k); opposite ones from both ends."""
    signs = np.array(np.meshgrid(*[[1.0, -1.0]] * k)).reshape(k, -1).T
    return np.asarray(signs / np.sqrt(k))


def spread(k: int, count: int) -> Floats:
    """At equal angles, or on a spiral around a sphere, shape (count, k)."""
    number = np.arange(count) + 0.5
    if k == 2:
        around = 2 * np.pi * number / max(count, 1)
        return np.stack([np.cos(around), np.sin(around)], axis=1)
    height = 1 - 2 * number / max(count, 1)
    turned = np.pi * (1 + 5**0.5) * number
    ring = np.sqrt(1 - height**2)
    return np.stack([ring * np.cos(turned), ring * np.sin(turned), height], axis=1)


def apart(one: Floats, other: Floats) -> bool:
    """Whether directions differ by more than a tenth of a degree."""
    size = float(np.linalg.norm(one) * np.linalg.norm(other))
    return float(one @ other) < _NEARLY * size
