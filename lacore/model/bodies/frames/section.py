"""Cross-sections of members: yield under combined axial force and moment.

A section yields on a convex polygon of N and M around ``N = M = 0``. M is positive where it bends
the member to the left, seen from its first node: tension is on the right, below a beam drawn from
left to right (sagging). The dissipation at the end of a member is in
`lacore.model.bodies.frames.ways`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import inf, isfinite

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError, is_plane_vector, require_known, require_range
from lacore.reporting.showing import Compact

_ROUND_OFF = 1e-9  # by the largest: coordinates of equal corners
SIDES = INNER, OUTER = "inner", "outer"
Corners = tuple[tuple[float, float], ...]


@dataclass(frozen=True, eq=False, repr=False)
class Section(Compact):
    """Strength of a cross-section; builders are in `lacore.sections`.

    Attributes:
        corners: corners of the upper side of the yield polygon, ``((N, M), ...)`` from compression
            (N < 0) to tension, N and N m per unit thickness; N is infinite for members without
            limit to it: ``((-inf, M_p), (inf, M_p))``.
        name: name for messages and tables.
        side: ``inner`` or ``outer`` for a polygon inside or around a yield curve, whose load
            factors are lower or upper bounds; empty if the polygon is the yield surface itself.
        other: corners of the polygon on the other side of that curve.
        lower: lower side, likewise; None: the mirror image, for equal M in both senses. Then M >= 0
            in `corners`.
        plastic_moment: the largest M of the polygon in either sense, N.
        sagging: the largest M > 0, N: tension below a beam that is drawn from left to right.
        hogging: the largest M in the other sense, N, > 0.
        squash_load: half the width of the polygon, N/m: the largest N if tension and compression
            are equal.
        middle: N_0 of that width, N/m.

    Raises:
        InputError: corners that are not sides of a convex polygon, or leave ``N = M = 0`` outside.

    Example:
        >>> diamond = la.sections.Section(corners=((-1e3, 0.0), (0.0, 50.0), (1e3, 0.0)))
        >>> diamond.plastic_moment
        50.0
    """

    corners: Corners
    name: str = ""
    lower: Corners | None = None
    side: str = ""
    other: Corners | None = None
    plastic_moment: float = field(init=False)
    sagging: float = field(init=False)
    hogging: float = field(init=False)
    squash_load: float = field(init=False)
    middle: float = field(init=False)

    def __post_init__(self) -> None:
        upper = _read("Section.corners", self.corners, 1.0)
        lower = upper * [1.0, -1.0]
        if self.lower is not None:
            lower = _read("Section.lower", self.lower, -1.0)
            object.__setattr__(self, "lower", tuple(map(tuple, lower.tolist())))
        _check_around(upper, lower, self.lower is None)
        if self.side or self.other is not None:
            require_known("Section.side", self.side, SIDES)
            _read("Section.other", self.other or (), 1.0)
        object.__setattr__(self, "corners", tuple(map(tuple, upper.tolist())))
        sagging, hogging = float(upper[:, 1].max()), -float(lower[:, 1].min()) + 0.0
        object.__setattr__(self, "sagging", sagging)
        object.__setattr__(self, "hogging", hogging)
        object.__setattr__(self, "plastic_moment", max(sagging, hogging))
        first, last = upper[[0, -1], 0].tolist()
        object.__setattr__(self, "squash_load", (last - first) / 2)
        object.__setattr__(self, "middle", (first + last) / 2 if isfinite(last) else 0.0)

    def on_side(self, side: str) -> Section:
        """Return the section with its polygon on a side of the yield curve; itself without one."""
        if not self.side or self.side == side:
            return self
        assert self.other is not None
        return replace(self, corners=self.other, other=self.corners, side=side)

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
    def chains(self) -> tuple[Floats, Floats]:
        """Upper and lower side, corners from compression to tension, (k, 2) each."""
        upper = np.array(self.corners)
        mirrored = upper * [1.0, -1.0]
        return upper, mirrored if self.lower is None else np.array(self.lower)

    @property
    def outline(self) -> Floats:
        """All corners of a finite polygon, anticlockwise, each once, (k, 2)."""
        upper, lower = self.chains
        points = np.concatenate([lower, upper[::-1]])
        largest = np.maximum(np.abs(points).max(axis=0), np.finfo(float).tiny)
        step = np.abs(np.roll(points, -1, axis=0) - points) / largest
        points = points[step.max(axis=1) > _ROUND_OFF]
        before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
        turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        return np.asarray(points[turn > _ROUND_OFF * np.prod(largest)])

    @cached_property
    def sides(self) -> tuple[Floats, Floats]:
        """Sides ``n N + m M <= 1 + (n, m) . centre`` about a centre of the polygon.

        Returns:
            (n, m), shape (k, 2), and the centre, (2,), of a finite polygon with both strengths.
        """
        points = self.outline
        along = np.roll(points, -1, axis=0) - points
        cross = points[:, 0] * np.roll(points[:, 1], -1) - np.roll(points[:, 0], -1) * points[:, 1]
        centre = np.sum(cross[:, None] * (points + np.roll(points, -1, axis=0)), axis=0)
        centre = centre / (3 * cross.sum())
        normal = np.stack([along[:, 1], -along[:, 0]], axis=1)
        reach = np.sum(normal * (points - centre), axis=1)
        return normal / reach[:, None], centre

    def use(self, axial: Floats, moment: Floats) -> Floats:
        """Return the factor by which N and M exceed the polygon, at most 1 inside, shapes (k,).

        It is measured from the centre of the polygon; for a segment, from its middle.
        """
        if self.rigid or not (self.bends or self.extends):
            return np.zeros(moment.shape)
        if not self.extends:
            half, middle = (self.sagging + self.hogging) / 2, (self.sagging - self.hogging) / 2
            return np.asarray(np.abs(moment - middle) / half)
        if not self.bends:
            return np.asarray(np.abs(axial - self.middle) / self.squash_load)
        normal, centre = self.sides
        away = np.stack([axial - centre[0], moment - centre[1]])
        return np.asarray((normal @ away).max(axis=0))


def _read(where: str, corners: Sequence[Sequence[float]], sense: float) -> Floats:
    """Return the corners (k, 2) of the upper (1) or lower (-1) side of a polygon, checked."""
    if not isinstance(corners, Sequence | np.ndarray) or len(corners) < 2:
        raise InputError(where, corners, "no polygon", "give ((-N, M), ..., (N, M))")
    first, last = corners[0], corners[-1]
    if len(corners) == 2 and tuple(first)[:1] == (-inf,) and tuple(last)[:1] == (inf,):
        moments = {float(first[1]), float(last[1])}
        if len(moments) == 1 and sense * min(moments) >= 0:
            return np.array(corners, dtype=np.float64)
    for corner in corners:
        if not is_plane_vector(corner):
            raise InputError(where, corner, "not (N, M)", "give two numbers, N/m and N")
        require_range(where, *corner)
    points = np.array(corners, dtype=np.float64)
    largest = np.maximum(np.abs(points).max(axis=0), np.finfo(float).tiny)
    along = np.diff(points, axis=0)
    turning = along[:-1, 0] * along[1:, 1] - along[:-1, 1] * along[1:, 0]
    convex = np.all(sense * turning <= _ROUND_OFF * np.prod(largest))
    if np.any(along[:, 0] <= 0) or not convex:
        half, turns = ("upper", "clockwise") if sense > 0 else ("lower", "anticlockwise")
        raise InputError(
            where,
            [tuple(own) for own in corners],
            f"no {half} half of a convex polygon",
            f"give corners from compression to tension that turn {turns}",
        )
    return points


def _check_around(upper: Floats, lower: Floats, mirrored: bool) -> None:
    """Check that both sides form one polygon around ``N = M = 0``."""
    shown = [tuple(own) for own in upper.tolist()]
    if mirrored and np.any(upper[:, 1] < 0):
        raise InputError(
            "Section.corners",
            shown,
            "M < 0 on the upper half of a polygon that is the same below",
            "give M >= 0, or `lower`, too; lacore.sections.polygon takes all corners",
        )
    ends, others = upper[[0, -1]], lower[[0, -1]]
    if not np.array_equal(ends[:, 0], others[:, 0]) or np.any(ends[:, 1] < others[:, 1]):
        raise InputError(
            "Section.lower",
            [tuple(own) for own in lower.tolist()],
            "does not begin and end below the upper side",
            "give both sides the same N at either end",
        )
    if np.isinf(ends).any():
        return
    above, below = (np.interp(0.0, own[:, 0], own[:, 1]) for own in (upper, lower))
    if not (ends[0, 0] <= 0 <= ends[1, 0] and below <= 0 <= above):
        why = "a section that yields under no force"
        raise InputError("Section.corners", shown, why, "let N = M = 0 lie inside")
