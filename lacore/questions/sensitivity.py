"""`sensitivity`: what the load factor depends on, and how much (T81)."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from lacore import views
from lacore.arrays import Floats
from lacore.coupling.kinds import ASSOCIATED, COUPLINGS
from lacore.errors import InputError, is_number, typed
from lacore.limit.solve import TOLERANCE, solve
from lacore.limit.state import LimitState
from lacore.problem.problem import Problem
from lacore.questions.differences import by_differences, two_sided
from lacore.questions.lagrangian import NotComparableError, frozen, slope
from lacore.questions.parameters import (
    LOAD,
    OWN,
    STRENGTH,
    Parameter,
    parameters_of,
    without_parameter,
)
from lacore.showing import Facts, Picture, Shown, counted, cut, listed
from lacore.status import Rigor, Status

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ENVELOPE, DIFFERENCES = "multipliers", "differences"
_METHODS = {
    ENVELOPE: "by multipliers of the state (envelope theorem)",
    DIFFERENCES: (
        "by differences of certified load factors on either side, good to some 1e-3 of an"
        " elasticity: friction or flow that is not associated has no envelope theorem"
    ),
}
_COLUMNS = [
    *("parameter", "kind", "value", "unit", "body", "derivative", "elasticity", "left", "right"),
    *("unique", "method", "why"),
]
_ASIDE = (1e-3, 1.25e-4)  # of all strengths and loads, by which uniqueness is tried
_CHANGED = 1e-3  # of elasticities: more may be a kink
_SMOOTH = 2.5  # what is smooth changes 8 times less with the second of them
_GOLDEN = 0.6180339887498949


@dataclass(frozen=True, repr=False)
class Sensitivity(Shown):
    """Derivatives of a load factor by the numbers that its problem is stated with.

    Attributes:
        state: that was asked.
        table: a row a parameter, what matters most first: ``parameter``, ``kind`` (``strength``,
            ``load``, ``place``, ``own``), ``value`` (of a load its size, of a node of a frame how
            far it is moved) and its ``unit`` (SI, angles in degrees), the ``body`` that it is of,
            ``derivative`` of the load factor by it,
            ``elasticity``, that times the value over the load factor: per cent for each per cent
            (of a place the size of its body stands for the value); ``left`` and ``right``, the
            one-sided derivatives, which differ where it is not ``unique`` and has none;
            ``method``: ``multipliers`` or ``differences``; ``why`` there is none.
        left_out: loads that have no one size.
        solves: more ones that were made, to see whether derivatives are unique.
        solve_time: s, wall clock.
    """

    state: LimitState
    table: pd.DataFrame
    left_out: tuple[str, ...]
    solves: int
    solve_time: float

    @property
    def message(self) -> str:
        """How derivatives were found, and of which there are none."""
        said = ", ".join(_METHODS[name] for name in dict.fromkeys(self.table["method"]))
        kinked = self.table["parameter"][~self.table["unique"]]
        if len(kinked):
            said += (
                f"; one-sided, `left` and `right` of a kink, with none between:"
                f" {listed(list(kinked))}"
            )
        without = self.table["parameter"][self.table["why"] != ""]
        if len(without):
            said += f"; none of {listed(list(without))} (see the table)"
        if self.left_out:
            said += f"; without one size: {listed(list(self.left_out))}"
        return said

    def facts(self) -> Facts:
        """What matters most."""
        told = {"status": self.message}
        most = self.table.dropna(subset="elasticity").head(3)
        rows = zip(most["parameter"], most["elasticity"], strict=True)
        told["most"] = "; ".join(f"{cut(name, 40)} {size:+z.3f}" for name, size in rows)
        told["solved by"] = f"{counted(self.solves, 'more solve')} in {self.solve_time:.3g} s"
        title = f"Sensitivity: load factor {self.state.load_factor:.7g},"
        return Facts(f"{title} {counted(len(self.table), 'parameter')}", told)

    def picture(self) -> Picture:
        """Elasticities."""
        return Picture(self.plot())

    def plot(self) -> Figure:
        """Elasticities: see `lacore.pictures.questions.sensitivity.plot_sensitivity`."""
        return views.picture(self)


@typed(state="give what lacore.solve returns")
def sensitivity(
    state: LimitState,
    own: Mapping[str, tuple[Callable[[float], Problem], float]] | None = None,
    *,
    on_parameter: Callable[[str], None] | None = None,
) -> Sensitivity:
    """How much a load factor depends on each strength, friction, weight, load and place (T81).

    Where flow and friction are associated the multipliers of the state say it, without a solve
    (envelope theorem); a few more solves beside it tell whether mechanisms are unique, and where
    they are not derivatives are one-sided. Coulomb friction, and soils that dilate less than their
    friction, have no such theorem: their reactions change with the parameter. There it is
    differences of certified load factors on either side, four solves a parameter.

    Args:
        state: solved, of an exact backend.
        own: more parameters by name: the problem at a value, and the value of the state: a span,
            or a width, whose meshes and members change with it but not in number.
        on_parameter: called with the name of each parameter as it is done, for progress.

    Raises:
        InputError: a state without a certified load factor, of a regularised backend, or of a
            coupling that answers another problem; one whose mechanism carries a range of load
            factors; own parameters that state another problem.
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
    tell = on_parameter or (lambda name: None)
    asked = _Asked(state, {"backend": state.backend, "coupling": state.coupling})
    flows = state.discretisation.program
    coulomb = not COUPLINGS[state.coupling].laws and flows.contact.coulomb.any()
    if flows.frictional or coulomb:
        _require_one(state)
        rows = []
        for parameter in parameters:
            rows.append(by_differences(parameter, problem, state.load_factor, asked.load_factor))
            tell(parameter.name)
        rows = [{**row, "method": DIFFERENCES} for row in rows]
    else:
        rows = _by_multipliers(state, parameters, asked)
        for parameter in parameters:
            tell(parameter.name)
    table = pd.DataFrame(
        [_row(*pair, state.load_factor) for pair in zip(parameters, rows, strict=True)],
        columns=_COLUMNS,
    )
    # As objects: a column of plain text would lose the quantities of the names.
    table["parameter"] = pd.Series([own.name for own in parameters], dtype=object)
    order = table["elasticity"].abs().sort_values(ascending=False, na_position="last").index
    return Sensitivity(
        state=state,
        table=table.loc[order].reset_index(drop=True),
        left_out=without_parameter(problem),
        solves=asked.solves,
        solve_time=time.perf_counter() - begin,
    )


