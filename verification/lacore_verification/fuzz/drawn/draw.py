"""Drawing of friction, and of numbers with few digits, so that reproducers stay short."""

from typing import Any

import numpy as np

Rng = np.random.Generator
DIGITS = 4


def number(rng: Rng, low: float, high: float) -> float:
    """Return a number from an interval, with few digits."""
    return short(float(rng.uniform(low, high)))


def decades(rng: Rng, low: float, high: float) -> float:
    """Return a number between 10^low and 10^high, with uniform logarithm."""
    return short(10.0 ** float(rng.uniform(low, high)))


def short(value: float) -> float:
    """Return a number rounded to a few digits."""
    return float(f"{value:.{DIGITS}g}")


def vector(rng: Rng, size: float = 1.0) -> list[float]:
    """Return a random vector, often vertical or horizontal."""
    if rng.random() < 0.3:
        axis = [[1.0, 0.0], [-1.0, 0.0], [0.0, -1.0], [0.0, 1.0]][rng.integers(4)]
        return [short(size * part) for part in axis]
    angle = rng.uniform(0, 2 * np.pi)
    return [short(size * float(np.cos(angle))), short(size * float(np.sin(angle)))]


def law(rng: Rng, stress: float = 1.0, coulomb: float = 0.5) -> Any:
    """Return a law.

    `coulomb` is the share of Coulomb's, `stress`, Pa, the size of Tresca limits.
    """
    if rng.random() < coulomb:
        return number(rng, 0.05, 1.0)
    kind = rng.integers(4)
    if kind == 0:
        return {"associated": number(rng, 0.05, 0.8)}
    if kind == 1:
        return {"tresca": short(stress * float(rng.uniform(0.1, 1.5)))}
    return "smooth" if kind == 2 else "stick"


def chosen(rng: Rng, among: Any) -> Any:
    """Return one of several."""
    return among[int(rng.integers(len(among)))]
