"""Load factors along a parameter: each asked once, kept where that is wanted."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf, isnan, nan
from pathlib import Path
from typing import Any

import pandas as pd

from lacore.analyses.kept import LoadFactorRecord, digest, keep, recall
from lacore.analyses.proven_values import error, proven_value
from lacore.analyses.stable import stable
from lacore.assembly.discretisation import Discretisation
from lacore.assembly.discretise import discretise
from lacore.assembly.loading import NoPowerError
from lacore.limit.solve import solve
from lacore.limit.state import LimitState
from lacore.model.problem.problem import Problem
from lacore.reporting.errors import InputError, is_number
from lacore.reporting.showing import counted
from lacore.reporting.status import Status

ProblemAt = Callable[[float], Problem]
_OF_DEAD = {  # by whether they are carried alone
    True: LoadFactorRecord(inf, 0.0, Status.LOCKED.label, nan, 0.0),
    False: LoadFactorRecord(-inf, 0.0, Status.UNSAFE.label, nan, 0.0),
    None: LoadFactorRecord(nan, nan, Status.NOT_CERTIFIED.label, nan, 0.0),
}
COLUMNS = ["parameter", "load_factor", "error", "status", "residual", "seconds", "kept"]
PROBLEM_AT = "give a function of a value that returns the problem at it"


@dataclass
class Along:
    """Load factors of the problems that belong to values of a parameter.

    Attributes:
        problem_at: the problem at a value.
        given: what `lacore.solve` is given.
        folder: where they are kept; None: nowhere.
        assembled: makes of a problem what is solved.
        on_value: called with each value and its load factor as it is found.
        rows: what was asked, by value.
        states: those that were solved here, by value.
    """

    problem_at: ProblemAt
    given: Mapping[str, Any]
    folder: Path | None = None
    assembled: Callable[[Problem], Discretisation] = discretise
    on_value: Callable[[float, float], None] | None = None
    rows: dict[float, dict[str, Any]] = field(default_factory=dict)
    states: dict[float, LimitState] = field(default_factory=dict)

    def ask(self, values: Sequence[float]) -> list[float]:
        """Load factors at values, NaN where none is certified; those that are new are solved."""
        asked = [float(value) for value in dict.fromkeys(values) if float(value) not in self.rows]
        assembled = {value: self._assembled(value) for value in asked}
        for value, problem in assembled.items():
            if problem is None:
                self._note(value, self._without_power(value), kept=False)
            else:
                self._recall(value, problem)
        return [self.rows[float(value)]["load_factor"] for value in values]

    def _recall(self, value: float, problem: Discretisation) -> None:
        """Note what was kept of the problem at a value, or solve it and keep what is found."""
        name = digest(problem.program, self.given) if self.folder else ""
        known = recall(self.folder, name) if self.folder else None
        if known is not None:
            self._note(value, known, kept=True)
            return
        state = solve(problem, **self.given)
        seconds = state.build_time + state.solve_time
        residual = nan if state.certificate is None else state.certificate.worst[1]
        found = LoadFactorRecord(
            proven_value(state), error(state), state.status.label, residual, seconds
        )
        self.states[value] = state
        self._note(value, found, kept=False)
        if self.folder and not isnan(found.value):
            keep(self.folder, name, found)

    def error_at(self, value: float) -> float:
        """Of the load factor at a value that was asked."""
        return float(self.rows[value]["error"])

    def state_if(self, value: float) -> LimitState | None:
        """The state at a value, solved where only its number was kept; None without power."""
        if value not in self.states and (problem := self._assembled(value)) is not None:
            self.states[value] = solve(problem, **self.given)
        return self.states.get(value)

    @property
    def table(self) -> pd.DataFrame:
        """All that was asked, by value."""
        rows = [self.rows[value] for value in sorted(self.rows)]
        return pd.DataFrame(rows, columns=COLUMNS)

    def discretised(self, value: float) -> Discretisation:
        """The problem at a value, assembled; errors name the value."""
        try:
            return self.assembled(self.problem_at(value))
        except InputError as wrong:
            field = f"problem_at({value:.7g}): {wrong.field}"
            raise type(wrong)(field, wrong.value, wrong.reason, wrong.fix) from None

    def _assembled(self, value: float) -> Discretisation | None:
        """The problem at a value; None where supports take the whole load, as below a wheel."""
        try:
            return self.discretised(value)
        except NoPowerError:
            return None

    def _without_power(self, value: float) -> LoadFactorRecord:
        """What the dead loads alone decide, where supports take the others whatever their size."""
        problem = self.problem_at(value)
        if not problem.dead_loads:
            return _OF_DEAD[True]
        given = {name: self.given[name] for name in ("backend", "options") if name in self.given}
        try:
            return _OF_DEAD[stable(problem.with_loads(problem.dead_loads), **given).stands]
        except NoPowerError:  # they take these, too
            return _OF_DEAD[True]

    def _note(self, value: float, found: LoadFactorRecord, kept: bool) -> None:
        self.rows[value] = {
            "parameter": value,
            "load_factor": found.value,
            "error": found.error,
            "status": found.status,
            "residual": found.residual,
            "seconds": found.seconds,
            "kept": kept,
        }
        if self.on_value is not None:
            self.on_value(value, found.value)


def solved_by(table: pd.DataFrame, seconds: float) -> str:
    """In words how many load factors of a table were solved, in what time, and how many kept."""
    kept = int(table["kept"].sum())
    solves = f"{counted(len(table) - kept, 'solve')} in {seconds:.3g} s"
    return f"{solves}, {kept} kept" if kept else solves


def read_range(within: tuple[float, float]) -> tuple[float, float]:
    """Two ends of a parameter.

    Raises:
        InputError: they are none.
    """
    pair = isinstance(within, Sequence) and len(within) == 2 and all(map(is_number, within))
    if not pair or not within[0] < within[1]:
        raise InputError(
            "within", within, "not a range", "give (low, high), two numbers with low < high"
        )
    return float(within[0]), float(within[1])
