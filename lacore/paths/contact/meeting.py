"""Where two sides face each other: the common refinement of their edges, with the gap (T28).

Each segment is a part of one edge of either side. Its ends are vertices of one side and the closest
places of the other, so that neither side is preferred; along it both parameters are linear, so that
the jump of quadratic velocities is quadratic, and so is the vector across the gap. Next to vertices
that are hardly apart there would be slivers, which no solver resolves: they are left out.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.paths.contact.outlines import Outline
from lacore.reporting.showing import Compact

SHARES = (0.0, 1.0, 0.5)
"""Of a segment: its start, its end and its middle, in the order of control values."""
_FACING = np.cos(np.radians(45.0))  # edges that turn more against each other meet at a corner only
SLIVER = 0.02  # of an edge: shorter overlaps are left out


@dataclass(frozen=True, repr=False)
class Meeting(Compact):
    """k segments on which edges of two sides face each other.

    Attributes:
        slave, master: outlines with one edge a segment.
        ends: parameters of the slave, then of the master, at start and end, shape (2, 2, k).
    """

    slave: Outline
    master: Outline
    ends: Floats

    @property
    def count(self) -> int:
        """Number of segments."""
        return int(self.slave.edges.size)

    def parameters(self, share: float) -> tuple[Floats, Floats]:
        """Of slave and master at a share of the segments, shape (k,) each."""
        (a, b), (c, d) = self.ends
        return a + share * (b - a), c + share * (d - c)

    def places(self, share: float) -> tuple[Floats, Floats]:
        """On slave and master, shape (2, k) each."""
        s, t = self.parameters(share)
        return self.slave.at(s), self.master.at(t)

    def normal(self, share: float) -> Floats:
        """Unit normals from the master into the slave, the mean of both sides, shape (2, k)."""
        s, t = self.parameters(share)
        both = self.master.normal(t) - self.slave.normal(s)
        return np.asarray(both / np.linalg.norm(both, axis=0))

    def across(self) -> list[Floats]:
        """Bernstein control values of the vector from master to slave, (2, k) each, by SHARES."""
        return controls_of([one - other for one, other in map(self.places, SHARES)])

    def gaps(self) -> Floats:
        """Control values of the distance, m, negative where the sides overlap, shape (3, k)."""
        own = zip(SHARES, self.across(), strict=True)
        return np.stack([np.sum(self.normal(share) * vector, axis=0) for share, vector in own])

    def take(self, which: Bools | Ints) -> "Meeting":
        """Some of the segments."""
        kept = np.arange(self.count)[which]
        return Meeting(self.slave.take(kept), self.master.take(kept), self.ends[:, :, kept])

    def on(self, slave: Outline, master: Outline, bases: tuple[Outline, Outline]) -> "Meeting":
        """The same material points on the outlines of another configuration.

        Args:
            slave, master: whole sides there.
            bases: whole sides as they were searched.
        """
        moved = [
            whole.take(np.searchsorted(base.edges, own.edges))
            for whole, base, own in zip(
                (slave, master), bases, (self.slave, self.master), strict=True
            )
        ]
        return Meeting(moved[0], moved[1], self.ends)


def controls_of(values: list[Floats]) -> list[Floats]:
    """Control values of quadratics from those at start, end and middle."""
    start, end, middle = values
    return [start, end, 2 * middle - (start + end) / 2]


def meeting(slave: Outline, master: Outline, depth: float) -> Meeting:
    """The segments on which two sides face each other, sorted along the slave.

    Args:
        slave, master: outlines, their edges in ascending order.
        depth: how deep sides that face each other may overlap, m; what is deeper has another body
            in between.
    """
    i, j = np.nonzero(slave.outward.T @ master.outward < -_FACING)
    one, other = slave.take(i), master.take(j)
    onto_slave, onto_master = _ends_of(one, other), _ends_of(other, one)
    low, high = _low(onto_slave, onto_master), _high(onto_slave, onto_master)
    ends = np.stack([np.stack([low.slave, high.slave]), np.stack([low.master, high.master])])
    shares = np.abs(ends[:, 1] - ends[:, 0])
    long = (ends[0, 1] > ends[0, 0]) & (shares.max(axis=0, initial=0.0) > SLIVER)
    found = Meeting(one, other, ends).take(long)
    gaps = found.gaps()
    facing = np.ones(found.count, dtype=bool)
    for share in SHARES:
        s, t = found.parameters(share)
        facing &= np.sum(found.slave.normal(s) * found.master.normal(t), axis=0) < -_FACING
    found = found.take(facing & (gaps.min(axis=0, initial=np.inf) >= -depth))
    order = np.lexsort((found.ends[0, 0], found.slave.edges))
    return found.take(order)


class _Projected(NamedTuple):
    """Ends of the edges of one side on the edges of another one.

    Attributes:
        start, end: parameters on the other edge of start and end of the own one, (k,).
    """

    start: Floats
    end: Floats


class _End(NamedTuple):
    """An end of segments: parameters on slave and master, (k,)."""

    slave: Floats
    master: Floats


def _ends_of(onto: Outline, edges: Outline) -> _Projected:
    return _Projected(onto.closest(edges.curves.start), onto.closest(edges.curves.end))


def _low(master_on_slave: _Projected, slave_on_master: _Projected) -> _End:
    """Where segments begin: at the start of the slave edge, or at an end of the master edge."""
    turned = master_on_slave.start > master_on_slave.end
    first = np.where(turned, master_on_slave.end, master_on_slave.start)
    at_vertex = first > 0
    return _End(
        np.where(at_vertex, first, 0.0),
        np.where(at_vertex, turned.astype(float), np.clip(slave_on_master.start, 0.0, 1.0)),
    )


def _high(master_on_slave: _Projected, slave_on_master: _Projected) -> _End:
    """Where segments end: at the end of the slave edge, or at an end of the master edge."""
    turned = master_on_slave.start > master_on_slave.end
    last = np.where(turned, master_on_slave.start, master_on_slave.end)
    at_vertex = last < 1
    return _End(
        np.where(at_vertex, last, 1.0),
        np.where(at_vertex, 1.0 - turned, np.clip(slave_on_master.end, 0.0, 1.0)),
    )
