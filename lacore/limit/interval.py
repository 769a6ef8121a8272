"""Interval of load factors of a state of a problem, in SI units (T14b a)."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from lacore.assembly.discretisation import Discretisation
from lacore.coupling.interval import End, Interval, further, load_factor_interval
from lacore.limit.conversion import point_in_program, point_in_si
from lacore.program.kinematic import (
    dimensionless,
    require_homogeneous,
)
from lacore.program.state import ProgramState
from lacore.reporting import terms
from lacore.reporting.errors import InputError
from lacore.reporting.text import text
from lacore.solvers.inner.preparing import preparer_named


def interval_of_state(
    discretisation: Discretisation,
    point: ProgramState | None,
    backend: str,
    options: Mapping[str, Any],
    tolerance: float,
) -> Interval:
    """Compute the interval of the mechanism of a state of a problem, all in SI units.

    Its ends are not certified if the state is not a Coulomb state (regularised, associated).

    Raises:
        InputError: There is no mechanism, the state belongs to a step of a path, which has a given
            speed, or a soil has non-associated flow.
    """
    if point is None:
        raise InputError(
            "LimitState.interval",
            None,
            "the state has no mechanism, whose load factors these are",
            "ask for the interval of a state with the status SOLVED",
        )
    require_homogeneous(
        discretisation.program,
        "LimitState.interval",
        "ask for the interval of a state of lacore.solve",
    )
    if discretisation.program.frictional:
        raise InputError(
            "LimitState.interval",
            None,
            "the mechanism of a soil whose flow is not associated has no ends that can be proven",
            text("take {}, which looks for the range of load factors", terms.SOIL_RANGE),
        )
    program = dimensionless(discretisation.program, discretisation.natural)
    prepare = preparer_named(backend, options)
    found = load_factor_interval(
        program, point_in_program(discretisation, point), prepare, tolerance
    )
    return _in_si(discretisation, found, point)


def _in_si(discretisation: Discretisation, interval: Interval, state: ProgramState) -> Interval:
    """Convert an interval of the dimensionless program to SI units; it contains a given state."""
    scale = discretisation.natural.load_factor
    ends = []
    for sign, end in ((-1.0, interval.lower), (1.0, interval.upper)):
        there = replace(
            end,
            load_factor=end.load_factor * scale,
            point=point_in_si(discretisation, end.point),
            slack=end.slack * scale,
        )
        known = End(end.status, state.load_factor, state, end.certificate, end.slack * scale)
        ends.append(further(there, known, sign))
    return Interval(*ends)
