"""Verdicts on limit states: what a load factor, or a status without one, must be."""

from __future__ import annotations  # not evaluated: names of lacore in them load nothing

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

STRONG = 0.05  # of the value: above it the regularisation error hides a wrong answer
REGULARISED = ("equilibrium", "yield_violation", "normalisation")
"""What a regularised state is judged by: penalties let through the rest (T19)."""
REFUTED = 1e-3
"""Of these: who called an end with more than this solved was wrong, not short of digits."""
_VALUES = {"upper": upper_values, "lower": lower_values}
BOUNDS = {name: _VALUES[kind.bounds] for name, kind in COUPLINGS.items() if kind.bounds}
"""Couplings that bound the Coulomb load factors (T14) instead of finding one."""
MODELS = {name: kind.model for name, kind in COUPLINGS.items() if kind.model}
"""Names of the models that couplings solve in place of that of the case."""
FINDS_NONE = (*MODELS, BRACKET, RANGE)
"""What stands for a coupling in rows that have no Coulomb load factor."""
_CLAIMED = {la.Status.LOCKED: inf, la.Status.UNSAFE: -inf, la.Status.FREE: 0.0}
"""What statuses say of the load factor: they are claims, right or wrong, like a number."""


class Judged(Protocol):
    """What a verdict is on: a state, or what a row says of one; as of `la.LimitState`."""

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
    """Verdict on a result, and why.

    Exact backends must lie in the band of the case. Regularised ones approach the exact discrete
    value from below with an error smaller than the energy C = alpha_reg - P (T19), so the band is
    lowered by C; and C must be small, or the verdict would be worth nothing. Couplings that bound
    the Coulomb load factors must bound the reference; where they are not within its band, and their
    own reference is not known, they are bounds only. Unless we `insist` on a result, a solve that
    claims nothing, or nothing that can be judged, is none; one that claims what residuals have
    `refuted` (see `refutation`) is wrong. Without a reference nothing passes.
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
    """How the claim of a solver to have solved its last problem is refuted; empty if it is not.

    Args:
        claimed: whether there is one.
        residuals: of the certificate, by name; empty where nothing was computed.
    """
    for name in REGULARISED if claimed and residuals else ():
        size = residuals.get(name, nan)
        if not size <= REFUTED:
            return f"claimed to be solved, refuted by its residuals: {name} {size:.2g}"
    return ""


def _too_strong(state: Judged, band: Band) -> str:
    """Why a regularised value is worth no verdict; empty where it is worth one."""
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
