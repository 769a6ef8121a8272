"""Search for low and high load factors of a soil whose flow is not associated, and judge both."""

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
    """The row of a range, with what both of its ends leave of the laws, and the lower one's state.

    Args:
        run: to be done.
        names: columns that are known already.
        discretisation: of its problem.
        reference, band: of its load factors.
        memory: peak memory of this process, MB.

    Raises:
        InputError: flow is associated; a regularised backend; an option that there is not.
        CapabilityError: the backend cannot take it.
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
    """Of each residual the larger one of both ends; one record a search."""
    assert lowest.certificate is not None
    assert highest.certificate is not None
    assert lowest.point is not None
    low, high = asdict(lowest.certificate), asdict(highest.certificate)
    residuals = {name: max(low[name], high[name]) for name in low}
    return Evidence(residuals, records(found.states), packed(lowest.point))
