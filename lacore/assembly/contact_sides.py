"""What touches at contact points, by name: the slave and the master of each."""

from collections.abc import Iterator

import numpy as np

from lacore.arrays import Ints
from lacore.assembly.discretisation import Discretisation

OBSTACLE = "obstacle"


def contact_sides(discretisation: Discretisation) -> tuple[np.ndarray, np.ndarray]:
    """Names of slaves and of masters at all contact points, (m,) each.

    Of assemblies that of the block, of other bodies their own; "obstacle" where there is no body.
    """
    interface = discretisation.full.contact.interface
    moving = discretisation.points.moving
    sides = np.full(moving.shape, OBSTACLE, dtype=object)
    for number, pair in enumerate(_pairs(discretisation)):
        points = np.flatnonzero(interface == number)
        for column, body in enumerate(pair):
            if body is not None:
                sides[points, column] = _names(discretisation, body, moving[points, column])
    first = len(discretisation.problem.interfaces)
    for dofs in discretisation.jointed.values():
        joints = dofs.body.joints
        names = np.array(dofs.body.names, dtype=object)
        points = np.flatnonzero((interface >= first) & (interface < first + joints.count))
        joint = interface[points] - first
        sides[points] = np.stack([names[joints.slave[joint]], names[joints.master[joint]]], axis=1)
        first += joints.count
    return sides[:, 0], sides[:, 1]


def _pairs(discretisation: Discretisation) -> Iterator[tuple[str, str | None]]:
    """Names of the bodies of interfaces, those of a path first; None: an obstacle."""
    for slave, *master in discretisation.points.met:
        yield slave, next(iter(master), None)
    for interface in discretisation.problem.interfaces:
        slave, *master = (name for name, _ in interface.sides)
        yield slave, next(iter(master), None)


def _names(discretisation: Discretisation, body: str, moving: Ints) -> np.ndarray:
    if body not in discretisation.jointed:
        return np.full(moving.size, body, dtype=object)
    return np.array(discretisation.jointed[body].body.names, dtype=object)[moving]
