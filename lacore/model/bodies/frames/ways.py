"""Yield modes of an end of a member whose dissipation is the support function of its polygon.

A polygon with a centre is a sum of segments, one per pair of opposite sides: ``(N, M) = (N_0, M_0)
+ sum s_j (n_j, m_j)/2``, ``|s_j| <= 1`` (a zonogon). Stretched by D and turned by theta it
dissipates ``N_0 D + M_0 theta + sum |n_j D + m_j theta|/2``: as if it consisted of fibres, each
with its own strength, plus a constant force and moment. All sections of fibres are of this kind.

Any other polygon is cut out of a box: with the sides ``a_i . (N, M) <= s_i``, and ``l_i`` the
smallest value on the left, ``y = A (N, M)`` lies in ``l <= y <= s``, so that the dissipation is the
minimum of ``sum (s_i - l_i)/2 |mu_i| + (s_i + l_i)/2 mu_i`` over the mu with ``A^T mu = (D,
theta)``: rates of the sides, all but two of which are separate unknowns. N-M interaction is
therefore a linear program.
"""

from dataclasses import dataclass

import numpy as np

from lacore.model.bodies.frames.section import Section
from lacore.numerics.arrays import Floats

_ROUND_OFF = 1e-9  # by the largest: corners that mirror each other, and parallel sides


@dataclass(frozen=True)
class Ways:
    """Modes of one end: r rates ``a D + t theta + beyond . x``, with e separate unknowns x, 1/s.

    Attributes:
        stretch: a, 1/m, (r,).
        turn: t, (r,).
        beyond: shape (r, e).
        strength: strength against rates of either sign, N m, (r,).
        centre: force of each mode in the middle of both, N m, (r,).
    """

    stretch: Floats
    turn: Floats
    beyond: Floats
    strength: Floats
    centre: Floats


def ways_of(section: Section, stiff: bool) -> Ways:
    """Return the modes of a section that bends, with moment or only axial force at this end."""
    if not section.extends:
        half, middle = (section.sagging + section.hogging) / 2, section.sagging - section.hogging
        return _fibres(np.array([[0.0, half]]), 1.0, np.array([0.0, middle / 2]))
    arm = section.plastic_moment / section.squash_load
    if not stiff:
        low, high = _axial(section)
        half = max((high - low) / 2, 0.0)
        return Ways(
            np.array([1 / arm]),
            np.zeros(1),
            np.zeros((1, 0)),
            np.array([half * arm]),
            np.array([(low + high) / 2 * arm]),
        )
    points = section.outline
    upper, lower = section.chains
    middle = (upper[0] + lower[-1]) / 2
    opposite = 2 * middle - points
    largest = np.abs(points).max(axis=0)
    gaps = np.abs(points[:, None] - opposite[None]) / largest
    if np.all(gaps.max(axis=2).min(axis=1) <= _ROUND_OFF):
        sides = np.diff(points, axis=0, append=points[:1])[: len(points) // 2] / 2
        return _fibres(sides, arm, middle)
    return _slabs(points, section, arm)


def _axial(section: Section) -> tuple[float, float]:
    """Return the smallest and largest N at M = 0, N/m."""
    points = section.outline
    found = []
    for one, other in zip(points, np.roll(points, -1, axis=0), strict=True):
        if min(one[1], other[1]) <= 0 <= max(one[1], other[1]):
            rise = other[1] - one[1]
            ends = [one[0], other[0]]
            found += ends if rise == 0 else [one[0] - one[1] / rise * (other[0] - one[0])]
    return min(found), max(found)


def _fibres(sides: Floats, arm: float, middle: Floats) -> Ways:
    """Return the modes of halves of segments (r, 2) about a middle (2,)."""
    strength = np.abs(sides[:, 0]) * arm + np.abs(sides[:, 1])
    stretch, turn = (sides / strength[:, None]).T
    centre = np.linalg.lstsq(np.stack([stretch * arm, turn]), middle * [arm, 1.0])[0]
    return Ways(stretch, turn, np.zeros((len(sides), 0)), strength, np.asarray(centre))


def _slabs(points: Floats, section: Section, arm: float) -> Ways:
    """Return the modes of the slabs between each side and the farthest corner."""
    scale = np.array([section.squash_load, section.plastic_moment])
    corners = points / scale
    along = np.diff(corners, axis=0, append=corners[:1])
    normals = np.stack([along[:, 1], -along[:, 0]], axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    kept: list[Floats] = []
    for own in normals:  # Parallel sides have one slab.
        if not any(abs(own[0] * one[1] - own[1] * one[0]) <= _ROUND_OFF for one in kept):
            kept.append(own)
    slabs = np.array(kept)
    reach = corners @ slabs.T
    high, low = reach.max(axis=0), reach.min(axis=0)
    most = section.plastic_moment
    both, _ = np.linalg.qr(slabs, mode="complete")
    rates = np.asarray(np.linalg.pinv(slabs).T, dtype=np.float64)
    return Ways(
        np.asarray(rates[:, 0] / arm),
        np.asarray(rates[:, 1]),
        np.asarray(both[:, 2:]),
        most * (high - low) / 2,
        most * (high + low) / 2,
    )
