"""Friction laws, point by point: signs, cones, gaps, and the power of each contact."""

from collections.abc import Iterator, Mapping

import numpy as np

from lacore.arrays import Floats
from verification.fuzz.checks.verdict import Wrong, beyond
from verification.fuzz.drawn.touches import Part, Touches


def check_friction(
    points: Touches, sizes: Mapping[Part, float], power: float, speed: float
) -> Iterator[Wrong]:
    """That each contact point obeys its law.

    Args:
        points: of contact.
        sizes: of the forces on each free part, N/m; a point is judged by the smaller of its two.
        power: that the state turns over, N/m m/s.
        speed: largest velocity, m/s.
    """
    own = np.array(
        [
            min(sizes.get(slave, np.inf), sizes.get(master, np.inf))
            for slave, master in zip(points.slave, points.master, strict=True)
        ]
    )
    own = np.where(np.isfinite(own), own, np.abs(points.force).sum())
    yield from beyond("tension", "normal force", -points.force_n, own)
    shear = np.abs(points.force_t)
    bound = points.mu * points.force_n + points.limit
    yield from beyond("friction cone", "shear beyond it", (shear - bound)[points.limit < np.inf],
                      (own + np.where(np.isfinite(points.limit), points.limit, 0.0))[
                          points.limit < np.inf])  # fmt: skip
    yield from beyond("penetration", "u_n below 0", -points.opening, speed)
    dilated = points.dilatancy > 0
    shortfall = points.dilatancy * np.abs(points.slip) - points.opening
    yield from beyond("dilatancy", "u_n below mu |u_t|", shortfall[dilated], speed)
    stuck = np.isinf(points.limit)
    yield from beyond("no slip", "slip", np.abs(points.slip[stuck]), speed)
    lost = dissipation(points) + points.force_n * points.opening + points.force_t * points.slip
    yield from beyond("law of a contact", "power off by", np.abs(lost), power)


def dissipation(points: Touches) -> Floats:
    """Power of friction at each point, N/m m/s."""
    bound = np.where(points.dilatancy > 0, 0.0, points.mu * points.force_n)
    limit = np.where(np.isfinite(points.limit), points.limit, 0.0)
    return np.asarray((bound + limit) * np.abs(points.slip))
