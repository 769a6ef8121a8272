"""Analyses of a varied number of the file: critical values, limits, worst positions."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import pandas as pd

import lacore as la
from lacore.analyses.critical import Search
from lacore.files.problem.varied import Varied
from lacore.reporting import views
from lacore.reporting.findings import texts
from lacore.reporting.units import Units
from lacore_verification.report.problems.asking import Analysis, Given

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SIDES = {True: ("below", "above"), False: ("above", "below")}
Answered = TypeVar("Answered", la.Critical, la.WorstPosition)


@dataclass(frozen=True)
class Along(Generic[Answered]):
    """Result along a number of a file.

    Attributes:
        found: the result, with the number in `unit`.
        name: name of the number.
        unit: unit of the number; may be empty.
    """

    found: Answered
    name: str
    unit: str

    @property
    def label(self) -> str:
        """``bodies.arch.thickness [mm]``."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def at(self, value: float, digits: int = 7) -> str:
        """Return a value as text, such as ``0.3 m``."""
        return f"{value:.{digits}g} {self.unit}".rstrip()


def _critical(given: Given) -> Along[la.Critical]:
    varied = _varied(given)
    found = la.critical(
        varied.problem,
        (varied.low, varied.high),
        target=given.question.target,
        backend=given.question.backend,
        coupling=given.question.coupling,
        on_value=_telling(given),
    )
    return Along(found, varied.name, varied.unit)


def _limit(given: Given) -> Along[la.Critical]:
    varied = _varied(given)
    ends = varied.low, varied.high
    found = la.limit_thickness(
        varied.problem, ends, backend=given.question.backend, on_value=_telling(given)
    )
    return Along(found, varied.name, varied.unit)


def _worst(given: Given) -> Along[la.WorstPosition]:
    varied = _varied(given)
    found = la.worst_position(
        varied.problem,
        (varied.low, varied.high),
        backend=given.question.backend,
        coupling=given.question.coupling,
        on_value=_telling(given),
    )
    return Along(found, varied.name, varied.unit)


def _varied(given: Given) -> Varied:
    assert given.question.varied is not None  # It is checked before anything is solved.
    return given.question.varied


def _telling(given: Given) -> Callable[[float, float], None]:
    return lambda value, load_factor: given.tell(f"{load_factor:.5g} at {value:.5g}")


def _critical_in(own: Along[la.Critical], units: Units) -> Along[la.Critical]:
    size = units.size(own.unit)
    crossings = tuple(
        replace(one, low=one.low / size, high=one.high / size) for one in own.found.crossings
    )
    found = replace(own.found, crossings=crossings, table=_scaled(own.found.table, size))
    return Along(found, own.name, units.label(own.unit))


def _worst_in(own: Along[la.WorstPosition], units: Units) -> Along[la.WorstPosition]:
    size, found = units.size(own.unit), own.found
    found = replace(
        found,
        position=found.position / size,
        spacing=found.spacing / size,
        table=_scaled(found.table, size),
    )
    return Along(found, own.name, units.label(own.unit))


def _scaled(table: pd.DataFrame, size: float) -> pd.DataFrame:
    return table.assign(parameter=table["parameter"] / size)


def _crossed(own: Along[la.Critical], units: Units) -> str:
    """Describe a critical value, and what is proven at both ends of its interval."""
    found = own.found
    if found.first is None:
        return f"{found.status.label}: {found.message}"
    before, after = _SIDES[found.first.rises]
    said = (
        f"{own.name} = {own.at(found.value)}: at {own.at(found.low, 10)} the load factor is"
        f" {before} {found.target:g}, at {own.at(found.high, 10)} {after}, {_proof(found)}"
    )
    return said + _others(found)


def _stands(own: Along[la.Critical], units: Units) -> str:
    """Describe the limit at which the dead loads are just carried."""
    found = own.found
    if found.first is None:
        return f"{found.status.label}: {found.message}"
    before, after = ("collapses", "stands") if found.first.rises else ("stands", "collapses")
    said = (
        f"{own.name} = {own.at(found.value)}: the structure {before} at"
        f" {own.at(found.low, 10)} and {after} at {own.at(found.high, 10)}, {_proof(found)}"
    )
    return said + _others(found)


def _proof(found: la.Critical) -> str:
    """Return what the certificates at both ends prove."""
    state = found.at_low or found.at_high
    if state is not None and state.discretisation.continua:
        return "both certified on this mesh; for the continuum, this is an estimate"
    return "both certified"


def _others(found: la.Critical) -> str:
    """Return further findings."""
    more = texts(found.findings)
    return f"; {more}" if more else ""


def _least(own: Along[la.WorstPosition], units: Units) -> str:
    found = own.found
    place = f"{own.name} = {own.at(found.position, 5)}"
    return f"load factor {found.load_factor:.6g} at {place}, {found.message}"


def _numbers(own: Along[Any]) -> dict[str, Any]:
    return {"parameter": own.name, "unit": own.unit, "table": own.found.table.to_dict("records")}


def _crossings(own: Along[la.Critical], units: Units) -> dict[str, Any]:
    """Return the results as a document."""
    found = own.found
    crossings = [
        {
            "value": one.value,
            "low": one.low,
            "high": one.high,
            "rises": one.rises,
            "status": one.status.label,
        }
        for one in found.crossings
    ]
    said = {"status": found.status.label, "target": found.target, "load_factor_of": found.of}
    return {**said, "value": found.value, "crossings": crossings, **_numbers(own)}


def _position(own: Along[la.WorstPosition], units: Units) -> dict[str, Any]:
    found = own.found
    said = {"position": found.position, "load_factor": found.load_factor, "spacing": found.spacing}
    return {**said, **_numbers(own)}


def _drawn(own: Along[Any], units: Units) -> "Figure":
    return views.picture(own.found, own.label)


_BY = "problem_at, within"
VARYING: Mapping[str, Analysis] = {
    "critical": Analysis(
        title="Critical value",
        doing="searching for the critical value",
        ask=_critical,
        good=lambda own: own.found.status is Search.FOUND,
        said=_crossed,
        caption=lambda own: f"Load factor along {own.name}",
        document=_crossings,
        script=lambda question, _: (
            f'la.critical({_BY}, target=target, backend="{question.backend}")'
        ),
        table=lambda own: own.found.table,
        varies=True,
        told=_critical_in,
        drawn=_drawn,
    ),
    "limit": Analysis(
        title="Limit of standing under the dead loads",
        doing="searching for the limit",
        ask=_limit,
        good=lambda own: own.found.status is Search.FOUND,
        said=_stands,
        caption=lambda own: (
            f"Factor of the dead loads along {own.name}: the structure stands above 1"
        ),
        document=_crossings,
        script=lambda question, _: f'la.limit_thickness({_BY}, backend="{question.backend}")',
        table=lambda own: own.found.table,
        dead=True,
        varies=True,
        told=_critical_in,
        drawn=_drawn,
    ),
    "worst": Analysis(
        title="Worst position",
        doing="searching for the worst position",
        ask=_worst,
        good=lambda own: own.found.load_factor == own.found.load_factor and not own.found.failed,
        said=_least,
        caption=lambda own: f"Load factor along {own.name}",
        document=_position,
        script=lambda question, _: f'la.worst_position({_BY}, backend="{question.backend}")',
        table=lambda own: own.found.table,
        varies=True,
        told=_worst_in,
        drawn=_drawn,
    ),
}
"""Analyses by the key in ``[solve]``, which is that of the option."""
