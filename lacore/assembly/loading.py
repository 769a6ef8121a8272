"""Loads as forces on unknowns, of velocities and of multipliers alike."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from lacore.arrays import Floats
from lacore.conditions.loads import Load, RigidFooting
from lacore.errors import InputError
from lacore.problem.problem import Problem

_ROUND_OFF = 1e-12  # of the load that remains where supports take all of it


class Loaded(Protocol):
    """Unknowns of a body that take forces: see `lacore.bodies.any_body.Dofs`."""

    @property
    def offset(self) -> int:
        """Number of the first."""
        ...

    @property
    def count(self) -> int:
        """How many there are."""
        ...

    def force(self, load: Load) -> Floats:
        """Forces of a load on the unknowns, shape (count,), N/m."""
        ...


class UnderFooting(Loaded, Protocol):
    """Those of a body that a footing can stand on."""

    def area(self, footing: RigidFooting) -> float:
        """Of what a footing touches, m^2; m per unit thickness."""
        ...


def footings_of(problem: Problem) -> tuple[RigidFooting, ...]:
    """The footings of all loads, each once whatever its pressure."""
    loads = [*problem.reference_loads, *problem.dead_loads]
    return tuple(dict.fromkeys(_unloaded(load) for load in loads if isinstance(load, RigidFooting)))


def load_vector(
    loads: Sequence[Load],
    bodies: Mapping[str, Loaded],
    standing: Mapping[str, UnderFooting],
    footings: Mapping[RigidFooting, int],
    n: int,
) -> Floats:
    """Forces of loads on n unknowns, N/m.

    Args:
        loads: of one kind.
        bodies: all of them.
        standing: those that footings stand on.
        footings: the unknown of each, see `footings_of`: its load acts there.
        n: unknowns.
    """
    total = np.zeros(n)
    for load in loads:
        if isinstance(load, RigidFooting):
            total[footings[_unloaded(load)]] += load.pressure * standing[load.body].area(load)
        else:
            own = bodies[load.body]
            total[own.offset : own.offset + own.count] += own.force(load)
    return total


def require_power(free: Floats, size: float) -> None:
    """Raise `InputError` where nothing is left of reference loads on the free unknowns.

    Args:
        free: their forces on these.
        size: sum of all nodal forces, of which round-off is a part: a load that can do power keeps
            at least one whole nodal force.
    """
    if np.sum(np.abs(free)) <= _ROUND_OFF * size:
        raise InputError(
            "Problem.reference_loads",
            None,
            "they do no power (F0 = 0): they cancel, or act where supports hold the body",
            "load a boundary that can move, or release the support",
        )


def _unloaded(footing: RigidFooting) -> RigidFooting:
    return replace(footing, pressure=1.0)