@dataclass
class _Asked:
    """Solves beside a state, with what it was solved with."""

    state: LimitState
    given: Mapping[str, Any]
    solves: int = 0

    def beside(self, problem: Problem) -> LimitState:
        self.solves += 1
        bar = min(TOLERANCE, self.state.tolerance)
        return solve(problem, **self.given, options=self.state.options, tolerance=bar)

    def load_factor(self, problem: Problem) -> float:
        return self.beside(problem).load_factor


def _by_multipliers(
    state: LimitState, parameters: Sequence[Parameter], asked: _Asked
) -> list[dict[str, Any]]:
    """Rows of derivatives at the state; one-sided where mechanisms are not unique."""
    problem = state.discretisation.problem
    slopes, whys = _slopes(state, problem, parameters)
    kinked = _kinked(state, parameters, slopes, asked)
    rows = []
    for parameter, derivative, why, doubt in zip(parameters, slopes, whys, kinked, strict=True):
        row = {"left": derivative, "right": derivative, "unique": True, "why": why}
        if doubt and not why:

            def at(value: float, own: Parameter = parameter) -> float:
                beside = asked.beside(own.at(problem, value))
                if beside.status is not Status.SOLVED:
                    return np.nan
                found, _ = _slopes(beside, beside.discretisation.problem, [own], value)
                return float(found[0])

            row |= two_sided(parameter, at)
        rows.append({**row, "method": ENVELOPE})
    return rows


def _slopes(
    state: LimitState,
    problem: Problem,
    parameters: Sequence[Parameter],
    value: float | None = None,
) -> tuple[Floats, list[str]]:
    """Derivatives at a state, and why there are none."""
    solution = frozen(state)
    found, whys = [], []
    for own in parameters:
        here = own.value if value is None else value
        try:
            found.append(slope(solution, partial(own.at, problem), here, own.size))
            whys.append("")
        except InputError as wrong:
            found.append(np.nan)
            whys.append(f"beside it: {wrong}")
        except NotComparableError:
            found.append(np.nan)
            whys.append("a change of it changes the unknowns or the contact points")
    return np.array(found), whys


def _kinked(
    state: LimitState, parameters: Sequence[Parameter], slopes: Floats, asked: _Asked
) -> list[bool]:
    """Which derivatives may jump at the state: beside it, on both sides, they are others."""
    problem = state.discretisation.problem
    sizes = np.array([own.size for own in parameters])
    moved = [k for k, own in enumerate(parameters) if own.kind in (STRENGTH, LOAD)]
    apart = []
    for aside in _ASIDE:
        ends = []
        for sign in (1, -1):
            beside, values = problem, {}
            for k in moved:
                own = parameters[k]
                share = 0.3 + 0.7 * ((k + 1) * _GOLDEN % 1.0)
                values[k] = own.value * (1 + sign * aside * share)
                try:
                    beside = own.at(beside, values[k])
                except InputError:
                    values[k] = own.value
            found = asked.beside(beside)
            if found.status is not Status.SOLVED:
                return [False] * len(parameters)
            solution, stated = frozen(found), found.discretisation.problem
            ends.append(
                [
                    _slope_or_nan(solution, own, stated, values.get(k, own.value))
                    for k, own in enumerate(parameters)
                ]
            )
        scale = abs(state.load_factor) or 1.0
        apart.append(np.abs(np.subtract(ends[0], ends[1])) * sizes / scale)
        if not np.any(apart[-1] > _CHANGED):
            return [False] * len(parameters)
    jumps = (apart[1] > _CHANGED) & (apart[0] < _SMOOTH * apart[1])
    return [bool(own) for own in jumps]


def _slope_or_nan(solution: Any, own: Parameter, stated: Problem, value: float) -> float:
    if own.kind == OWN:
        return np.nan
    try:
        return slope(solution, partial(own.at, stated), value, own.size)
    except (InputError, NotComparableError):
        return np.nan


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
    """Parameters of a user."""
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
    """Raise `InputError` where differences of load factors would show no derivative.

    The mechanism of a Coulomb state may carry a range of them, and states of soils may be certified
    to a bar that is no finer than what is looked for.
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
