"""Analyses in addition to the load factor: their input, and how their results are shown."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any

import pandas as pd

import lacore as la
from lacore import views
from lacore.conditions.loads import Load
from lacore.files.problem.varied import Varied
from lacore.reporting.units import Units

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Given:
    """The input of an analysis.

    Attributes:
        state: of all reference loads.
        places: of the reference loads of each case.
        backend, coupling: that solve it.
        bracket: width that each case, or direction, is proven to; None: none is.
        varied: number of the file that varies, if there is one.
        target: load factor that is looked for along it.
        tell: says how far it is.
    """

    state: la.LimitState
    places: Mapping[str, Sequence[int]]
    backend: str
    coupling: str | None
    bracket: float | None
    varied: Varied | None
    target: float
    tell: Callable[[str], None]

    @property
    def problem(self) -> la.Problem:
        """As it is stated."""
        return self.state.discretisation.problem

    @property
    def cases(self) -> dict[str, Sequence[Load]]:
        """Reference loads by case."""
        loads = self.problem.reference_loads
        return {name: [loads[place] for place in own] for name, own in self.places.items()}


@dataclass(frozen=True)
class More:
    """An analysis of a problem in addition to its load factor.

    Attributes:
        title: of its section.
        doing: what is said on the way.
        ask: the answer.
        good: whether that is certified.
        said: it in a line.
        caption: of its picture.
        document: its numbers.
        script: the call that asks it.
        table: of it, if there is one.
        cases: least and largest number of cases that it takes.
        takes: the same in words.
        dead: whether it is about dead loads.
        varies: whether it is about a number that varies.
        told: the answer in some units.
        drawn: its picture in these.
    """

    title: str
    doing: str
    ask: Callable[[Given], Any]
    good: Callable[[Any], bool]
    said: Callable[[Any], str]
    caption: Callable[[Any], str]
    document: Callable[[Any], dict[str, Any]]
    script: Callable[[str, str], str]
    table: Callable[[Any], pd.DataFrame] | None = None
    cases: tuple[float, float] = (0, inf)
    takes: str = ""
    dead: bool = False
    varies: bool = False
    told: Callable[[Any, Units], Any] = lambda found, units: found
    drawn: Callable[[Any, Units], "Figure"] = lambda found, units: views.picture(found)
