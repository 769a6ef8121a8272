"""Control values of contact along a path, gathered to the rows of a program (T28)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.model.contact.laws import Laws
from lacore.model.contact.obstacles import Obstacle
from lacore.model.contact.rows import ContactPoints
from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.program.kinematic import ContactRows
from lacore.reporting.showing import Compact


@dataclass(frozen=True, repr=False)
class Station(Compact):
    """k control values of one interface.

    Attributes:
        name: of the interface.
        bodies: names of the slave and, where that is a body, of the master.
        places, normals: shape (k, 2); a normal points into the slave.
        weights, gaps: lengths that they stand for and distances where the step begins, m, (k,);
            between bodies 0 where they touch, and negative where they overlap.
        laws: friction, (k,) each.
        away: which of them do not touch where the step begins, (k,).
        x, y: rows of the velocity of the slave against the master, (k, n) each.
        moving: see `ContactPoints`, (k, 2).
    """

    name: str
    bodies: tuple[str, ...]
    places: Floats
    normals: Floats
    weights: Floats
    gaps: Floats
    laws: Laws
    away: Bools
    x: Sparse
    y: Sparse
    moving: Ints

    def take(self, which: Bools) -> "Station":
        """Some of the control values."""
        numbers = np.flatnonzero(which)
        arrays = ("places", "normals", "weights", "gaps", "away", "x", "y", "moving")
        taken = {name: getattr(self, name)[numbers] for name in arrays}
        return replace(self, laws=self.laws.at(numbers), **taken)


def gathered(
    stations: Sequence[Station], obstacles: Sequence[Obstacle], n: int, duration: float
) -> tuple[ContactRows, ContactPoints]:
    """Rows of all stations for n unknowns, and where their points are.

    Args:
        stations: of the obstacles, then of pairs of bodies and of corners of obstacles.
        obstacles: those of the first stations.
        n: unknowns.
        duration: of the step, s.
    """
    places, normal = (
        np.concatenate([np.zeros((0, 2)), *(getattr(own, name) for own in stations)])
        for name in ("places", "normals")
    )
    weights, gaps = (
        np.concatenate([np.zeros(0), *(getattr(own, name) for own in stations)])
        for name in ("weights", "gaps")
    )
    coefficient, limit = (
        np.concatenate([np.zeros(0), *(getattr(own.laws, name) for own in stations)])
        for name in ("coefficient", "limit")
    )
    away = np.concatenate([np.zeros(0, dtype=bool), *(own.away for own in stations)])
    moving = np.concatenate([np.zeros((0, 2), np.int64), *(own.moving for own in stations)])
    x, y = (
        csr_matrix(vstack([csr_matrix((0, n)), *(getattr(own, axis) for own in stations)]))
        for axis in ("x", "y")
    )
    closes = away.any() or any(np.any(own.gaps) for own in stations[len(obstacles) :])
    rows = ContactRows(
        normal=_along(normal, x, y),
        tangential=_along(np.stack([-normal[:, 1], normal[:, 0]], axis=1), x, y),
        tangent_dim=1,
        weights=weights,
        coefficient=coefficient,
        limit=np.where(away, 0.0, limit),  # what does not touch neither sticks nor rubs
        dilatancy=np.zeros(gaps.size),
        interface=np.repeat(np.arange(len(stations)), [own.gaps.size for own in stations]),
        closing=gaps / duration if closes else None,
    )
    names = tuple(own.name for own in stations)
    met = tuple(own.bodies for own in stations)
    return rows, ContactPoints(places, normal, moving, names, gaps, tuple(obstacles), met)


def _along(direction: Floats, x: Sparse, y: Sparse) -> Sparse:
    rows = csr_matrix(x.multiply(direction[:, :1]) + y.multiply(direction[:, 1:]))
    rows.eliminate_zeros()
    return rows
