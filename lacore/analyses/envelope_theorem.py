"""Derivatives of a load factor by the multipliers of its state, one-sided at kinks (T81).

The load factor is a saddle value: its derivative in a direction is the maximum over the stresses,
and the minimum over the mechanisms, of that of the Lagrangian. For strengths and loads it depends
on the mechanism alone, for positions also on the stresses. A position therefore has one derivative
only if both are unique, which a change of strengths, which selects a mechanism, does not test.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from lacore.analyses.differences import two_sided
from lacore.analyses.lagrangian import Frozen, NotComparableError, frozen, slope
from lacore.analyses.parameters import LOAD, STRENGTH, Parameter
from lacore.limit.constants import TOLERANCE
from lacore.limit.solve import solve
from lacore.limit.state import LimitState
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError
from lacore.reporting.status import Status

_ASIDE = (1e-3, 1.25e-4)  # by all strengths and loads: changes that test uniqueness
_CHANGED = 1e-3  # of elasticities: a larger change may be a kink
_SMOOTH = 2.5  # Smooth functions change 8 times less for the second of them.
_GOLDEN = 0.6180339887498949


@dataclass
class Nearby:
    """Solves of slightly changed problems, with the arguments of a state."""

    state: LimitState
    given: Mapping[str, Any]
    solves: int = 0

    def solved(self, problem: Problem) -> LimitState:
        """Return the state of a problem."""
        self.solves += 1
        bar = min(TOLERANCE, self.state.tolerance)
        return solve(problem, **self.given, options=self.state.options, tolerance=bar)

    def load_factor(self, problem: Problem) -> float:
        """Return the load factor of a problem."""
        return self.solved(problem).load_factor


def by_multipliers(
    state: LimitState,
    parameters: Sequence[Parameter],
    nearby: Nearby,
) -> list[dict[str, Any]]:
    """Return rows of derivatives, one-sided if mechanisms or stresses are not unique.

    All strengths and loads are changed together first: if no derivative differs between both sides,
    mechanisms are unique. Other parameters, and all if one derivative differs, are tested
    separately, because one direction shows that there is a kink but not for which parameter.
    """
    problem, solution = state.discretisation.problem, frozen(state)
    jointly = [own.kind in (STRENGTH, LOAD) for own in parameters]
    slopes, whys = zip(
        *[_slope(solution, problem, own, own.value) for own in parameters], strict=True
    )
    doubt = _jump([own for own, joint in zip(parameters, jointly, strict=True) if joint], nearby)
    rows = []
    for own, derivative, why, joint in zip(parameters, slopes, whys, jointly, strict=True):
        known = bool(np.isfinite(derivative))
        row = {"left": derivative, "right": derivative, "unique": known, "why": why}
        if known and (doubt or not joint):

            def at(value: float, own: Parameter = own) -> float:
                found = nearby.solved(own.at(problem, value))
                if found.status is not Status.SOLVED:
                    return np.nan
                return _slope(frozen(found), problem, own, value)[0]

            row = two_sided(own, derivative, state.load_factor, at)
        rows.append(row)
    return rows


def _slope(solution: Frozen, problem: Problem, own: Parameter, value: float) -> tuple[float, str]:
    """Return the derivative at a state, or why there is none."""
    try:
        return slope(solution, partial(own.at, problem), value, own.size), ""
    except InputError as wrong:
        return np.nan, f"at a neighbouring value: {wrong}"
    except NotComparableError:
        return np.nan, "a change of it changes the unknowns or the contact points"


def _jump(parameters: Sequence[Parameter], nearby: Nearby) -> bool:
    """Return whether derivatives by strengths and loads may differ on both sides of a state."""
    state = nearby.state
    sizes = np.array([own.size for own in parameters])
    apart: list[Floats] = []
    for aside in _ASIDE:
        ends = []
        for sign in (1, -1):
            problem, values = _changed(state.discretisation.problem, parameters, sign * aside)
            found = nearby.solved(problem)
            if found.status is not Status.SOLVED:
                return True
            solution = frozen(found)
            slopes = [
                _slope(solution, problem, own, value)[0]
                for own, value in zip(parameters, values, strict=True)
            ]
            ends.append(slopes)
        scale = abs(state.load_factor) or 1.0
        apart.append(np.abs(np.subtract(ends[0], ends[1])) * sizes / scale)
        if not np.any(apart[-1] > _CHANGED):
            return False
    return bool(np.any((apart[1] > _CHANGED) & (apart[0] < _SMOOTH * apart[1])))


def _changed(
    problem: Problem, parameters: Sequence[Parameter], aside: float
) -> tuple[Problem, list[float]]:
    """Return a problem with each of its parameters changed by its own share, and their values."""
    values = []
    for k, own in enumerate(parameters):
        value = own.value * (1 + aside * (0.3 + 0.7 * ((k + 1) * _GOLDEN % 1.0)))
        try:
            problem = own.at(problem, value)
            values.append(value)
        except InputError:
            values.append(own.value)
    return problem, values
