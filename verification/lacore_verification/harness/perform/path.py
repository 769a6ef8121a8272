"""Run of a path: one row, with the largest errors along it."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from math import nan
from typing import Any

import numpy as np
import pandas as pd

import lacore as la
from lacore.bounds.enclosing import associated
from lacore.model.bodies.continuum.spaces import BOUNDING
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError
from lacore.solvers.compilation import SolveClock
from lacore_verification.case import Band, Reference
from lacore_verification.case.following import Following
from lacore_verification.harness.evidence.limit_state import records
from lacore_verification.harness.evidence.path import packed_step
from lacore_verification.harness.perform.limit_state import claims_success, shorter_limit
from lacore_verification.harness.verdicts.allowed import distance
from lacore_verification.harness.verdicts.path import exact_loads, judge_path, largest_error, worst
from lacore_verification.runs.outcome import Evidence, Outcome
from lacore_verification.runs.row import Row
from lacore_verification.runs.run import Run

_TAKEN = ("tolerance",)  # Settings of `lacore.solve` that `lacore.sequential` supports.


def run_path(
    run: Run,
    names: Mapping[str, Any],
    discretisation: la.Discretisation,
    reference: Reference,
    band: Band,
    time_limit: float | None,
    memory: Callable[[], float],
) -> Outcome:
    """Return the row of a path: its load factor is that of the last step.

    Args:
        run: the run.
        names: columns that are known already.
        discretisation: of the initial problem of the path.
        reference, band: of the load factor.
        time_limit: s, of each inner solve, if its backend supports it.
        memory: peak memory of this process, MB.

    Raises:
        InputError: the problem has no path.
        CapabilityError: the backend does not support hardening.
    """
    stated = run.case.following_of(run.variant)
    for name in run.settings:
        if name not in _TAKEN:
            raise InputError(f"setting {name}", None, "paths do not take it", "leave it out")
    clock = SolveClock()
    path = la.sequential(
        stated.problem(discretisation.problem),
        stated.travel,
        stated.steps,
        stated.scheme,
        stated.control,
        approaching=stated.approaching,
        tools=stated.tools,
        remesh=stated.remesh,
        backend=run.backend,
        coupling=run.coupling,
        options={**shorter_limit(run.backend, time_limit), **run.options},
        **run.settings,
    )
    seconds = clock.seconds
    history = path.history
    loads = _numbers(history, stated.load)
    load = float(loads[-1]) if loads.size else nan
    exact = exact_loads(stated, _numbers(history, "travel"))
    state = path.last
    solved = la.Status.SOLVED if state is not None else la.Status.NOT_CERTIFIED
    row = Row(
        **{**names, "coupling": run.coupling or (state.coupling if state else "")},
        load_factor=load,
        error=distance(load, reference, band),
        rigor=(la.Rigor.DISCRETE if state else la.Rigor.NOT_CERTIFIED).label,
        status=solved.label,
        outer_iterations=int(history["solves"].sum()),
        gap=worst(_numbers(history, "gap")),
        solve_time=seconds,
        peak_memory_mb=memory(),
        message=path.message,
        energy=state.regularised.energy if state is not None and state.regularised else nan,
        ending=path.status.label,
        claimed=state is not None and claims_success(state),
        answered_by=state.answered_by if state is not None else "",
        path_error=largest_error(loads, exact),
        volume_change=_volume_change(path),
        reading=nan if stated.reading is None else stated.reading.of(path),
    )
    if stated.bounded:
        lower, upper = start_bounds(discretisation.problem)
        row = replace(row, lower=lower, upper=upper, start=_start(run, stated, discretisation))
    verdict, why = judge_path(row, stated, reference, band, run.insist)
    row = replace(row, verdict=verdict, why=why)
    residuals = asdict(state.certificate) if state is not None and state.certificate else {}
    arrays = b"" if state is None else packed_step(state, path.snapshots[-1], path.later)
    return Outcome(run, row, Evidence(residuals, records(history.assign(exact=exact)), arrays))


def start_bounds(problem: la.Problem) -> tuple[float, float]:
    """Return strict bounds of the load with which a path begins (T14).

    The lower one has no friction, the upper one associated friction; stick is unchanged.
    """
    bodies = {
        name: replace(body, space=BOUNDING) if isinstance(body, la.Body) else body
        for name, body in problem.bodies.items()
    }
    above = associated(replace(problem, bodies=bodies))
    pairs = [
        replace(pair, friction=la.SMOOTH) if pair.law.terms().coefficient > 0 else pair
        for pair in problem.interfaces
    ]
    below = replace(problem, bodies=bodies, interfaces=pairs)
    return la.lower_bound(below).load_factor, la.upper_bound(above).load_factor


def _start(run: Run, stated: Following, discretisation: la.Discretisation) -> float:
    """Return the load factor with which the path begins, on its own elements."""
    first = la.sequential(
        stated.problem(discretisation.problem),
        stated.travel / stated.steps,
        1,
        "explicit",
        stated.control,
        approaching=stated.approaching,
        tools=stated.tools,
        backend=run.backend,
        coupling=run.coupling,
    )
    return float(first.history["load_factor"].iloc[0]) if len(first.history) else nan


def _volume_change(path: la.Path) -> float:
    """Return the largest relative change of volume in a step."""
    volumes = _numbers(path.history, "volume")
    start = sum(
        float(dofs.weights.sum())
        for dofs in la.discretise(path.stage.at(path.stage.start)).continua.values()
    )
    before = np.concatenate([[start], volumes])[:-1]
    return float(np.abs(volumes / before - 1).max()) if volumes.size else nan


def _numbers(history: pd.DataFrame, name: str) -> Floats:
    """Return a column as numbers; without rows it would have objects."""
    return history[name].to_numpy(dtype=float)
