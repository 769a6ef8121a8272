"""`critical`: the value of a parameter at which a structure just carries its loads."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from itertools import pairwise
from math import isnan, nan
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from lacore.analyses.along import PROBLEM_AT, Along, read_range, solved_by
from lacore.analyses.kept import folder_of
from lacore.limit.state import LimitState
from lacore.model.problem.problem import Problem
from lacore.reporting import views
from lacore.reporting.errors import InputError, is_number, require_positive, require_whole, typed
from lacore.reporting.findings import Finding, Message
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Compact, Facts, Picture, listed
from lacore.reporting.status import Reported

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LOAD_FACTOR = "load factor"
_SCANNED = 9  # values between two ends on one side that are checked for a crossing
# factor and number of times by which ends are moved apart if residuals are too large
_WIDEN, _TRIES = 4.0, 8
_MOST = 100  # limit of steps of a search: bisection needs 50 to round-off


class Search(Enum):
    """End of a search for a critical value. Its text says what to do."""

    FOUND = "the load factor is proven to be on either side of the target at the two ends"
    SAME_SIDE = (
        "no change of sides was seen: give a wider range, or more values to scan; that there is"
        " none between them is not proven"
    )
    NOT_CERTIFIED = (
        "at a value on the way no load factor is certified (see the table): take another backend,"
        " or a range without it"
    )
    NOT_SEPARATED = (
        "residuals are too large to prove on which side values near the critical one lie: tighten"
        " the tolerance of the backend, or take a larger one here"
    )

    @property
    def label(self) -> str:
        """The name as shown in tables: ``same side``."""
        return self.name.lower().replace("_", " ")

    def report(self, findings: tuple[Finding, ...]) -> Message:
        """Return the text of this ending with findings, to be rendered for a reader."""
        return Message("", self.value, findings)


@dataclass(frozen=True, repr=False)
class Crossing(Compact):
    """Range of a parameter whose ends have load factors on different sides of the target.

    Attributes:
        low, high: its ends, within the tolerance if it was narrowed down, else the values at which
            the change was detected.
        rises: whether the load factor rises through the target.
        status: whether it was narrowed down, and if not, why.
        at_low, at_high: states at its ends; None if supports take the whole load there.
    """

    low: float
    high: float
    rises: bool
    status: Search
    at_low: LimitState | None = field(default=None, repr=False)
    at_high: LimitState | None = field(default=None, repr=False)

    @property
    def value(self) -> float:
        """The middle of both; NaN where it was not narrowed down."""
        return (self.low + self.high) / 2 if self.status is Search.FOUND else nan


@dataclass(frozen=True, repr=False)
class Critical(Reported):
    """Critical values of a parameter, each between two values with certified sides.

    For deformable bodies it is the side of the discrete problem: load factors differ on finer
    meshes.

    Attributes:
        crossings: all that were detected, by the parameter; there may be more between the computed
            values.
        status: status of the first of them; without any, the reason.
        target: load factor of the crossings.
        of: meaning of `load_factor`.
        table: one row per computed value, in order: ``parameter``, ``load_factor`` (inf if it is
            locked, -inf if the dead loads alone collapse it), its ``error`` by residuals,
            ``status``, ``residual``, ``seconds``, whether it was ``kept`` in the folder.
        solve_time: s, wall clock.
    """

    status: Search
    crossings: tuple[Crossing, ...]
    target: float
    of: str
    table: pd.DataFrame
    solve_time: float

    @property
    def first(self) -> Crossing | None:
        """The one at the least value of the parameter, if it was narrowed down."""
        return self.crossings[0] if self.status is Search.FOUND else None

    @property
    def value(self) -> float:
        """First critical value; NaN if there is none."""
        return self.first.value if self.first else nan

    @property
    def low(self) -> float:
        """Lower end of the first one; NaN if there is none."""
        return self.first.low if self.first else nan

    @property
    def high(self) -> float:
        """Upper end of the first one; NaN if there is none."""
        return self.first.high if self.first else nan

    @property
    def at_low(self) -> LimitState | None:
        """State at the lower end; None if there is none, or supports take the whole load."""
        return self.first.at_low if self.first else None

    @property
    def at_high(self) -> LimitState | None:
        """State at the upper end; None if there is none, or supports take the whole load."""
        return self.first.at_high if self.first else None

    @property
    def rises(self) -> bool | None:
        """Whether the load factor rises through the target there; None without a crossing."""
        return self.first.rises if self.first else None

    @property
    def failed(self) -> tuple[float, ...]:
        """Computed values without a certified load factor."""
        return tuple(self.table["parameter"][self.table["load_factor"].isna()])

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Further crossings, and values without a certified load factor."""
        found = []
        if len(self.crossings) > 1:
            others = ", ".join(_told(own) for own in self.crossings[1:])
            values = {"count": len(self.crossings), "others": others}
            found.append(Finding(Kind.OTHER_CROSSINGS, values=values))
        if self.failed and self.status is not Search.NOT_CERTIFIED:
            places = listed([f"{value:.6g}" for value in self.failed])
            found.append(Finding(Kind.NOT_CERTIFIED_AT, values={"places": places}))
        return tuple(found)

    def facts(self) -> Facts:
        """Return the value, its range, and its proof, for printing."""
        title = f"Critical: {self.status.label}"
        told = {"status": self.message}
        seen = self.table["load_factor"].dropna()
        if self.status is not Search.FOUND and len(seen):
            told["seen"] = f"{seen.min():.6g} to {seen.max():.6g}; {self.target:g} is looked for"
        if self.status is Search.FOUND:
            title = f"Critical: {self.value:.7g}, in [{self.low:.10g}, {self.high:.10g}]"
            by = self.table.set_index("parameter")["load_factor"]
            first, last = (by[end] - self.target for end in (self.low, self.high))
            state = self.at_low or self.at_high
            of = self.of + (state.discretisation.scope.phrase if state else "")
            told["proven"] = f"{self.target:g} {first:+.1e} and {last:+.1e} there, of: {of}"
        told["solved by"] = solved_by(self.table, self.solve_time)
        return Facts(title, told)

    def picture(self) -> Picture:
        """Return the results along the parameter."""
        return Picture(self.plot())

    def plot(self) -> Figure:
        """Plot load factors: see `lacore.pictures.analyses.plot_critical`."""
        return views.picture(self)


