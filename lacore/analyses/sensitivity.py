"""`sensitivity`: derivatives of the load factor by its parameters (T81)."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from lacore.analyses.differences import by_differences
from lacore.analyses.envelope_theorem import Nearby, by_multipliers
from lacore.analyses.parameters import OWN, Parameter, parameters_of, without_parameter
from lacore.coupling.kinds import ASSOCIATED, COUPLINGS
from lacore.limit.constants import TOLERANCE
from lacore.limit.solve import solve
from lacore.limit.state import LimitState
from lacore.model.problem.problem import Problem
from lacore.reporting import views
from lacore.reporting.errors import InputError, is_number, typed
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Facts, Picture, counted, cut
from lacore.reporting.status import Result, Rigor, Status

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ENVELOPE, DIFFERENCES = "multipliers", "differences"
_METHODS = {ENVELOPE: Kind.BY_MULTIPLIERS, DIFFERENCES: Kind.BY_DIFFERENCES}
_NAMED = 6  # number of parameters that a finding names; others are counted
_COLUMNS = [
    *("parameter", "kind", "value", "unit", "body", "derivative", "elasticity", "left", "right"),
    *("unique", "method", "why"),
]


@dataclass(frozen=True, repr=False)
class Sensitivity(Result):
    """Derivatives of a load factor by the numbers of its problem.

    Attributes:
        state: the state.
        table: one row per parameter, the most important first: ``parameter``, ``kind``
            (``strength``, ``load``, ``place``, ``own``), ``value`` (for a load its size, for a node
            of a frame how far it is moved) and its ``unit`` (SI, angles in degrees), its ``body``,
            ``derivative`` of the load factor by it, ``elasticity``, that times the value divided by
            the load factor: per cent for each per cent (for a place with the size of its body as
            value); ``left`` and ``right``, the one-sided derivatives, which differ if it is not
            ``unique`` and has none; ``method``: ``multipliers`` or ``differences``; ``why`` there
            is none, or empty.
        left_out: loads and positions that are not in the table, each with the reason.
        solves: number of additional solves, which test whether derivatives are unique.
        solve_time: s, wall clock.
    """

    state: LimitState
    table: pd.DataFrame
    left_out: tuple[str, ...]
    solves: int
    solve_time: float

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Findings on how derivatives were computed, and which parameters have none."""
        table = self.table
        known = table[["left", "right"]].notna().all(axis=1)
        found = [Finding(_METHODS[name]) for name in dict.fromkeys(table["method"])]
        for kind, name, which in (
            (Kind.ONE_SIDED, "parameters", table["parameter"][known & ~table["unique"]]),
            (Kind.NO_DERIVATIVE, "parameters", table["parameter"][~known]),
            (Kind.LEFT_OUT, "loads", self.left_out),
        ):
            if len(which):
                found.append(Finding(kind, values={name: _first(list(which))}))
        return tuple(found)

    def facts(self) -> Facts:
        """Return the most important parameters, for printing."""
        told = {"status": self.message}
        most = self.table.dropna(subset="elasticity").head(3)
        rows = zip(most["parameter"], most["elasticity"], strict=True)
        told["most"] = "; ".join(f"{cut(name, 40)} {size:+z.3f}" for name, size in rows)
        told["solved by"] = f"{counted(self.solves, 'more solve')} in {self.solve_time:.3g} s"
        title = f"Sensitivity: load factor {self.state.load_factor:.7g},"
        return Facts(f"{title} {counted(len(self.table), 'parameter')}", told)

    def picture(self) -> Picture:
        """Return elasticities."""
        return Picture(self.plot())

    def plot(self) -> Figure:
        """Plot elasticities: see `lacore.pictures.analyses.plot_sensitivity`."""
        return views.picture(self)


def _first(names: list[str]) -> tuple[str, ...]:
    """Return the first of some names, and how many more there are."""
    more = len(names) - _NAMED
    return (*names[:_NAMED], f"{more} more") if more > 0 else tuple(names)


