"""`soil_range`: low and high load factors of soils with non-associated flow (T59)."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from lacore.analyses.ranges.load_factors import (
    LoadFactorRange,
    NoState,
    RangeKind,
    SearchRecord,
    range_of,
)
from lacore.assembly.discretisation import Discretisation
from lacore.assembly.discretise import discretise
from lacore.coupling.kinds import CERTIFIED
from lacore.coupling.options import CouplingOptions
from lacore.coupling.run import Coupled, OutOfTime, Run, until
from lacore.coupling.soil_search import SEARCHES, SoilFound, soil_bounds, soil_states
from lacore.limit.outcome import Times, outcome_of
from lacore.limit.solve import limit_state, solve
from lacore.limit.state import LimitState
from lacore.model.problem.problem import Problem
from lacore.program.kinematic import KinematicProgram, dimensionless
from lacore.reporting.errors import InputError, is_number, require_positive, typed
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Status
from lacore.reporting.text import Term, text
from lacore.solvers.backend import Backend, check_capable, read_options
from lacore.solvers.compilation import SolveClock
from lacore.solvers.inner.preparing import preparer, require_exact
from lacore.solvers.inner.rescaling import good_for

SHARES = (1.0, 0.6, 0.3)
"""Shares of the friction of a soil at the starts of searches.

