"""Loads as forces on unknowns, both velocities and multipliers."""

from collections.abc import Iterable, Mapping, Sequence
from functools import singledispatch
from typing import Protocol

import numpy as np

from lacore.model.conditions.footings import Footing, RigidFooting, Twist, footings
from lacore.model.conditions.loads import Load
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError
from lacore.reporting.text import Term, text

_ROUND_OFF = 1e-12  # share of a load that may remain if supports take all of it


class Loaded(Protocol):
    """Unknowns of a body on which forces act: see `lacore.model.bodies.any_body.Dofs`."""

    @property
    def offset(self) -> int:
        """Number of the first."""
        ...

    @property
    def count(self) -> int:
        """Number of unknowns."""
        ...

    def force(self, load: Load) -> Floats:
        """Return the forces of a load on the unknowns, shape (count,), N/m."""
        ...


class UnderFooting(Loaded, Protocol):
    """Unknowns of a body on which a footing can stand."""

    def area(self, footing: Footing) -> float:
        """Return the area under a footing, m^2; m per unit thickness."""
        ...


def footings_of(problem: Problem) -> tuple[Footing, ...]:
    """Return the footings of all loads, each once."""
    loads = [*problem.reference_loads, *problem.dead_loads]
    return tuple(dict.fromkeys(footing.unloaded for footing in footings(loads)))


def numbered_speeds(problem: Problem, first: int) -> dict[Footing, int]:
    """Return the first unknown of each footing, from a number on, see `footings_of`."""
    own = footings_of(problem)
    starts = np.cumsum([first, *(footing.speeds for footing in own)])
    return dict(zip(own, starts[:-1].tolist(), strict=True))


def count_speeds(footings: Iterable[Footing]) -> int:
    """Return the number of speeds of footings."""
    return sum(footing.speeds for footing in footings)


def load_vector(
    loads: Sequence[Load],
    bodies: Mapping[str, Loaded],
    standing: Mapping[str, UnderFooting],
    speeds: Mapping[Footing, int],
    n: int,
) -> Floats:
    """Return the forces of loads on n unknowns, N/m.

    Args:
        loads: loads of one kind.
        bodies: all bodies.
        standing: bodies with footings.
        speeds: the first unknown of each footing, see `numbered_speeds`: its load acts there.
        n: number of unknowns.
    """
    total = np.zeros(n)
    for load in loads:
        first, force = _placed(load, bodies, standing, speeds)
        total[first : first + force.size] += force
    return total


@singledispatch
def _placed(
    load: Load,
    bodies: Mapping[str, Loaded],
    standing: Mapping[str, UnderFooting],
    speeds: Mapping[Footing, int],
) -> tuple[int, Floats]:
    """Return the first unknown that a load acts on, and its forces from there on, N/m."""
    own = bodies[load.body]
    return own.offset, own.force(load)


@_placed.register(RigidFooting)
@_placed.register(Twist)
def _on_footing(
    load: Footing,
    bodies: Mapping[str, Loaded],
    standing: Mapping[str, UnderFooting],
    speeds: Mapping[Footing, int],
) -> tuple[int, Floats]:
    return speeds[load.unloaded], np.array([load.driven_by(standing[load.body].area(load))])


def require_load(loads: Sequence[Load]) -> None:
    """Raise `InputError` if there is no reference load."""
    if not loads:
        raise InputError(
            "Problem.reference_loads",
            None,
            "there is none, so there is nothing that the load factor could multiply",
            text(
                "give at least one load, or let {} drive a path",
                Term("lacore.sequential(..., tools={...})", "[tools.NAME]"),
            ),
        )


class NoPowerError(InputError):
    """Raised if supports take all reference loads, so that no motion has power."""


def require_power(free: Floats, size: float) -> None:
    """Raise `NoPowerError` if no reference load acts on the free unknowns.

    Args:
        free: forces on the free unknowns.
        size: sum of all nodal forces, the scale of round-off: a load with power keeps at least one
            whole nodal force.
    """
    if np.sum(np.abs(free)) <= _ROUND_OFF * size:
        raise NoPowerError(
            "Problem.reference_loads",
            None,
            "they do no power (F0 = 0): they cancel, or act where supports hold the body",
            "load a boundary that can move, or release the support",
        )
