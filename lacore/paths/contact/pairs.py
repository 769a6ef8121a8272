"""Two bodies that may touch along a path: their sides, and the friction between them."""

from dataclasses import dataclass

import numpy as np

from lacore.model.bodies.any_body import PlaneBody
from lacore.model.contact.interfaces import Interface
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.showing import Compact

_NEAR = 1e-6  # of the size of the bodies: closer, solvers cannot tell from touching
DEEP = 1e-3
"""How deep bodies of a path may overlap, of the size of the smaller one: loose solvers leave more
than exact ones do."""


@dataclass(frozen=True, repr=False)
class Side(Compact):
    """The part of a body that may touch another one.

    Attributes:
        body: name.
        edges: facets of its mesh, or outline edges of its blocks, shape (n,).
        turn: +1 where the outward normal is the direction of the edge turned by -90 degrees, else
            -1, shape (n,): it stays as the body moves.
    """

    body: str
    edges: Ints
    turn: Floats

    @classmethod
    def of(cls, name: str, body: PlaneBody, where: object, field: str) -> "Side":
        """A part of a body; errors name the `field`."""
        edges, chords = body.boundary(where, field)  # type: ignore[arg-type]
        own = body.curves(edges)
        along = own.end - own.start
        across = along[1] * chords.normal[0] - along[0] * chords.normal[1]
        return cls(name, edges, np.sign(across))


@dataclass(frozen=True, repr=False)
class Pair(Compact):
    """Two sides that may touch, and the law between them.

    Attributes:
        interface: as it was given; its sides have names of boundaries where bodies deform.
        slave, master: which one is which changes the signs of reactions alone.
        size: of the smaller body, m.
        misfit: how far curved edges of the two sides that stand for one curve may be apart, m.
    """

    interface: Interface
    slave: Side
    master: Side
    size: float
    misfit: float

    @property
    def name(self) -> str:
        """Of the interface."""
        return self.interface.name

    @property
    def sides(self) -> tuple[Side, Side]:
        """Slave and master."""
        return self.slave, self.master

    @property
    def self_contact(self) -> bool:
        """Whether both sides belong to one body."""
        return self.slave.body == self.master.body

    @property
    def near(self) -> float:
        """Distance up to which points count as touching, m."""
        return _NEAR * self.size + self.misfit


def misfit(body: PlaneBody, edges: Ints) -> float:
    """How far quadratic edges may be from the smooth curve through their nodes, m.

    A parabola through three points of a circle of radius R, over the angle t, is at most
    ``R t^4/512 = b^3/c^2`` inside, of the sagitta ``b = R t^2/8`` and the chord ``c = R t``;
    control values have twice that.
    """
    curves = body.curves(edges)
    bulge = np.linalg.norm(curves.bulge, axis=0)
    chord = np.linalg.norm(curves.end - curves.start, axis=0)
    return float((2 * bulge**3 / chord**2).max(initial=0.0))
