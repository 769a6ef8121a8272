"""Search for low and high load factors of soils with non-associated flow, with verdicts."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from math import nan
from typing import Any

import lacore as la
from lacore_verification.case import Band, Reference
from lacore_verification.harness.evidence.limit_state import packed, records
from lacore_verification.harness.verdicts.ranging import judge_range
from lacore_verification.runs.outcome import NO_EVIDENCE, Evidence, Outcome
from lacore_verification.runs.row import Row
from lacore_verification.runs.run import Run


def run_range(
    run: Run,
    names: Mapping[str, Any],
    discretisation: la.Discretisation,
    reference: Reference,
    band: Band,
    memory: Callable[[], float],
) -> Outcome:
    """Return the row of a range, with residuals of both ends, and the state of the lower one.

    Args:
        run: the run.
        names: columns that are known already.
        discretisation: of its problem.
        reference, band: of its load factors.
        memory: peak memory of this process, MB.

    Raises:
        InputError: flow is associated, the backend is regularised, or an option does not exist.
        CapabilityError: the backend does not support it.
    """
    found = la.soil_range(discretisation, run.backend, options=run.options)
    evidence, rigor = NO_EVIDENCE, ""
    if found.lowest is not None and found.highest is not None:
        evidence = _evidence(found, found.lowest, found.highest)
        rigor = found.lowest.rigor.label
    row = Row(
        **names,
        rigor=rigor,
        lowest=found.low,
        highest=found.high,
        lower=found.bracket[0],
        upper=found.bracket[1],
        davis=found.davis,
        gap=evidence.residuals.get("gap", nan),
        status=found.status.label,
        outer_iterations=float(found.solves),
        solve_time=found.solve_time,
        peak_memory_mb=memory(),
        message=found.message,
    )
    verdict, why = judge_range(row, reference, band)
    return Outcome(run, replace(row, verdict=verdict, why=why), evidence)


def _evidence(found: la.LoadFactorRange, lowest: la.LimitState, highest: la.LimitState) -> Evidence:
    """Return the larger one of each residual of both ends, with one record for each search."""
    assert lowest.certificate is not None
    assert highest.certificate is not None
    assert lowest.point is not None
    low, high = asdict(lowest.certificate), asdict(highest.certificate)
    residuals = {name: max(low[name], high[name]) for name in low}
    return Evidence(residuals, records(found.states), packed(lowest.point))