@typed(problem_at=PROBLEM_AT)
def critical(
    problem_at: Callable[[float], Problem],
    within: tuple[float, float],
    *,
    target: float = 1.0,
    tolerance: float = 1e-7,
    scan: int = 0,
    backend: str = "auto",
    coupling: str | None = None,
    options: Mapping[str, Any] | None = None,
    folder: str | Path | None = None,
    on_value: Callable[[float, float], None] | None = None,
) -> Critical:
    """Search for the values of a parameter at which the load factor is the target.

    No assumption is made on the dependence of the load factor on the parameter. The results are
    narrow ranges whose certified ends lie on different sides of the target, one for each change of
    sides between computed values. Load factors of meshes that change with the parameter jump
    slightly, which may change the sides.

    Args:
        problem_at: function that returns the problem at a value.
        within: range of the search, (low, high).
        target: load factor.
        tolerance: width of the result, by the larger of the two ends.
        scan: number of values between the ends that are computed first, to detect more than one
            change of sides; 9 if both ends are on one side.
        backend, coupling, options: see `lacore.solve`.
        folder: folder in which load factors are stored for later runs; None: they are not stored.
        on_value: called with each value and its load factor, for progress.

    Raises:
        InputError: an invalid range; an invalid problem, with its value; anything that `solve`
            rejects.
        CapabilityError: the backend is missing, or does not support a problem.

    Example:
        >>> columns = lambda width: la.examples.column(friction=0.9, width=width)
        >>> found = la.critical(columns, within=(0.2, 1.5), target=0.4)
        >>> round(found.value, 4)  # it tips at width/2
        0.8
    """
    if not is_number(target):
        raise InputError("target", target, "not a load factor", "give a finite number")
    low, high = read_range(within)
    given = {"backend": backend, "coupling": coupling, "options": options}
    along = Along(problem_at, given, folder_of(folder), on_value=on_value)
    return crossing(along, low, high, target, tolerance, scan)


