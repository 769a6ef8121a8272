"""Check of the residuals: recomputed from the stored state, never copied."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from math import inf, isclose, isfinite, isnan, nan

import numpy as np

import lacore as la
from lacore_verification.harness.evidence.limit_state import Proof
from lacore_verification.harness.verdicts.limit_state import REGULARISED
from lacore_verification.harness.verdicts.words import FAIL, PASS, SKIPPED
from lacore_verification.harness.verify.finding import CheckResult
from lacore_verification.runs.outcome import Outcome

Rechecked = Proof | str
"""A proof, or why there is none."""

_SAME = 1e-12  # Relative to a load factor that is stored twice.


def residuals(outcomes: Sequence[Outcome], rechecked: Mapping[str, Rechecked]) -> CheckResult:
    """Return whether residuals of solved states are small, and the states are those of rows.

    Args:
        outcomes: of one variant and backend.
        rechecked: by `Run.key`, of those that are solved.
    """
    solved = [outcome for outcome in outcomes if outcome.row.status == la.Status.SOLVED.label]
    if not solved:
        return CheckResult(SKIPPED, f"{outcomes[0].row.status}: there is no state to be proven")
    answers = [_residuals(outcome, rechecked[outcome.run.key]) for outcome in solved]
    failed = [answer for answer in answers if answer.verdict == FAIL]
    return failed[0] if failed else max(answers, key=lambda answer: answer.measured)


def _residuals(outcome: Outcome, proof: Rechecked) -> CheckResult:
    run, row = outcome.run, outcome.row
    if isinstance(proof, str):
        return CheckResult(FAIL, f"{run.label}: {proof}", nan, "")
    bar = float(run.settings.get("tolerance", proof.bar))
    allowed = f"<= {bar:g}"
    if not 0 < bar < inf:
        return CheckResult(
            FAIL, f"{run.label}: nothing can be above a bar of {bar:g}", nan, allowed
        )
    stored = proof.load_factor
    if not (isfinite(stored) and isclose(stored, row.load_factor, rel_tol=_SAME)):
        why = f"{run.label}: the row says {row.load_factor:.9g}, the stored state {stored:.9g}"
        return CheckResult(FAIL, why, nan, allowed)
    found: dict[str, float] = asdict(proof.certificate)
    if not isnan(row.energy):
        found = {name: found[name] for name in REGULARISED}
    name = max(found, key=lambda key: np.nan_to_num(found[key], nan=np.inf))
    verdict = PASS if all(size <= bar for size in found.values()) else FAIL
    what = "computed afresh" if verdict == PASS else f"above {bar:g}, computed afresh"
    return CheckResult(
        verdict, f"{run.label}: {name} {found[name]:.2g}, {what}", found[name], allowed
    )
