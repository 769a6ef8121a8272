"""Load factors along a parameter, each computed once, and stored on request."""

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
OF_DEAD = {  # by whether they are carried alone
    True: LoadFactorRecord(inf, 0.0, Status.LOCKED.label, nan, 0.0),
    False: LoadFactorRecord(-inf, 0.0, Status.UNSAFE.label, nan, 0.0),
    None: LoadFactorRecord(nan, nan, Status.NOT_CERTIFIED.label, nan, 0.0),
}
COLUMNS = ["parameter", "load_factor", "error", "status", "residual", "seconds", "kept"]
PROBLEM_AT = "give a function of a value that returns the problem at it"


@dataclass
class Along:
    """Load factors of the problems at values of a parameter.

    Attributes:
        problem_at: function that returns the problem at a value.
        given: arguments of `lacore.solve`.
        folder: folder of stored results; None: they are not stored.
        assembled: assembles a problem.
        on_value: called with each value and its load factor.
        by_dead: results where no load factor is certified, by whether the dead loads are carried
            alone.
        rows: results by value.
        states: states that were solved here, by value.
    """

    problem_at: ProblemAt
    given: Mapping[str, Any]
    folder: Path | None = None
    assembled: Callable[[Problem], Discretisation] = discretise
    on_value: Callable[[float, float], None] | None = None
    by_dead: Mapping[bool | None, LoadFactorRecord] = field(default_factory=dict)
    rows: dict[float, dict[str, Any]] = field(default_factory=dict)
    states: dict[float, LimitState] = field(default_factory=dict)

    def ask(self, values: Sequence[float]) -> list[float]:
        """Return load factors at values, NaN if none is certified; new ones are solved."""
        asked = [float(value) for value in dict.fromkeys(values) if float(value) not in self.rows]
        assembled = {value: self._assembled(value) for value in asked}
        for value, problem in assembled.items():
            if problem is None:
                self._note(value, self._without_power(value), kept=False)
            else:
                self._recall(value, problem)
        return [self.rows[float(value)]["load_factor"] for value in values]

    def _recall(self, value: float, problem: Discretisation) -> None:
        """Read the stored result at a value, or solve the problem and store it."""
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
        if isnan(found.value) and self.by_dead:
            found = self.by_dead[self._stands(self.problem_at(value))]
        self._note(value, found, kept=False)
        if self.folder and not isnan(found.value):
            keep(self.folder, name, found)

    def error_at(self, value: float) -> float:
        """Return the error of the load factor at a computed value."""
        return float(self.rows[value]["error"])

    def state_if(self, value: float) -> LimitState | None:
        """Return the state at a value, solved if only its number was stored; None without power."""
        if value not in self.states and (problem := self._assembled(value)) is not None:
            self.states[value] = solve(problem, **self.given)
        return self.states.get(value)

    @property
    def table(self) -> pd.DataFrame:
        """All results, by value."""
        rows = [self.rows[value] for value in sorted(self.rows)]
        return pd.DataFrame(rows, columns=COLUMNS)

    def discretised(self, value: float) -> Discretisation:
        """Return the assembled problem at a value; errors name the value."""
        try:
            return self.assembled(self.problem_at(value))
        except InputError as wrong:
            field = f"problem_at({value:.7g}): {wrong.field}"
            raise type(wrong)(field, wrong.value, wrong.reason, wrong.fix) from None

    def _assembled(self, value: float) -> Discretisation | None:
        """Return the problem at a value; None if supports take the whole load, as below a wheel."""
        try:
            return self.discretised(value)
        except NoPowerError:
            return None

    def _without_power(self, value: float) -> LoadFactorRecord:
        """Return the result for the dead loads alone, if supports take the other loads."""
        problem = self.problem_at(value)
        return OF_DEAD[self._stands(problem)]

    def _stands(self, problem: Problem) -> bool | None:
        """Return whether the dead loads are carried alone; None if that is not proven."""
        if not problem.dead_loads:
            return True
        given = {name: self.given[name] for name in ("backend", "options") if name in self.given}
        try:
            return stable(problem.with_loads(problem.dead_loads), **given).stands
        except NoPowerError:  # Supports take these, too.
            return True

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
    """Return a text on the number of solves in a table, their time, and stored results."""
    kept = int(table["kept"].sum())
    solves = f"{counted(len(table) - kept, 'solve')} in {seconds:.3g} s"
    return f"{solves}, {kept} kept" if kept else solves


def read_range(within: tuple[float, float]) -> tuple[float, float]:
    """Return two ends of a parameter.

    Raises:
        InputError: they are invalid.
    """
    pair = isinstance(within, Sequence) and len(within) == 2 and all(map(is_number, within))
    if not pair or not within[0] < within[1]:
        raise InputError(
            "within", within, "not a range", "give (low, high), two numbers with low < high"
        )
    return float(within[0]), float(within[1])
