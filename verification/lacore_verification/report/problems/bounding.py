"""Analyses of the load factor itself: bounds, ranges, safety, and range of a mechanism."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import inf, isfinite, isinf, isnan
from typing import Any

import lacore as la
from lacore.bounds.enclosing import has_coulomb
from lacore.bounds.static_model import require_cohesion
from lacore.reporting import views
from lacore.reporting.findings import texts
from lacore.reporting.showing import counted
from lacore.reporting.text import Reader
from lacore.reporting.units import Units
from lacore_verification.report.problems.asking import Analysis, Given, Question

_SAME = 1e-6  # of a load factor: closer ends of an interval are equal


@dataclass(frozen=True)
class DeadLoads:
    """Stability of the dead loads, and whether the reasons are reported elsewhere."""

    stability: la.Stability
    brief: bool


def _may_choose(state: la.LimitState) -> bool:
    """Return whether a mechanism may carry several load factors, and its backend can prove them."""
    if state.status is not la.Status.SOLVED or not has_coulomb(state.discretisation.problem):
        return False
    return not la.find_backend(state.backend).capabilities.regularised


def _interval(found: la.Interval, units: Units) -> str:
    """Describe the load factors at which the mechanism of a state is possible."""
    note = "" if found.exact else "; ends as found, not proven"
    if isinf(found.high):
        return f"this mechanism is possible at all load factors from {found.low:.6g}{note}"
    if found.high - found.low <= _SAME * abs(found.high):
        return f"this mechanism is possible only at the load factor {found.high:.6g}{note}"
    ends = f"{found.low:.6g} to {found.high:.6g}"
    return f"this mechanism is possible at load factors from {ends}{note}"


def _bracket(given: Given) -> la.Bracket:
    own = given.question
    assert own.bracket is not None  # It is requested by its width.

    def on_step(step: Any) -> None:
        given.tell(f"{step.lower:.5g} to {step.upper:.5g}, {step.elements} elements")

    return la.bracket(given.problem, own.bracket, backend=own.backend, on_step=on_step)


def _safety(given: Given) -> la.SafetyFactor:
    own = given.question
    return la.safety_factor(given.problem, interfaces=own.interfaces, backend=own.backend)


def _range_said(found: la.LoadFactorRange, units: Units) -> str:
    return found.facts_for(Reader(units, files=True)).title


def _safety_said(found: la.SafetyFactor, units: Units) -> str:
    ends = found.facts().title
    return "; ".join(filter(None, (ends, texts(found.findings, Reader(units, files=True)))))


def _range(given: Given) -> la.LoadFactorRange:
    problem, backend = given.problem, given.question.backend
    if _is_soil(problem):
        return la.soil_range(problem, backend, on_progress=_found_so_far(given, "load_factor"))
    return la.coulomb_range(problem, backend, on_progress=_found_so_far(given, "low", "high"))


def _is_soil(problem: la.Problem) -> bool:
    return la.discretise(problem).program.frictional


def _found_so_far(given: Given, *columns: str) -> Callable[[Mapping[str, Any]], None]:
    """Return a function that reports the lowest and the highest load factor of rows so far."""
    rows: list[Mapping[str, Any]] = []

    def progress(row: Mapping[str, Any]) -> None:
        rows.append(row)
        found = [one[name] for one in rows for name in columns if not isnan(one[name])]
        ends = f"{min(found):.5g} to {max(found):.5g}" if found else "none yet"
        given.tell(f"{ends}, {counted(len(rows), 'state')}")

    return progress


def _safety_call(question: Question, problem: la.Problem) -> str:
    divided = "interfaces=True, " * question.interfaces
    return f'la.safety_factor(problem, {divided}backend="{question.backend}")'


def _range_call(question: Question, problem: la.Problem) -> str:
    function = "soil_range" if _is_soil(problem) else "coulomb_range"
    return f'la.{function}(problem, backend="{question.backend}")'


def _dead_loads_said(found: DeadLoads, units: Units) -> str:
    own = found.stability
    return own.proven if found.brief else own.text_for(Reader(units, files=True))


def _require_cohesion(problem: la.Problem) -> None:
    """Raise `InputError` for bodies of which no lower bound can be proven."""
    assembled = la.discretise(problem)
    for name, own in assembled.continua.items():
        require_cohesion(name, own.body, assembled.full.dead_load)


def _require_safety(problem: la.Problem) -> None:
    """Raise `InputError` for problems whose factor of safety would follow from such a bound."""
    if not has_coulomb(problem) and not _is_soil(problem):
        _require_cohesion(problem)


BOUNDING: Mapping[str, Analysis] = {
    "interval": Analysis(
        doing="computing at which load factors the mechanism is possible",
        ask=lambda given: given.state.interval(),
        automatic=_may_choose,
        binding=True,
        said=_interval,
        document=lambda found, units: {"low": found.low, "high": found.high, "exact": found.exact},
    ),
    "bracket": Analysis(
        title="Lower and upper bound",
        doing="computing bounds",
        ask=_bracket,
        require=_require_cohesion,
        binding=True,
        good=lambda found: found.width <= found.target_width,
        said=lambda found, units: found.heading,
        caption=lambda found: (
            "Contributions of the elements to the distance of the bounds"
            if isfinite(found.width)
            else ""
        ),
        document=lambda found, units: {
            "lower": found.lower,
            "upper": found.upper,
            "width": found.width,
            "strict": found.strict,
            "status": found.status.label,
            "failure": texts(found.failures, Reader(units, files=True)),
        },
        script=lambda question, _: (
            f'la.bracket(problem{question.width}, backend="{question.backend}")'
        ),
        table=lambda found: found.history,
        table_title=lambda found: "Solves",
        drawn=lambda found, units: views.picture(found, units=units),
    ),
    "safety": Analysis(
        title="Factor of safety",
        doing="computing the factor of safety",
        ask=_safety,
        require=_require_safety,
        binding=True,
        exact=True,
        good=lambda found: not isnan(found.width),
        said=_safety_said,
        document=lambda found, units: {
            "lower": found.lower,
            "upper": found.upper,
            "proven": found.proven,
            "interfaces": found.interfaces,
        },
        script=_safety_call,
        table=lambda found: found.history,
        table_title=lambda found: "Intermediate states" if found.states else "Intermediate bounds",
    ),
    "range": Analysis(  # after those that take less time
        title="Range of load factors",
        doing="searching for other load factors",
        ask=_range,
        binding=True,
        exact=True,
        good=lambda found: found.lowest is not None,
        said=_range_said,
        document=lambda found, units: {
            "low": found.low,
            "high": found.high,
            "proven": list(found.bracket),
            "sampled": list(found.sampled),
            "status": found.status.label,
            "stopped": found.stopped,
        },
        script=_range_call,
        facts=lambda found, units: found.facts_for(Reader(units, files=True)).told,
        table=lambda found: found.states,
        table_title=lambda found: "Sample of states" if found.sampled else "States found",
    ),
}
AFTER: Mapping[str, Analysis] = {
    "dead_loads": Analysis(
        doing="checking the dead loads",
        ask=lambda given: DeadLoads(given.state.stability(), "stable" in given.question.analyses),
        automatic=lambda state: bool(state.discretisation.problem.dead_loads),
        binding=True,
        said=_dead_loads_said,
        document=lambda found, units: {
            "standing": found.stability.standing.label,
            "low": found.stability.low,
            "high": found.stability.high,
        },
    ),
}


def proven_bracket(results: Mapping[str, Any]) -> la.Bracket | None:
    """Return the bracket among the results of analyses, if both of its bounds are proven."""
    found = results.get("bracket")  # a text if there is none
    return found if isinstance(found, la.Bracket) and 0 <= found.width < inf else None