@typed(state="give what lacore.solve returns")
def sensitivity(
    state: LimitState,
    own: Mapping[str, tuple[Callable[[float], Problem], float]] | None = None,
) -> Sensitivity:
    """Compute derivatives of a load factor by strengths, friction, weights, loads, places (T81).

    If flow and friction are associated, the multipliers of the state give the derivatives without a
    solve (envelope theorem). A few more solves at neighbouring values show whether mechanisms are
    unique; if not, derivatives are one-sided. With Coulomb friction or non-associated flow the
    theorem does not hold, because reactions change with the parameter. Derivatives are then
    differences of certified load factors on both sides, which take four solves per parameter.

    Args:
        state: solved state of an exact backend.
        own: further parameters by name: a function that returns the problem at a value, and the
            value of the state, such as a span or a width; meshes and members may change with it,
            but not in number.

    Raises:
        InputError: a state without a certified load factor, of a regularised backend, or of a
            coupling that solves another problem; one whose mechanism carries a range of load
            factors; own parameters whose problem differs.
        CapabilityError: the backend is missing.

    Example:
        >>> found = la.sensitivity(la.solve(la.examples.beam()))
        >>> by = found.table.set_index("parameter").elasticity
        >>> round(by["beam: plastic_moment"].item(), 3)  # 1 % stronger, 1 % more load
        1.0
    """
    begin = time.perf_counter()
    _check(state)
    problem = state.discretisation.problem
    parameters = [*parameters_of(problem), *_given(own or {}, state)]
    asked = Nearby(state, {"backend": state.backend, "coupling": state.coupling})
    flows = state.discretisation.program
    coulomb = not COUPLINGS[state.coupling].laws and flows.contact.coulomb.any()
    if flows.frictional or coulomb:
        _require_one(state)
        at = state.load_factor
        rows = [by_differences(each, problem, at, asked.load_factor) for each in parameters]
        rows = [{**row, "method": DIFFERENCES} for row in rows]
    else:
        rows = by_multipliers(state, parameters, asked)
        rows = [{**row, "method": ENVELOPE} for row in rows]
    table = pd.DataFrame(
        [_row(*pair, state.load_factor) for pair in zip(parameters, rows, strict=True)],
        columns=_COLUMNS,
    )
    # Objects, because a column of plain text would lose the quantities of the names.
    table["parameter"] = pd.Series([own.name for own in parameters], dtype=object)
    order = table["elasticity"].abs().sort_values(ascending=False, na_position="last").index
    return Sensitivity(
        state=state,
        table=table.loc[order].reset_index(drop=True),
        left_out=without_parameter(problem),
        solves=asked.solves,
        solve_time=time.perf_counter() - begin,
    )


def _row(parameter: Parameter, found: Mapping[str, Any], load_factor: float) -> dict[str, Any]:
    left, right = float(found["left"]), float(found["right"])
    derivative = (left + right) / 2 if found["unique"] else np.nan
    most = derivative if found["unique"] else max(left, right, key=abs)
    return {
        "parameter": parameter.name,
        "kind": parameter.kind,
        "value": parameter.value,
        "unit": parameter.unit,
        "body": parameter.body,
        "derivative": derivative,
        "elasticity": most * parameter.size / load_factor if load_factor else np.nan,
        **found,
    }


def _given(
    own: Mapping[str, tuple[Callable[[float], Problem], float]], state: LimitState
) -> list[Parameter]:
    """Return the parameters of a user."""
    found = []
    for name, pair in own.items():
        field = f"own[{name!r}]"
        if not (isinstance(pair, tuple) and len(pair) == 2 and callable(pair[0])):
            raise InputError(field, pair, "no parameter", "give (problem_at, value)")
        problem_at, value = pair
        if not (is_number(value) and value):
            raise InputError(field, value, "not a number other than zero", "give its value")
        at = solve(problem_at(value), state.backend, state.coupling, options=state.options)
        if not abs(at.load_factor - state.load_factor) <= 10 * state.tolerance * (
            abs(state.load_factor) + abs(at.load_factor)
        ):
            raise InputError(
                field,
                value,
                f"there the load factor is {at.load_factor:.7g}, of the state"
                f" {state.load_factor:.7g}: it is not the same problem",
                "give the value that the state was solved with",
            )

        def changed(
            _: Problem, value: float, at: Callable[[float], Problem] = problem_at
        ) -> Problem:
            return at(value)

        found.append(Parameter(name, OWN, float(value), abs(float(value)), changed))
    return found


def _check(state: LimitState) -> None:
    if state.status is not Status.SOLVED or state.point is None:
        raise InputError(
            "state",
            state.status.label,
            "has no certified load factor, and so no derivative",
            "give a state whose status is SOLVED",
        )
    if state.rigor is Rigor.REGULARISED:
        raise InputError(
            "state.backend",
            state.backend,
            "is regularised: its multipliers are those of another problem",
            "solve it with an exact backend, such as 'clarabel'",
        )
    if COUPLINGS[state.coupling].model not in ("", ASSOCIATED):
        raise InputError(
            "state.coupling",
            state.coupling,
            "answers a problem without the friction that is stated",
            "take 'certified', or 'associated'",
        )


def _require_one(state: LimitState) -> None:
    """Raise `InputError` if differences of load factors would not give derivatives.

    The mechanism of a Coulomb state may carry a range of them, and states of soils may be certified
    with a tolerance that is too large.
    """
    worst = np.nan if state.certificate is None else state.certificate.worst[1]
    if not worst <= TOLERANCE:
        raise InputError(
            "state",
            state.load_factor,
            f"it is certified to {worst:.1e} only: differences would show that, and no derivative",
            f"solve it with tolerance={TOLERANCE:g}, if that is reached",
        )
    if state.discretisation.program.frictional:
        return
    interval = state.interval()
    low, high = interval.low, interval.high
    if not high - low <= 100 * state.tolerance * abs(state.load_factor):  # false for NaN
        raise InputError(
            "state",
            state.load_factor,
            f"its mechanism carries every load factor of [{low:.6g}, {high:.6g}]: which of them is"
            " found is no function of the parameters",
            "take coupling='associated', whose load factor is the highest, for an upper bound",
        )
