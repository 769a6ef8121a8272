"""`limit_thickness`: the parameter at which a structure just stands under dead loads (T80)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from lacore.analyses.along import OF_DEAD, PROBLEM_AT, Along, read_range
from lacore.analyses.critical import Critical, crossing
from lacore.analyses.stable import require_dead_loads
from lacore.assembly.discretisation import Discretisation
from lacore.assembly.discretise import discretise
from lacore.model.problem.problem import Problem
from lacore.program.kinematic import KinematicProgram
from lacore.reporting.errors import typed

OPENING = "pressure that opens all joints, per the one that closes them"
DEAD = "factor of the dead loads"


@typed(problem_at=PROBLEM_AT)
def limit_thickness(
    problem_at: Callable[[float], Problem],
    within: tuple[float, float],
    *,
    tolerance: float = 1e-7,
    scan: int = 0,
    backend: str = "auto",
    options: Mapping[str, Any] | None = None,
    on_value: Callable[[float, float], None] | None = None,
) -> Critical:
    """Compute the thickness, or other parameter, at which a structure just stands (T80).

    A load factor of the weights does not help if friction is the only strength: it is 0 or
    infinite. All joints are therefore closed by one pressure, and opened by another one: if the
    structure stands, it takes more to open it than the closing pressure, and if it collapses, less.
    Reactions prove the side at one end, and a mechanism driven by the dead loads at the other.
    Without joints, or with frames on them, the condition is that the load factor of its dead loads
    is 1.

    Args:
        problem_at: function that returns the problem at a value; its dead loads act alone.
        within: range of the search, (low, high).
        tolerance, scan, on_value: see `critical`.
        backend, options: see `lacore.solve`.

    Raises:
        InputError: an invalid range; no dead loads; an invalid problem, with its value.
        CapabilityError: the backend is missing, or does not support a problem.

    Example:
        >>> def arch(thickness):
        ...     stones = la.masonry.arch(9, 1 - thickness / 2, thickness, friction=0.9)
        ...     return la.Problem(
        ...         bodies={"arch": stones},
        ...         supports=[la.Fix("arch", ("left", "right"))],
        ...         dead_loads=[la.BodyForce("arch", (0, -1))],
        ...         reference_loads=[la.BodyForce("arch", (1, 0))],
        ...     )
        >>> round(la.limit_thickness(arch, within=(0.05, 0.3)).value, 3)  # per radius
        0.102
    """
    low, high = read_range(within)
    given = {"backend": backend, "coupling": "associated", "options": options}
    along = Along(problem_at, given, on_value=on_value)
    along.assembled, along.by_dead = _opened, OF_DEAD
    touching = _touching(along.discretised(low))
    if not touching:
        along.assembled = _by_itself
    of = OPENING if touching else DEAD
    return crossing(along, low, high, 1.0, tolerance, scan, of)


def _touching(stated: Discretisation) -> bool:
    """Return whether joints are opened by a pressure.

    With frames they are not: hinges under loads along members are located in the original problem
    (`lacore.limit.hinging`).
    """
    return stated.program.contact.count > 0 and not stated.frames


def _opened(problem: Problem) -> Discretisation:
    """Return the structure with a dead pressure that closes all contact, and one that opens it."""
    require_dead_loads(problem)
    stated = discretise(problem)
    if not _touching(stated):
        return _by_itself(problem)
    area = float(stated.full.contact.weights.sum())
    weight = stated.full.dead_load - stated.full.held_shut
    pressure = float(np.abs(weight).sum()) / area
    program, full = (_opening(own, pressure) for own in (stated.program, stated.full))
    natural = replace(stated.natural, velocity=1 / float(np.abs(full.reference_load).sum()))
    return replace(stated, program=program, full=full, natural=natural)


def _opening(program: KinematicProgram, pressure: float) -> KinematicProgram:
    rows = program.contact
    opening = pressure * np.asarray(rows.normal.T @ rows.weights)
    return replace(program, reference_load=opening, dead_load=program.dead_load - opening)


def _by_itself(problem: Problem) -> Discretisation:
    """Return the structure with its dead loads as reference loads."""
    require_dead_loads(problem)
    return discretise(replace(problem, reference_loads=problem.dead_loads, dead_loads=()))