def crossing(
    along: Along,
    low: float,
    high: float,
    target: float,
    tolerance: float,
    scan: int = 0,
    of: str = LOAD_FACTOR,
) -> Critical:
    """Return the search of `critical` for the values of `along`."""
    begin = time.perf_counter()
    require_positive("tolerance", tolerance)
    require_whole("scan", scan)
    seen = _Seen(along, target)
    values = [low, *np.linspace(low, high, scan + 2)[1:-1].tolist(), high]
    along.ask(values)
    if not scan and seen.same_side(low, high):
        values = np.linspace(low, high, _SCANNED + 2).tolist()
        along.ask(values)
    changes = seen.changes(values)
    within = tolerance * max(abs(low), abs(high))
    crossings = tuple(seen.crossing(*change, within) for change in changes)
    status = Search.SAME_SIDE
    if any(isnan(seen.side(value)) for value in values):
        status = Search.NOT_CERTIFIED
    return Critical(
        status=crossings[0].status if crossings else status,
        crossings=crossings,
        target=float(target),
        of=of,
        table=along.table,
        solve_time=time.perf_counter() - begin,
    )


class _Seen:
    """Proven sides of a target."""

    def __init__(self, along: Along, target: float) -> None:
        self.along, self.target = along, float(target)

    def side(self, value: float) -> float:
        """Return -1 or 1 if that is proven; 0 within the error; NaN if nothing is certified."""
        above = self.along.ask([value])[0] - self.target
        if isnan(above):
            return nan
        return float(np.sign(above)) if abs(above) > self.along.error_at(value) else 0.0

    def same_side(self, one: float, other: float) -> bool:
        return self.side(one) == self.side(other) != 0

    def changes(self, values: list[float]) -> list[tuple[float, float]]:
        """Return the neighbours on different sides, among values with a proven side."""
        told = [value for value in values if abs(self.side(value)) == 1]
        return [(a, b) for a, b in pairwise(told) if self.side(a) != self.side(b)]

    def crossing(self, low: float, high: float, within: float) -> Crossing:
        """Return a change of sides, narrowed down as far as certificates allow."""
        rises = self.side(low) < self.side(high)
        status, ends = self._searched(low, high, within)
        if ends is None:
            return Crossing(low, high, rises, status)
        states = (self.along.state_if(end) for end in ends)
        return Crossing(*ends, rises, status, *states)

    def _searched(
        self, low: float, high: float, within: float
    ) -> tuple[Search, tuple[float, float] | None]:
        """Return how a search for a change of sides ended, and the closest proven values."""
        # imported here because it takes 0.3 s to load, and most solves do not need it
        from scipy.optimize import toms748

        try:
            root = float(
                toms748(self._bounded, low, high, xtol=within / _WIDEN, maxiter=_MOST, disp=False)
            )
        except _NoNumberError:
            return Search.NOT_CERTIFIED, None
        first = self.side(low)
        ends: list[float] = []
        for sign, last, wanted in ((-1.0, low, first), (1.0, high, -first)):
            away = within / 2
            for _ in range(_TRIES):
                value = float(np.clip(root + sign * away, low, high))
                if self.side(value) == wanted or value == last:
                    break
                away *= _WIDEN
            ends.append(value)
        if self.side(ends[0]) == first and self.side(ends[1]) == -first:
            return Search.FOUND, (ends[0], ends[1])
        return Search.NOT_SEPARATED, None

    def _bounded(self, value: float) -> float:
        """Return the difference to the target, mapped to (-1, 1), as it may be infinite."""
        above = self.along.ask([value])[0] - self.target
        if isnan(above):
            raise _NoNumberError
        return float(np.sign(above)) if np.isinf(above) else above / (self._scale + abs(above))

    @property
    def _scale(self) -> float:
        return abs(self.target) or 1.0


def _told(own: Crossing) -> str:
    if own.status is Search.FOUND:
        return f"{own.value:.7g}"
    return f"in [{own.low:.6g}, {own.high:.6g}] ({own.status.label})"


class _NoNumberError(Exception):
    """Raised if a value of the search has no certified load factor."""
