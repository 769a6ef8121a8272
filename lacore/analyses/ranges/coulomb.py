"""`coulomb_range`: the lowest and the highest certified Coulomb load factor (T14b)."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from lacore.analyses.ranges.continuum import continuum_range
from lacore.analyses.ranges.load_factors import (
    LoadFactorRange,
    NoState,
    RangeKind,
    SearchRecord,
    about,
    range_of,
)
from lacore.assembly.discretisation import Discretisation
from lacore.assembly.discretise import discretise
from lacore.coupling.kinds import CERTIFIED
from lacore.coupling.run import Coupled, OutOfTime, until
from lacore.coupling.search import HIGH, LOW, CertifiedMechanism, Search, coulomb_bounds
from lacore.limit.conversion import point_in_program
from lacore.limit.judges.driven_corners import driven_corners
from lacore.limit.outcome import Times, outcome_of
from lacore.limit.solve import limit_state, solve
from lacore.limit.state import LimitState
from lacore.model.problem.problem import Problem
from lacore.program.kinematic import dimensionless
from lacore.reporting import terms
from lacore.reporting.errors import InputError, require_positive, require_whole, typed
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import listed
from lacore.reporting.status import Scope, Status
from lacore.reporting.text import text
from lacore.solvers.backend import Backend, read_options
from lacore.solvers.compilation import SolveClock
from lacore.solvers.inner.preparing import preparer, require_exact
from lacore.solvers.inner.rescaling import good_for

_SEARCHED = (Status.SOLVED, Status.NOT_CERTIFIED, Status.JAM)
_COLUMNS = ["restart", "origin", "low", "high", "low_end", "high_end", "residual", "solves"]


@typed()
def coulomb_range(
    problem: Problem | Discretisation,
    backend: str = "auto",
    *,
    seed: int = 0,
    restarts: int = 8,
    tolerance: float = 1e-6,
    target_width: float | None = None,
    time_limit: float = 600.0,
    options: Mapping[str, Any] | None = None,
    on_progress: Callable[[Mapping[str, Any]], None] | None = None,
) -> LoadFactorRange:
    """Search for the lowest and the highest Coulomb load factor (T14b).

    A row of `LoadFactorRange.states` is a certified state: its ``restart``, its ``origin`` (the
    reactions at the start of its loop: of the ``certified`` state of `solve`, the ``associated``
    one, a ``continuation`` in friction, the ``low end`` or ``high end`` of the last state; or of a
    central ``path`` of three-dimensional blocks), ``low`` and ``high`` load factor of its
    mechanism, the status of each end (`EndStatus`), the largest ``residual`` of both ends,
    ``solves`` so far.

    Args:
        problem: the problem, or its discretisation.
        backend: name of an exact backend.
        seed: seed of random changes of reactions; the same seed finds the same states.
        restarts: number of further searches from changed reactions, after the one from those of the
            associated problem; for three-dimensional blocks each follows three central paths (T79).
        tolerance: tolerance for the residuals of every state.
        target_width: value of ``(upper - lower)/mean`` for the bounds of the continuum, on separate
            refined meshes, see `lacore.bracket`. None: bounds on the mesh of the problem.
        time_limit: s, wall clock, from the beginning: the search stops at the first inner solve
            that ends after it, with its present results.
        options: options of the backend, by name.
        on_progress: called with the row of each certified state as it is found.

    Raises:
        InputError: an unknown name, an option out of range; a target width for a problem that
            `lacore.bracket` rejects.
        CapabilityError: the backend is missing, regularised, or does not support the problem.

    Example:
        >>> found = la.coulomb_range(la.examples.column(friction=0.3))
        >>> round(found.low, 3), round(found.high, 3)
        (0.3, 0.3)
    """
    require_whole("seed", seed)
    require_whole("restarts", restarts)
    require_positive("tolerance", tolerance)
    require_positive("time_limit", time_limit)
    engine = require_exact(backend, "a Coulomb load factor")
    begin, clock = time.perf_counter(), SolveClock()
    if not isinstance(problem, Discretisation):
        problem = discretise(problem)
    _check_flow(problem)
    continuum = None
    if problem.scope is Scope.DISCRETE:
        continuum = continuum_range(problem, backend, options or {}, target_width)
    first = solve(problem, backend, CERTIFIED, tolerance=tolerance, options=options)
    problem = first.discretisation  # with the nodes at which members under line loads hinge
    limits = _Limits(seed, restarts, tolerance, time_limit, begin + time_limit)
    found = _searched(first, engine, read_options(engine, options or {}), limits, on_progress)
    ends = _ends(found, first, backend, options or {}, tolerance, clock)
    refused = [end for end in ends if end.status is not Status.SOLVED]
    first, ends = (refused[0], []) if refused else (first, ends)
    bracket = _with_known(found.bracket, first)
    if ends:
        bracket = about(bracket, ends[0].load_factor, ends[-1].load_factor)
    return range_of(
        ends,
        _without(first),
        SearchRecord(
            kind=RangeKind.COULOMB,
            scope=problem.scope,
            bracket=bracket,
            states=pd.DataFrame(found.rows, columns=_COLUMNS),
            certified=len(found.rows),
            backend=backend,
            tolerance=tolerance,
            settings={"restarts": restarts, "seed": seed},
            solves=found.solves + len(first.history) + 2,
            solve_time=clock.seconds,
            stop=found.stop,
            continuum=None if continuum is None else (continuum.lower, continuum.upper),
            unbounded=() if continuum is None else continuum.missing,
        ),
    )


def _check_flow(problem: Discretisation) -> None:
    """Raise `InputError` where the flow of a soil is not associated."""
    if problem.program.frictional:
        raise InputError(
            "problem",
            listed([group.name for group in problem.program.groups if group.frictional]),
            "flow of a soil is not associated: what it carries is looked for in other ways",
            text("take {}", terms.SOIL_RANGE),
        )


@dataclass(frozen=True)
class _Limits:
    """Limits of a search; `end` is a time of `time.perf_counter`."""

    seed: int
    restarts: int
    tolerance: float
    time_limit: float
    end: float


@dataclass(frozen=True)
class _Mechanisms:
    """Results of a search.

    Attributes:
        best: the mechanism that reaches furthest on each side.
        bracket: proven bounds of all load factors (T14), SI units.
        rows: one row per certified state.
        solves: number of inner solves.
        stop: why it ended early; None if it did not.
    """

    best: Mapping[float, CertifiedMechanism]
    bracket: tuple[float, float]
    rows: list[dict[str, Any]]
    solves: int
    stop: Finding | None


def _searched(
    first: LimitState,
    engine: Backend,
    settings: Any,
    limits: _Limits,
    on_progress: Callable[[Mapping[str, Any]], None] | None,
) -> _Mechanisms:
    """Search from the state of `solve`, and from associated reactions."""
    problem, tolerance = first.discretisation, limits.tolerance
    program, scale = dimensionless(problem.program, problem.natural), problem.natural.load_factor
    rows: list[dict[str, Any]] = []
    stop = None

    def note(found: CertifiedMechanism) -> None:
        rows.append(_row(found, scale) | {"solves": search.solves})
        if on_progress is not None:
            on_progress(rows[-1])

    prepare = preparer(engine, settings, good_for(tolerance))
    with closing(prepare(program)) as solver:
        bounds, admissible = coulomb_bounds(program, solver, tolerance)
        if first.status is Status.UNSAFE:
            bounds = (-np.inf, np.inf)  # A locked program has no load factor.
        if driven_corners(problem, None, tolerance):
            # Contact at corners, which is not in the program, may carry more.
            bounds = (bounds[0], np.inf)
        search = Search(
            program=program,
            solver=solver,
            prepare=prepare,
            tolerance=tolerance,
            bounds=bounds,
            rng=np.random.default_rng(limits.seed),
            on_found=note,
            on_solve=until(limits.end),
            seconds=lambda: min(settings.time_limit, limits.end - time.perf_counter()),
        )
        known = None if first.point is None else point_in_program(problem, first.point)
        start = known if admissible is None else admissible
        if first.status in _SEARCHED and start is not None:
            certified = known if first.status is Status.SOLVED else None
            try:
                search.run(certified, start, limits.restarts)
            except OutOfTime:
                stop = _out_of_time(limits, rows)
    bracket = bounds[0] * scale, bounds[1] * scale
    return _Mechanisms(search.best, bracket, rows, search.solves, stop)


def _out_of_time(limits: _Limits, rows: list[dict[str, Any]]) -> Finding:
    done = rows[-1]["restart"] if rows else 0
    values = {"limit": float(limits.time_limit), "done": done, "every": limits.restarts}
    return Finding(Kind.STOPPED_IN_RESTART, values=values)


def _ends(
    found: _Mechanisms,
    first: LimitState,
    backend: str,
    options: Mapping[str, Any],
    tolerance: float,
    clock: SolveClock,
) -> list[LimitState]:
    """Return the lowest and the highest state with certificates; empty if nothing is certified."""
    problem = first.discretisation
    program, scale = dimensionless(problem.program, problem.natural), problem.natural.load_factor
    ends = []
    for side in (LOW, HIGH) if found.best else ():
        own = found.best[side]
        end = own.end(side)
        last = replace(own.iterates[-1], state=end.point, certificate=end.certificate)
        coupled = Coupled(Status.SOLVED, own.iterates, last, tolerance=tolerance)
        times = Times(first.build_time, clock.seconds)
        outcome = outcome_of(problem, program, coupled, CERTIFIED, times)
        load_factor = _outward(side, end.load_factor * scale, first)
        ends.append(limit_state(outcome, backend, options, load_factor))
    return ends


def _without(first: LimitState) -> NoState:
    """Return the report for a range without certified states."""
    solved = first.status is Status.SOLVED
    return NoState(Status.NOT_CERTIFIED if solved else first.status, first.findings, first.ray)


def _row(found: CertifiedMechanism, scale: float) -> dict[str, Any]:
    lower, upper = found.interval.lower, found.interval.upper
    return {
        "restart": found.restart,
        "origin": found.origin,
        "low": lower.load_factor * scale,
        "high": upper.load_factor * scale,
        "low_end": lower.status.label,
        "high_end": upper.status.label,
        "residual": max(lower.certificate.worst[1], upper.certificate.worst[1]),
    }


def _outward(side: float, load_factor: float, first: LimitState) -> float:
    """Return an end, no closer by round-off than the certified state at which the search began."""
    if first.status is not Status.SOLVED:
        return load_factor
    return side * max(side * load_factor, side * first.load_factor)


def _with_known(bracket: tuple[float, float], first: LimitState) -> tuple[float, float]:
    """Return the bounds combined with those of the first solve, if it searched for a state."""
    if first.bracket is None or first.status not in _SEARCHED:
        return bracket
    return max(bracket[0], first.bracket[0]), min(bracket[1], first.bracket[1])
