"""Analyses of a problem: what is requested, their input, and how their results are shown."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import TYPE_CHECKING, Any

import pandas as pd

import lacore as la
from lacore.files.problem.varied import Varied
from lacore.model.conditions.loads import Load
from lacore.reporting import views
from lacore.reporting.units import Units

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Question:
    """The analyses that are requested in addition to the load factor.

    Attributes:
        backend, coupling: Solver and iteration method.
        analyses: Names of analyses, see `lacore_verification.report.problems.more.ANALYSES`.
        bracket: Width of brackets; None: no bounds are computed.
        interfaces: Whether the factor of safety also divides friction of interfaces.
        cases: Reference loads by the name of their case, as places in the list of the problem.
        varied: Number of the file that varies; None: none does.
        target: Load factor to search for along it.
    """

    backend: str
    coupling: str | None
    analyses: tuple[str, ...] = ()
    bracket: float | None = None
    interfaces: bool = False
    cases: Mapping[str, Sequence[int]] = field(default_factory=dict)
    varied: Varied | None = None
    target: float = 1.0

    @property
    def width(self) -> str:
        """The width as a further argument of a call in a script."""
        return "" if self.bracket is None else f", target_width={self.bracket!r}"


@dataclass(frozen=True)
class Given:
    """The input of an analysis.

    Attributes:
        state: Limit state of all reference loads.
        question: What is requested.
        tell: Reports progress.
    """

    state: la.LimitState
    question: Question
    tell: Callable[[str], None]

    @property
    def problem(self) -> la.Problem:
        """The problem."""
        return self.state.discretisation.problem

    @property
    def cases(self) -> dict[str, Sequence[Load]]:
        """Reference loads by case."""
        loads = self.problem.reference_loads
        return {name: [loads[place] for place in own] for name, own in self.question.cases.items()}


@dataclass(frozen=True)
class Analysis:
    """An analysis of a problem in addition to its load factor.

    Attributes:
        doing: Progress message.
        ask: Returns the result.
        said: Returns the result as one line, in the units of the file.
        document: Returns the numbers of the result.
        good: Whether the result is certified.
        automatic: Whether it is made of a state without being requested; None: only on request.
        require: Raises `InputError` for problems that it rejects, before the first solve.
        binding: Whether invalid input ends the command, after the other results are printed.
        exact: Whether it needs an exact backend.
        title: Title of its section; empty: no section.
        caption: Caption of its picture; empty: no picture.
        facts: Facts that its section lists.
        table: Table of its section; None: no table.
        table_title: Title of the table; empty: that of the section.
        script: Call in a script; None: none.
        cases: Smallest and largest number of load cases.
        takes: The same as text.
        dead: Whether it needs dead loads.
        varies: Whether it needs a number that varies.
        told: Result in the units of the file.
        drawn: Picture of the result, in these units.
    """

    doing: str
    ask: Callable[[Given], Any]
    said: Callable[[Any, Units], str]
    document: Callable[[Any, Units], dict[str, Any]]
    good: Callable[[Any], bool] = lambda found: True
    automatic: Callable[[la.LimitState], bool] | None = None
    require: Callable[[la.Problem], None] = lambda problem: None
    binding: bool = False
    exact: bool = False
    title: str = ""
    caption: Callable[[Any], str] = lambda found: ""
    facts: Callable[[Any, Units], Mapping[str, str]] = lambda found, units: {}
    table: Callable[[Any], pd.DataFrame] | None = None
    table_title: Callable[[Any], str] = lambda found: ""
    script: Callable[[Question, la.Problem], str] | None = None
    cases: tuple[float, float] = (0, inf)
    takes: str = ""
    dead: bool = False
    varies: bool = False
    told: Callable[[Any, Units], Any] = lambda found, units: found
    drawn: Callable[[Any, Units], "Figure"] = lambda found, units: views.picture(found)
