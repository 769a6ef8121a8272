"""Run of a limit problem with its verdict."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import nan
from typing import Any

import numpy as np

import lacore as la
from lacore.coupling.run import CENTRAL_PATH
from lacore.limit.solve import solve
from lacore.reporting.findings import stored
from lacore.solvers.registry import PROVING_BACKEND
from lacore_verification.case import Band, Reference
from lacore_verification.defaults import RAW
from lacore_verification.harness.evidence.limit_state import evidence_of
from lacore_verification.harness.verdicts.allowed import about, distance
from lacore_verification.harness.verdicts.limit_state import MODELS, judge, refutation
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.row import Row
from lacore_verification.runs.run import Run


def run_limit_state(
    run: Run,
    names: Mapping[str, Any],
    discretisation: la.Discretisation,
    reference: Reference,
    band: Band,
    time_limit: float | None,
    memory: Callable[[], float],
) -> Outcome:
    """Return the row of a limit problem, and its state.

    Args:
        run: the run.
        names: columns that are known already.
        discretisation: of its problem.
        reference, band: of its load factor.
        time_limit: s, of each inner solve, if the backend supports it.
        memory: peak memory of this process, MB.

    Raises:
        InputError: a setting or an option does not exist.
        CapabilityError: the backend does not support it.
    """
    coupling, settings = RAW.get(run.coupling or "", (run.coupling, {}))
    limit = shorter_limit(run.backend, time_limit)
    state = solve(
        discretisation,
        backend=run.backend,
        coupling=coupling,
        **{**settings, **run.settings},
        options={**limit, **run.options},
    )
    evidence = evidence_of(state)
    refuted = refutation(claims_success(state), evidence.residuals)
    verdict, why = judge(state, reference, band, run.insist, refuted)
    if state.coupling == "associated" and reference.associated is not None:
        reference = reference.of_associated()
    names = {
        **names,
        **about(reference),
        **_standing(state),
        "coupling": run.coupling or state.coupling,
        "model": MODELS.get(state.coupling, ""),
        "error": distance(state.load_factor, reference, band),
        # The maximum of both processes.
        "peak_memory_mb": float(np.fmax(state.peak_memory, memory())),
        "verdict": verdict,
        "why": why,
    }
    return Outcome(run, _row(names, state), evidence)


def _standing(state: la.LimitState) -> dict[str, Any]:
    """Return the columns of the stability of a state; that of exact backends represents all.

    It is a property of the problem, proven by its residuals: one exact backend computes it for all.
    """
    if la.find_backend(state.backend).capabilities.regularised:
        return {}
    found = replace(state, backend=PROVING_BACKEND, options={}).stability()
    return {
        "standing": found.standing.label,
        "side": found.side,
        "carried_low": found.low,
        "carried_high": found.high,
    }


def _row(names: Mapping[str, Any], state: la.LimitState) -> Row:
    values = state.regularised
    return Row(
        **names,
        load_factor=state.load_factor,
        answered_by=state.answered_by,
        rigor=state.rigor.label,
        upper=state.load_factor if state.rigor is la.Rigor.UPPER else nan,
        status=state.status.label,
        outer_iterations=state.outer_iterations,
        gap=state.certificate.gap if state.certificate else nan,
        solve_time=state.solve_time,
        message=state.message,
        findings=stored(state.findings),
        alpha_reg=values.alpha_reg if values else nan,
        regularised_lambda=values.load_factor if values else nan,
        P=values.plastic if values else nan,
        energy=values.energy if values else nan,
        contraction=state.contraction,
        iterations=float(state.history["inner_iterations"].sum()),
        claimed=claims_success(state),
        **_times(state),
    )


def _times(state: la.LimitState) -> dict[str, Any]:
    """Return the times of the inner solves: measured here, and reported by the backend."""
    own = state.history[state.history["kind"] != CENTRAL_PATH]
    reported = own["reported_time"].fillna(own["solve_time"])  # In this process they are equal.
    return {
        "solver_time": float(own["solve_time"].sum()),
        "reported_time": float(reported.sum()),
    }


def claims_success(state: la.LimitState) -> bool:
    """Return whether the solver itself reported its last inner solve as solved."""
    return bool(state.history["inner_status"].iloc[-1] == la.Status.SOLVED.label)


def shorter_limit(backend: str, time_limit: float | None) -> dict[str, float]:
    """Return options that limit a solve to the time of its run, unless its limit is shorter.

    Args:
        backend: Its name.
        time_limit: Of the run, s; None: there is none.

    Raises:
        CapabilityError: The backend cannot be loaded or run here.
    """
    own = float(la.find_backend(backend).Options().time_limit)
    return {} if time_limit is None else {"time_limit": min(own, time_limit)}
