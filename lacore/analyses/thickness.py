"""`limit_thickness`: the parameter at which a structure just stands under its dead loads (T80)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from lacore.analyses.along import PROBLEM_AT, Along, read_range
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
    """The thickness, or any other parameter, at which a structure just stands by itself (T80).

    A load factor of the weights says nothing of what has no strength but friction: it is 0 or
    endless. So all joints are closed by one pressure, and opened by another, alike: where the
    structure stands it takes more to open it than what closes it, and where it falls less. On which
    side it is reactions prove at one end, a mechanism that the dead loads drive at the other. What
    has no joints, or frames on them, is asked for the factor of its dead loads, which is to be 1,
    too.

    Args:
        problem_at: the problem at a value; its dead loads act alone.
        within: where it is looked for, (low, high).
        tolerance, scan, on_value: see `critical`.
        backend, options: see `lacore.solve`.

    Raises:
        InputError: a range that is none; no dead loads; a problem that cannot be, with its value.
        CapabilityError: the backend is missing, or cannot take a problem.

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
    along.assembled = _opened
    touching = _touching(along.discretised(low))
    if not touching:
        along.assembled = _by_itself
    of = OPENING if touching else DEAD
    return crossing(along, low, high, 1.0, tolerance, scan, of)


def _touching(stated: Discretisation) -> bool:
    """Whether joints are opened by a pressure.

    Beside frames they are not: hinges under loads along members are looked for in the problem as it
    is stated (`lacore.limit.hinging`).
    """
    return stated.program.contact.count > 0 and not stated.frames


def _opened(problem: Problem) -> Discretisation:
    """The structure with a pressure that closes all contact, and one that opens it to refer to."""
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
    """The structure with its dead loads as reference loads."""
    require_dead_loads(problem)
    return discretise(replace(problem, reference_loads=problem.dead_loads, dead_loads=()))