Their load factors differ widely, from 2 to 32 for a footing of 30 degrees, and lead to much closer
limit states (T59).
"""
_AIM = 1e-6  # residual at which a search stops
_MOST = 120  # limit of solves of a search, which usually ends earlier
_BEYOND = 1e-6  # by the associated load factor: round-off of two solves
_COLUMNS = ["share", "search", "status", "load_factor", "residual", "gap", "solves", "seconds"]


@typed()
def soil_range(
    problem: Problem | Discretisation,
    backend: str = "auto",
    *,
    shares: tuple[float, ...] = SHARES,
    tolerance: float = 5e-5,
    time_limit: float = 600.0,
    options: Mapping[str, Any] | None = None,
    on_progress: Callable[[Mapping[str, Any]], None] | None = None,
) -> LoadFactorRange:
    """Search for low and high load factors of soils with non-associated flow (T57, T59).

    There are two searches from each start: one converges near it, the other first moves to lower
    loads. Each takes as long as 20 to 80 solves with associated flow.

    A row of `LoadFactorRange.states` is a search: the ``share`` of the friction at its start,
    ``search`` (``settled`` by S-steps, ``drifted`` by K-steps first), ``status``, ``load_factor``,
    the largest ``residual``, the ``gap``, ``solves``, ``seconds`` since the beginning.

    Args:
        problem: the problem, or its discretisation.
        backend: name of an exact backend.
        shares: shares of the friction of soils at the starts of searches, each in (0, 1].
        tolerance: tolerance for the residuals of every state, by the dissipated power; a search
            continues to 1e-6 if possible. A gap is the average lack of mobilised friction over the
            dissipation (T53), not the distance to other load factors.
        time_limit: s, wall clock, from the beginning: searches stop at the first inner solve that
            ends after it, with their present results.
        options: options of the backend, by name.
        on_progress: called with the row of each search as it ends.

    Raises:
        InputError: no soil with non-associated flow; shares or a tolerance out of range.
        CapabilityError: the backend is missing, regularised, or does not support the problem.

    Example:
        >>> sand = la.MohrCoulomb(cohesion=1.0, friction_angle=30.0, dilation_angle=0.0)
        >>> square = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2)
        >>> pressed = la.Problem(
        ...     bodies={"sand": la.Body(square, sand, space="p2-gauss")},
        ...     supports=[la.Fix("sand", "left", "x"), la.Fix("sand", "bottom", "y")],
        ...     reference_loads=[la.Pressure("sand", "top")],
        ... )
        >>> found = la.soil_range(pressed)
        >>> round(found.high, 3)  # 2 c cos(phi)/(1 - sin(phi)), whatever the dilation
        3.464
    """
    begin, clock = time.perf_counter(), SolveClock()
    engine = _checked(backend, shares, tolerance, time_limit)
    if not isinstance(problem, Discretisation):
        problem = discretise(problem)
    program = dimensionless(problem.program, problem.natural)
    _check_flow(program)
    check_capable(engine, program)
    built = time.perf_counter() - begin
    found = _searched(
        problem, program, engine, options or {}, shares, tolerance, begin, time_limit, on_progress
    )
    given: dict[str, Any] = {"backend": backend, "options": options}
    made = [
        _state(problem, program, own, built, given, tolerance)
        for own, _ in sorted(found.ends, key=lambda end: end[1])
    ]
    without = NoState(Status.TIME_LIMIT)
    if not made and found.stop is None:
        without = _why(problem, given)
    unsafe = not made and without.status is Status.UNSAFE
    states = pd.DataFrame(found.rows, columns=_COLUMNS)
    return range_of(
        made,
        without,
        SearchRecord(
            kind=RangeKind.SOIL,
            scope=problem.scope,
            # No load factor exists, whatever bounds with more strength give.
            bracket=(-np.inf, np.inf) if unsafe else found.bracket,
            states=states,
            certified=len(found.ends),
            backend=backend,
            tolerance=tolerance,
            settings={"shares": shares},
            solves=int(states["solves"].sum()),
            davis=_davis(problem, given),
            solve_time=clock.seconds,
            stop=found.stop,
        ),
    )


def _checked(
    backend: str, shares: tuple[float, ...], tolerance: float, time_limit: float
) -> Backend:
    """Return the backend after checks that need no problem."""
    require_positive("tolerance", tolerance)
    require_positive("time_limit", time_limit)
    listed = isinstance(shares, Sequence) and len(shares) > 0
    if not listed or not all(is_number(share) and 0 < share <= 1 for share in shares):
        raise InputError("shares", shares, "not numbers in (0, 1]", "give (1.0, 0.6, 0.3)")
    return require_exact(backend, "a load factor")


def _check_flow(program: KinematicProgram) -> None:
    """Raise `InputError` where the flow of all bodies is associated."""
    if not program.frictional:
        raise InputError(
            "problem",
            None,
            "flow of all bodies is associated, and its load factor is unique",
            text(
                "give a soil a dilation_angle below its friction_angle; or {}",
                Term(
                    "take lacore.solve, and lacore.coulomb_range for friction of interfaces",
                    "leave --range out",
                ),
            ),
        )


@dataclass(frozen=True)
class _CertifiedSearches:
    """Results of searches.

    Attributes:
        ends: ends of certified searches, with their load factors in SI units.
        bracket: proven bounds of all load factors of the discrete problem (T54), SI units.
        rows: one row per search.
        stop: why not all of them reached their ends; None if they did.
    """

    ends: list[tuple[SoilFound, float]]
    bracket: tuple[float, float]
    rows: list[dict[str, Any]]
    stop: Finding | None


def _searched(
    problem: Discretisation,
    program: KinematicProgram,
    engine: Backend,
    options: Mapping[str, Any],
    shares: tuple[float, ...],
    tolerance: float,
    begin: float,
    time_limit: float,
    on_progress: Callable[[Mapping[str, Any]], None] | None,
) -> _CertifiedSearches:
    """Search from each share of the friction."""
    scale = problem.natural.load_factor
    aims = CouplingOptions(tolerance=min(_AIM, tolerance), max_iterations=_MOST, accepted=tolerance)
    rows: list[dict[str, Any]] = []
    ends: list[tuple[SoilFound, float]] = []
    stop = None
    prepare = preparer(engine, read_options(engine, options), good_for(aims.tolerance))
    with closing(prepare(program.associated())) as solver:
        run = Run(program, solver, False, aims, lambda _: None, prepare)
        low, high = soil_bounds(run)
        bracket = (low * scale, high * scale)
        limited = replace(run, on_iterate=until(begin + time_limit))
        try:
            for found in soil_states(limited, tuple(map(float, shares))):
                rows.append(_row(found, scale, bracket[1], time.perf_counter() - begin))
                if rows[-1]["status"] == "certified":
                    ends.append((found, rows[-1]["load_factor"]))
                if on_progress is not None:
                    on_progress(rows[-1])
        except OutOfTime:
            every = len(shares) * len(SEARCHES)
            values = {"limit": float(time_limit), "done": len(rows), "every": every}
            stop = Finding(Kind.STOPPED_AFTER_SEARCHES, values=values)
    return _CertifiedSearches(ends, bracket, rows, stop)


def _row(found: SoilFound, scale: float, above: float, seconds: float) -> dict[str, Any]:
    final, status = found.final, "not certified"
    point, certificate = (None, None) if final is None else (final.state, final.certificate)
    alpha = np.nan if point is None else point.load_factor * scale
    if found.start.inner.point is None:
        status = found.start.inner.status.label
    elif point is not None and not alpha <= above + _BEYOND * abs(above):
        # No admissible stresses carry so much (T54), so this is an error of ours.
        status = "refused"
    elif certificate is not None:
        status = "certified"
    return {
        "share": found.share,
        "search": found.search,
        "status": status,
        "load_factor": alpha if status == "certified" else np.nan,
        "residual": np.nan if certificate is None else certificate.worst[1],
        "gap": np.nan if certificate is None else certificate.gap,
        "solves": len(found.iterates),
        "seconds": seconds,
    }


def _state(
    problem: Discretisation,
    program: KinematicProgram,
    found: SoilFound,
    build_time: float,
    given: Mapping[str, Any],
    tolerance: float,
) -> LimitState:
    """Return the end of a search as a state of its problem."""
    assert found.final is not None
    iterates = (found.start, *found.iterates)
    coupled = Coupled(Status.SOLVED, iterates, found.final, tolerance=tolerance)
    times = Times(build_time, float(sum(one.inner.solve_time for one in iterates)))
    outcome = outcome_of(problem, program, coupled, CERTIFIED, times)
    return limit_state(outcome, given["backend"], given["options"] or {})


def _why(problem: Discretisation, given: Mapping[str, Any]) -> NoState:
    """Return why there is no state: LOCKED or UNSAFE if that is proven, with the proof."""
    state = solve(problem, **given)
    solved = state.status is Status.SOLVED
    return NoState(Status.NOT_CERTIFIED if solved else state.status, ray=state.ray)


def _davis(problem: Discretisation, given: Mapping[str, Any]) -> float:
    """Return the load factor with Davis's strength; NaN if cones are not planes of slip alone."""
    if not all(group.sliding for group in problem.program.groups if group.frictional):
        return float("nan")
    return solve(problem, coupling="davis", **given).load_factor
