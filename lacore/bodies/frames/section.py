"""Cross-sections of members: what axial force and moment they carry together.

A section yields on a polygon of N and M, symmetric about ``M = 0`` and about a middle N_0. Such a
polygon is a sum of segments, one a pair of opposite sides: ``(N, M) = (N_0, 0) + sum s_j (n_j,
m_j)/2``, ``|s_j| <= 1`` (a zonogon). Stretched by D and turned by theta it dissipates ``N_0 D + sum
|n_j D + m_j theta|/2``: as if it consisted of fibres, each with a strength of its own, and held a
force N_0; so N-M interaction stays a linear program.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import inf, isfinite

import numpy as np

from lacore.arrays import Floats
from lacore.errors import InputError, is_plane_vector, require_range
from lacore.showing import Compact

_ROUND_OFF = 1e-9  # of the largest: coordinates of corners that are equal


@dataclass(frozen=True, eq=False, repr=False)
class Section(Compact):
    """What a cross-section carries; builders are in `lacore.sections`.

    Attributes:
        corners: of the yield polygon where ``M >= 0``, ``((N, M), ...)`` from compression (N < 0)
            to tension, N and N m per unit thickness; N is infinite of members without limit
            to it: ``((-inf, M_p), (inf, M_p))``.
        name: for messages and tables.
        plastic_moment: the largest M of the polygon, N.
        squash_load: half the width of the polygon, N/m: the largest N of what bears as much in
            tension as in compression.
        middle: N_0, N/m.

    Raises:
        InputError: corners that are no upper half of a convex polygon symmetric about a middle N,
            or that leave ``N = 0`` outside.
    """

    corners: tuple[tuple[float, float], ...]
    name: str = ""
    plastic_moment: float = field(init=False)
    squash_load: float = field(init=False)
    middle: float = field(init=False)

    def __post_init__(self) -> None:
        corners = _read(self.corners)
        object.__setattr__(self, "corners", tuple(map(tuple, corners.tolist())))
        object.__setattr__(self, "plastic_moment", float(corners[:, 1].max()))
        first, last = corners[[0, -1], 0].tolist()
        object.__setattr__(self, "squash_load", (last - first) / 2)
        object.__setattr__(self, "middle", (first + last) / 2 if isfinite(last) else 0.0)

    @property
    def extends(self) -> bool:
        """Whether it yields to axial force."""
        return isfinite(self.squash_load)

    @property
    def bends(self) -> bool:
        """Whether it carries moment."""
        return self.plastic_moment > 0

    @property
    def rigid(self) -> bool:
        """Whether it never yields."""
        return not isfinite(self.plastic_moment)

    @property
    def fibres(self) -> Floats:
        """Halves of the segments whose sum the polygon is: n_j and m_j, (k, 2)."""
        if not self.extends:
            return np.array([[0.0, self.plastic_moment]])
        corners = np.array(self.corners)
        sides = [*np.diff(corners, axis=0) / 2, [0.0, corners[0, 1]]]
        return np.array([side for side in sides if np.any(side)])

    @property
    def sides(self) -> tuple[Floats, Floats]:
        """Sides where N >= N_0 and M >= 0: ``n (N - N_0) + m M <= reach``.

        Returns:
            (n, m), shape (k, 2), and reach, (k,).
        """
        corners = np.array([*self.corners, (self.corners[-1][0], 0.0)]) - [self.middle, 0.0]
        along = np.diff(corners, axis=0)
        normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
        reach = np.sum(normal * corners[:-1], axis=1)
        own = (normal[:, 0] >= 0) & (reach > 0)
        return normal[own] / reach[own, None], np.ones(int(own.sum()))

    def use(self, axial: Floats, moment: Floats) -> Floats:
        """Factor by which N and M are beyond the polygon, at most 1 inside, shapes (k,)."""
        axial, moment = np.abs(axial - self.middle), np.abs(moment)
        if self.rigid or not (self.bends or self.extends):
            return np.zeros(moment.shape)
        if not self.extends:
            return np.asarray(moment / self.plastic_moment)
        normal, reach = self.sides
        shares = normal[:, :1] * axial + normal[:, 1:] * moment
        return np.asarray((shares / reach[:, None]).max(axis=0))


def _read(corners: Sequence[Sequence[float]]) -> Floats:
    """Corners (k, 2), checked."""
    field = "Section.corners"
    if not isinstance(corners, Sequence | np.ndarray) or len(corners) < 2:
        raise InputError(field, corners, "no polygon", "give ((-N, M), ..., (N, M))")
    first, last = corners[0], corners[-1]
    if len(corners) == 2 and tuple(first)[:1] == (-inf,) and tuple(last)[:1] == (inf,):
        moments = {float(first[1]), float(last[1])}
        if len(moments) == 1 and min(moments) >= 0:
            return np.array(corners, dtype=np.float64)
    for corner in corners:
        if not is_plane_vector(corner):
            raise InputError(field, corner, "not (N, M)", "give two numbers, N/m and N")
        require_range(field, *corner)
    points = np.array(corners, dtype=np.float64)
    largest = np.maximum(np.abs(points).max(axis=0), np.finfo(float).tiny)
    ends = points[0, 0] + points[-1, 0]
    mirrored = points[::-1] * [-1.0, 1.0] + [ends, 0.0]
    if np.any(np.abs(points - mirrored) > _ROUND_OFF * largest):
        raise InputError(
            field,
            [tuple(own) for own in corners],
            "not symmetric about a middle N, and no sum of segments",
            "give a symmetric polygon inside, to be safe, or one around it",
        )
    points = np.asarray((points + mirrored) / 2)
    if not points[0, 0] <= 0 <= points[-1, 0]:
        why = "a section that yields under no force"
        raise InputError(field, [tuple(own) for own in corners], why, "let N = 0 lie inside")
    along = np.diff(points, axis=0)
    turning = along[:-1, 0] * along[1:, 1] - along[:-1, 1] * along[1:, 0]
    convex = np.all(turning <= _ROUND_OFF * np.prod(largest))
    if np.any(points[:, 1] < 0) or np.any(along[:, 0] <= 0) or not convex:
        raise InputError(
            field,
            [tuple(own) for own in corners],
            "no upper half of a convex polygon",
            "give corners from compression to tension, M >= 0, that turn clockwise",
        )
    return points
