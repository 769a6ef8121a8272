"""Follow a case along its path: one row, with the worst that happened on the way."""

import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from math import inf, isnan, nan
from typing import Any

import numpy as np
import pandas as pd

import lacore as la
from lacore.arrays import Floats
from lacore.bounds.enclosing import associated
from lacore.errors import InputError
from verification.allowed import allowed_values
from verification.case import SOLVER, Band, Reference
from verification.evidence import records
from verification.following import Following
from verification.judging import (
    FAIL,
    NO_REFERENCE,
    NO_RESULT,
    PASS,
    STRONG,
    cannot_judge,
    distance,
)
from verification.path_evidence import packed_step
from verification.run import Evidence, Outcome, Row, Run

_TAKEN = ("tolerance",)  # settings of `lacore.solve` that `lacore.sequential` takes


def run_path(
    run: Run,
    names: Mapping[str, Any],
    discretisation: la.Discretisation,
    reference: Reference,
    band: Band,
    time_limit: float | None,
    memory: Callable[[], float],
) -> Outcome:
    """The row of a path: its load factor is that of the last step.

    Args:
        run: to be done.
        names: columns that are known already.
        discretisation: of the problem where the path begins.
        reference, band: of the load factor.
        time_limit: s, of each inner solve, as far as its backend keeps it.
        memory: peak memory of this process, MB.

    Raises:
        InputError: what no path can be made of.
        CapabilityError: the backend takes no hardening.
    """
    stated = run.case.following_of(run.variant)
    for name in run.settings:
        if name not in _TAKEN:
            raise InputError(f"setting {name}", None, "paths do not take it", "leave it out")
    begin = time.perf_counter()
    path = la.sequential(
        discretisation.problem,
        stated.travel,
        stated.steps,
        stated.scheme,
        stated.control,
        approaching=stated.approaching,
        backend=run.backend,
        coupling=run.coupling,
        options={**({} if time_limit is None else {"time_limit": time_limit}), **run.options},
        **run.settings,
    )
    seconds = time.perf_counter() - begin
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
        gap=_worst(_numbers(history, "gap")),
        solve_time=seconds,
        peak_memory_mb=memory(),
        message=path.message,
        energy=state.regularised.energy if state is not None and state.regularised else nan,
        ending=path.status.label,
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
    arrays = b"" if state is None else packed_step(state, path.snapshots[-1])
    return Outcome(run, row, Evidence(residuals, records(history.assign(exact=exact)), arrays))


def start_bounds(problem: la.Problem) -> tuple[float, float]:
    """Strict bounds of the load with which a path begins (T14).

    No friction from below, associated friction from above; sticking is what it is.
    """
    bodies = {
        name: replace(body, space="p2-vertex")
        for name, body in problem.bodies.items()
        if isinstance(body, la.Body)
    }
    above = associated(replace(problem, bodies=bodies))
    pairs = [
        replace(pair, friction=la.SMOOTH) if pair.law.terms().coefficient > 0 else pair
        for pair in problem.interfaces
    ]
    below = replace(problem, bodies=bodies, interfaces=pairs)
    return la.lower_bound(below).load_factor, la.upper_bound(above).load_factor


def _start(run: Run, stated: Following, discretisation: la.Discretisation) -> float:
    """Load factor with which the path begins, on its own elements."""
    first = la.sequential(
        discretisation.problem,
        stated.travel / stated.steps,
        1,
        "explicit",
        stated.control,
        approaching=stated.approaching,
        backend=run.backend,
        coupling=run.coupling,
    )
    return float(first.history["load_factor"].iloc[0]) if len(first.history) else nan


def exact_loads(stated: Following, travel: Floats) -> Floats:
    """Exact loads at travels; NaN where they are not known."""
    if stated.exact is None:
        return np.full(travel.shape, nan)
    return np.array([stated.exact(float(at)) for at in travel])


def judge_path(
    row: Row, stated: Following, reference: Reference, band: Band, insist: bool = True
) -> tuple[str, str]:
    """Verdict on a path, and why: its end, its last load, its worst load, its volume.

    Loads of regularised backends may be off by their energy C (T19) on top, to either side: their
    bodies have strained a little more or less on the way. They keep volumes to their penalties.
    What is asked for and is NaN is wrong. Without a reference a path that is right passes nothing.
    """
    if why := cannot_judge(reference, band):
        return FAIL, why
    if stated.ending is not None and row.ending != stated.ending.label:
        wanted = f"not '{stated.ending.label}' as it must"
        return FAIL if insist else NO_RESULT, f"the path ends {wanted}: {row.message}"
    regularised = not isnan(row.energy)
    if regularised:
        more = max(row.energy, 0.0) / (abs(row.load_factor) or nan)
        if not more <= STRONG:
            why = f"regularisation too strong to judge: C is {100 * more:.3g} % of the last load"
            return FAIL if insist else NO_RESULT, why
        band = replace(band, below=band.below + more, above=band.above + more)
    allowed, largest = allowed_values(reference, band), max(band.below, band.above)
    found: list[str] = [row.ending]
    wrong: list[str] = []
    if not reference.unknown:
        inside = allowed.holds(row.load_factor)
        (found if inside else wrong).append(
            f"last load {row.load_factor:.7g} {'in' if inside else 'not in'} {allowed}"
        )
    if stated.exact is not None:
        text = f"largest error on the way {row.path_error:.3g}, {largest:.3g} allowed"
        (found if 0 <= row.path_error <= largest else wrong).append(text)
    if stated.volume != inf and not regularised:
        text = f"volume changes by {row.volume_change:.2g} a step, {stated.volume:g} allowed"
        (found if 0 <= row.volume_change <= stated.volume else wrong).append(text)
    if stated.reading is not None:
        read = stated.reading
        inside = read.low <= row.reading <= read.high
        text = f"{read.name} {row.reading:.4g}, [{read.low:.4g}, {read.high:.4g}] allowed"
        (found if inside else wrong).append(text)
    if stated.bounded:
        slack = SOLVER * row.upper + (max(row.energy, 0.0) if regularised else 0.0)
        inside = -inf < row.lower - slack <= row.start <= row.upper + slack < inf
        text = f"begins at {row.start:.5g}, bounds are [{row.lower:.5g}, {row.upper:.5g}]"
        (found if inside else wrong).append(text)
    if wrong:
        return FAIL, "; ".join(wrong)
    if reference.unknown:
        return NO_REFERENCE, "; ".join([*found, "there is no last load to compare with"])
    return PASS, "; ".join(found)


def largest_error(loads: Floats, exact: Floats) -> float:
    """Relative, over the exact loads that are known; NaN without any, or where a load is none."""
    known = ~np.isnan(exact)
    loads, exact = loads[known], exact[known]
    with np.errstate(divide="ignore", invalid="ignore"):
        errors = np.where(loads == exact, 0.0, np.abs(loads / exact - 1))
    return _worst(errors)


def _worst(values: Floats) -> float:
    """The largest; NaN where one is, or there is none."""
    return float(values.max()) if values.size else nan


def _volume_change(path: la.Path) -> float:
    """Largest change of volume of a step, of the volume before."""
    volumes = _numbers(path.history, "volume")
    start = sum(
        float(dofs.weights.sum())
        for dofs in la.discretise(path.stage.at(path.stage.start)).bodies.values()
    )
    before = np.concatenate([[start], volumes])[:-1]
    return float(np.abs(volumes / before - 1).max()) if volumes.size else nan


def _numbers(history: pd.DataFrame, name: str) -> Floats:
    """A column; of no rows it would be one of objects."""
    return history[name].to_numpy(dtype=float)
