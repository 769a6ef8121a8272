"""One-sided derivatives, of load factors or as limits of derivatives."""

from collections.abc import Callable
from typing import Any

import numpy as np

from lacore.analyses.parameters import Parameter
from lacore.model.problem.problem import Problem
from lacore.reporting.errors import InputError

_STEPS = (3e-3, 4e-4)  # by a number: load factors are certified to 1e-6, and usually much better
_NEAR = (1e-4, 2.5e-5)  # the same if slopes are known, and only their limits are required
_KINK = 1e-3  # of elasticities: difference of one-sided slopes at a kink
_BENT = 0.75  # Differences of smooth functions halve with the step.
# of elasticities: allowed difference of slopes at half and whole steps on one side
_STEADY = 10 * _KINK
_NO_STATE = "a load factor at a neighbouring value is not certified"
_JUMPS = "load factors at neighbouring values jump, or belong to other states"


def by_differences(
    parameter: Parameter,
    problem: Problem,
    load_factor: float,
    at: Callable[[Problem], float],
) -> dict[str, Any]:
    """Return one-sided derivatives from certified load factors at half and whole steps.

    Each side is extrapolated from its two steps; they are one derivative if both agree. If the two
    steps of a side disagree, another state or a kink lies between them, and smaller steps are
    tried: a kink is reported only if each side is linear.
    """
    scale = (abs(load_factor) or 1.0) / parameter.size
    fine, coarse = [], []
    for sign in (-1, 1):
        for share in _STEPS:
            step = sign * share * parameter.size
            try:
                half, whole = (
                    at(parameter.at(problem, parameter.value + part * step)) for part in (0.5, 1.0)
                )
            except InputError as wrong:
                return _none(f"at a neighbouring value: {wrong}")
            first, second = (half - load_factor) / (step / 2), (whole - load_factor) / step
            if abs(first - second) <= _STEADY * scale:
                break
        else:
            return _none(_JUMPS if np.isfinite(half + whole) else _NO_STATE)
        fine.append(2 * first - second)
        coarse.append(second)
    left, right = fine
    apart, before = abs(right - left) / scale, abs(coarse[1] - coarse[0]) / scale
    unique = apart <= _KINK or (apart < _BENT * before and apart <= 10 * _KINK)
    return {"left": left, "right": right, "unique": unique, "why": ""}


def two_sided(
    parameter: Parameter, derivative: float, load_factor: float, at: Callable[[float], float]
) -> dict[str, Any]:
    """Return one-sided derivatives at a value, as limits of those at neighbouring values.

    Args:
        parameter: the number.
        derivative: derivative of a state at the number.
        load_factor: load factor of the state.
        at: function that returns the derivative at another value.
    """
    scale = (abs(load_factor) or 1.0) / parameter.size
    try:
        near = np.array(
            [at(parameter.value + sign * _NEAR[1] * parameter.size) for sign in (-1, 1)]
        )
        if np.ptp(near) <= _KINK * scale and np.abs(near - derivative).max() <= _KINK * scale:
            return {"left": derivative, "right": derivative, "unique": True, "why": ""}
        far = np.array([at(parameter.value + sign * _NEAR[0] * parameter.size) for sign in (-1, 1)])
    except InputError as wrong:
        return _none(f"at a neighbouring value: {wrong}")
    left, right = near + (near - far) * _NEAR[1] / (_NEAR[0] - _NEAR[1])
    if not np.isfinite(left + right):
        return _none(_NO_STATE)
    return {
        "left": left,
        "right": right,
        "unique": bool(abs(right - left) <= _KINK * scale),
        "why": "",
    }


def _none(why: str) -> dict[str, Any]:
    return {"left": np.nan, "right": np.nan, "unique": False, "why": why}
