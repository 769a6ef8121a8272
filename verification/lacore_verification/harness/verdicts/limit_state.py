"""Verdicts on limit states: required load factors or statuses."""

# Annotations are not evaluated: names of lacore in them load nothing.
from __future__ import annotations

from collections.abc import Mapping
from math import inf, isfinite, nan
from typing import TYPE_CHECKING, Protocol

import lacore as la
from lacore.coupling.kinds import ASSOCIATED, COUPLINGS
from lacore_verification.case import Band, Reference
from lacore_verification.case.band import BRACKET
from lacore_verification.case.case import RANGE
from lacore_verification.harness.verdicts.allowed import (
    Allowed,
    allowed_values,
    cannot_judge,
    lower_values,
    upper_values,
)
from lacore_verification.harness.verdicts.words import (
    BOUND_ONLY,
    FAIL,
    NO_REFERENCE,
    NO_RESULT,
    PASS,
)

if TYPE_CHECKING:
    from lacore.program.regularization import RegularisedValues

STRONG = 0.05  # Relative to the value: above it the regularisation error hides a wrong result.
REGULARISED = ("equilibrium", "yield_violation", "normalisation")
"""Residuals of a regularised state that count; penalties make the others nonzero (T19)."""
REFUTED = 1e-3
"""Larger ones of these residuals make a solved status wrong, not merely inaccurate."""
_VALUES = {"upper": upper_values, "lower": lower_values}
BOUNDS = {name: _VALUES[kind.bounds] for name, kind in COUPLINGS.items() if kind.bounds}
"""Couplings that bound the Coulomb load factors (T14) instead of finding one."""
MODELS = {name: kind.model for name, kind in COUPLINGS.items() if kind.model}
"""Names of the models that couplings solve in place of that of the case."""
FINDS_NONE = (*MODELS, BRACKET, RANGE)
"""Values of the column of couplings in rows that have no Coulomb load factor."""
_CLAIMED = {la.Status.LOCKED: inf, la.Status.UNSAFE: -inf, la.Status.FREE: 0.0}
"""Load factors implied by statuses, which are right or wrong, like a number."""


class Judged(Protocol):
    """Data of a verdict: a state, or the columns of a row; as in `la.LimitState`."""

    @property
    def status(self) -> la.Status: ...  # noqa: D102
    @property
    def load_factor(self) -> float: ...  # noqa: D102
    @property
    def coupling(self) -> str: ...  # noqa: D102
    @property
    def message(self) -> str: ...  # noqa: D102
    @property
    def regularised(self) -> RegularisedValues | None: ...  # noqa: D102


def judge(
    state: Judged, reference: Reference, band: Band, insist: bool = True, refuted: str = ""
) -> tuple[str, str]:
    """Return the verdict on a result, with its reason.

    Exact backends must lie in the band of the case. Regularised ones approach the exact discrete
    value from below with an error smaller than the energy C = alpha_reg - P (T19), so the band is
    lowered by C; and C must be small, or the verdict would be meaningless. Couplings that bound the
    Coulomb load factors must bound the reference; if they are not within its band, and their own
    reference is not known, they are bounds only. Unless we `insist` on a result, a solve that
    claims nothing, or nothing that can be checked, has none; one whose claim is refuted by
    residuals (`refuted`, see `refutation`) is wrong. Without a reference nothing passes.
    """
    if state.status not in (la.Status.SOLVED, reference.status, *_CLAIMED):
        verdict = FAIL if refuted or insist else NO_RESULT
        return verdict, refuted or f"not solved: {state.message}"
    if why := cannot_judge(reference, band):
        return FAIL, why
    if state.status is la.Status.SOLVED and not isfinite(state.load_factor):
        return FAIL, f"solved without a load factor: {state.load_factor:g}"
    if reference.unknown:
        why = f"{state.status.label}: proven by its certificate, nothing to compare with"
        return NO_REFERENCE, why
    if state.coupling in MODELS and state.coupling not in BOUNDS:
        return NO_REFERENCE, "with Davis's reduced strength, which bounds nothing (T55)"
    return _judge_load(state, reference, band, insist)


def _judge_load(state: Judged, reference: Reference, band: Band, insist: bool) -> tuple[str, str]:
    """Compare the load factor, or the status in its place, with the reference of the coupling."""
    allowed_of = BOUNDS.get(state.coupling, allowed_values)
    if state.coupling == ASSOCIATED and reference.associated is not None:
        reference, allowed_of = reference.of_associated(), allowed_values
    found_only = {state.status, reference.status} - {la.Status.SOLVED}
    if allowed_of is allowed_values and found_only:
        verdict = PASS if state.status is reference.status else FAIL
        return verdict, f"{state.status.label}, expected {reference.text}"
    if state.regularised is not None and (too_strong := _too_strong(state, band)):
        return FAIL if insist else NO_RESULT, too_strong
    verdict, why = _judge_value(state, reference, allowed_of(reference, band))
    value = _CLAIMED.get(state.status, state.load_factor)
    bounds = allowed_of is not allowed_values
    if verdict == PASS and bounds and not allowed_values(reference, band).holds(value):
        return BOUND_ONLY, f"{why}: a bound by another model, {MODELS[state.coupling]}"
    return verdict, why


def refutation(claimed: bool, residuals: Mapping[str, float]) -> str:
    """Return how the residuals refute the claim of a solver; empty if they do not.

    Args:
        claimed: whether it reported its last problem as solved.
        residuals: of the certificate, by name; empty if nothing was computed.
    """
    for name in REGULARISED if claimed and residuals else ():
        size = residuals.get(name, nan)
        if not size <= REFUTED:
            return f"claimed to be solved, refuted by its residuals: {name} {size:.2g}"
    return ""


def _too_strong(state: Judged, band: Band) -> str:
    """Return why a regularised value permits no verdict; empty if it does."""
    assert state.regularised is not None
    energy, value = state.regularised.energy, _CLAIMED.get(state.status, state.load_factor)
    if max(energy, 0.0) <= STRONG * band.size(value):
        return ""
    return (
        f"regularisation too strong to judge: C = {energy:.3g} is above {100 * STRONG:g} % of the"
        " value; lower r"
    )


def _judge_value(state: Judged, reference: Reference, allowed: Allowed) -> tuple[str, str]:
    value = _CLAIMED.get(state.status, state.load_factor)
    if state.regularised is not None:
        allowed = Allowed(allowed.low - max(state.regularised.energy, 0.0), allowed.high)
    verdict = PASS if allowed.holds(value) else FAIL
    why = f"{value:.7g} {'in' if verdict == PASS else 'not in'} {allowed}"
    if not (reference.complete or reference.low <= value <= reference.high):
        why += f"; listed are {reference.text}"
        if verdict == PASS and reference.associated is None:
            return NO_REFERENCE, f"{why}, and nothing bounds any other"
    return verdict, why
