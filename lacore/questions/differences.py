"""Derivatives by differences, from one side and from the other."""

from collections.abc import Callable
from typing import Any

import numpy as np

from lacore.errors import InputError
from lacore.problem.problem import Problem
from lacore.questions.parameters import Parameter

_ASIDE = 3e-3  # of a number: load factors are certified to 1e-6, and mostly much better
_NEAR = (1e-4, 2.5e-5)  # the same where slopes are known, and only their limits are looked for
_KINK = 1e-3  # of elasticities: slopes that differ by more from both sides
_BENT = 0.75  # what is smooth halves with the step


def by_differences(
    parameter: Parameter,
    problem: Problem,
    load_factor: float,
    at: Callable[[Problem], float],
) -> dict[str, Any]:
    """One-sided derivatives from certified load factors at half and at whole steps.

    Each side is extrapolated from its two steps; they are one derivative where both agree.
    """
    step = _ASIDE * parameter.size
    sides, coarse = [], []
    for sign in (-1, 1):
        try:
            half, whole = (
                at(parameter.at(problem, parameter.value + sign * share * step))
                for share in (0.5, 1.0)
            )
        except InputError as wrong:
            return {"left": np.nan, "right": np.nan, "unique": True, "why": f"beside it: {wrong}"}
        first = (half - load_factor) / (sign * step / 2)
        second = (whole - load_factor) / (sign * step)
        sides.append(2 * first - second)
        coarse.append(second)
    left, right = sides
    if not np.isfinite(left + right):
        why = "a load factor beside it is not certified"
        return {"left": np.nan, "right": np.nan, "unique": True, "why": why}
    scale = (abs(load_factor) or 1.0) / parameter.size
    apart, before = abs(right - left) / scale, abs(coarse[1] - coarse[0]) / scale
    unique = apart <= _KINK or (apart < _BENT * before and apart <= 10 * _KINK)
    return {"left": left, "right": right, "unique": unique, "why": ""}


def two_sided(parameter: Parameter, at: Callable[[float], float]) -> dict[str, Any]:
    """One-sided derivatives, as limits of those at values beside a number.

    Args:
        parameter: the number.
        at: the derivative at another value.
    """
    sides = []
    for sign in (-1, 1):
        far, near = (at(parameter.value + sign * share * parameter.size) for share in _NEAR)
        sides.append(near + (near - far) * _NEAR[1] / (_NEAR[0] - _NEAR[1]))
    left, right = sides
    if not np.isfinite(left + right):
        why = "a load factor beside it is not certified"
        return {"left": np.nan, "right": np.nan, "unique": False, "why": why}
    apart = abs(right - left)
    return {
        "left": left,
        "right": right,
        "unique": bool(apart <= _KINK * max(abs(left), abs(right))),
        "why": "",
    }
