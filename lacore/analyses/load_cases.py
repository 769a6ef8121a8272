"""`load_cases`: one structure under several loads, and the governing one."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from lacore.analyses.proven_values import proven, proven_value
from lacore.assembly.discretisation import Discretisation
from lacore.assembly.discretise import discretise
from lacore.bounds.bracket.bracket import Bracket
from lacore.bounds.bracket.refine import bracket
from lacore.limit.solve import solve
from lacore.limit.state import LimitState
from lacore.model.conditions.loads import Load
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Bools
from lacore.numerics.threads import each
from lacore.reporting import views
from lacore.reporting.errors import InputError, require_count, require_width, typed
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Facts, Picture, counted, listed
from lacore.reporting.status import Result, Rigor, Status
from lacore.reporting.text import PYTHON
from lacore.solvers.isolation import SolverProcess

Told = Callable[[int, LimitState], None]

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_BY_NAME = "give loads by name, {'wind': [lacore.Traction(...)]}"
_COLUMNS = [
    *("case", "status", "load_factor", "lower", "upper", "rigor", "residual", "seconds"),
    *("governs", "message"),
]


@dataclass(frozen=True, repr=False)
class LoadCases(Result):
    """One structure under several loads, and the governing one.

    Attributes:
        table: one row per case: ``case``, ``status``, ``load_factor`` (inf if it is locked, -inf if
            the dead loads alone collapse it, 0 if it moves freely, NaN if nothing is certified, and
            for a bracket), ``lower`` and ``upper``, proven bounds of every load factor (for a
            continuum those of the continuum; -inf and inf without proof), ``rigor``, largest
            ``residual``, ``seconds``, ``governs``, ``message``.
        results: `LimitState` or `Bracket` of each case, by name.
        governing: the case with the smallest load factor; empty if none is certified.
        sure: whether it is proven to govern: its ``upper`` does not exceed the ``lower`` of any
            other. States of deformable bodies prove no lower bound, nor do states with Coulomb
            friction.
        solve_time: s, wall clock.
    """

    table: pd.DataFrame
    results: Mapping[str, LimitState | Bracket]
    governing: str
    sure: bool
    solve_time: float

    @property
    def failed(self) -> tuple[str, ...]:
        """Cases without a certified load factor."""
        return tuple(self.table["case"][~_known(self.table)])

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Findings: the governing case, whether that is proven, and failed cases."""
        failed = {"cases": listed(self.failed)}
        if not self.governing:
            return (Finding(Kind.NO_CASE, values=failed, severity=Severity.WARNING),)
        case = (self.governing,)
        if self.failed:
            return (Finding(Kind.GOVERNS_OF_CERTIFIED, case, failed, Severity.WARNING),)
        if self.sure:
            return (Finding(Kind.GOVERNS, case),)
        below = self.table["lower"] < self._least["upper"]
        every = list(self.table["case"][below | self.table["governs"]])
        if np.isnan(self._least["load_factor"]):
            named = {"cases": listed([repr(one) for one in every])}
            return (Finding(Kind.ONE_GOVERNS, tuple(every), named, Severity.WARNING),)
        others = {"cases": listed([repr(one) for one in every if one != self.governing])}
        return (Finding(Kind.LEAST_CASE, case, others, Severity.WARNING),)

    @property
    def _least(self) -> pd.Series[Any]:
        return self.table[self.table["governs"]].iloc[0]

    def facts(self) -> Facts:
        """Return the governing case, and its load factor, for printing."""
        title = f"{counted(len(self.table), 'case')}, none is certified"
        if self.governing:
            row = self._least
            size = f"load factor {row['load_factor']:.7g}"
            if np.isnan(row["load_factor"]):
                size = f"{row['lower']:.7g} <= load factor <= {row['upper']:.7g}"
            every = f"lowest of {len(self.table)} load cases, each alone"
            title = f"{self.governing!r} governs: {every}, {size}"
        told = {"status": self.message}
        if self.governing:
            told["rigor"] = str(self._least["rigor"])
        told["cases"] = listed(list(self.table["case"]))
        told["solved by"] = f"{counted(len(self.table), 'case')} in {self.solve_time:.3g} s"
        return Facts(title, told, "LoadCases")

    def picture(self) -> Picture:
        """Return load factors by case."""
        return Picture(self.plot())

    def plot(self) -> Figure:
        """Plot load factors by case: see `lacore.pictures.analyses.plot_load_cases`."""
        return views.picture(self)


@typed(cases=_BY_NAME)
def load_cases(
    problem: Problem,
    cases: Mapping[str, Sequence[Load] | Problem],
    backend: str = "auto",
    *,
    coupling: str | None = None,
    target_width: float | None = None,
    options: Mapping[str, Any] | None = None,
    workers: int = 1,
    on_case: Callable[[str], None] | None = None,
) -> LoadCases:
    """Compute the load factors of a structure under several loads, in one table.

    All cases are assembled before the first is solved. A case without a certified load factor is
    reported, and does not stop the others.

    Args:
        problem: the structure, with its dead loads.
        cases: reference loads of each case by name, instead of those of the problem; or a problem
            if more changes, such as one of `Problem.with_loads`.
        backend: name of a backend.
        coupling: coupling of states, see `lacore.solve`.
        target_width: width of a `lacore.bracket` of each case; None: the state of `lacore.solve`.
        options: options of the backend, for states.
        workers: number of cases solved at a time, for states.
        on_case: called with the name of each case as it ends, for progress.

    Raises:
        InputError: no case; invalid loads, with the name of their case; anything that `solve` and
            `bracket` reject.
        CapabilityError: the backend is missing, or does not support a problem.

    Example:
        >>> cases = {
        ...     "east": [la.BodyForce("column", (1, 0))],
        ...     "at its head": [la.PointForce("column", (0.5, 2), (2, 0))],
        ... }
        >>> la.load_cases(la.examples.column(friction=0.9), cases).governing
        'at its head'
    """
    begin = time.perf_counter()
    require_count("workers", workers)
    stated = _stated(problem, cases)
    tell = on_case or (lambda name: None)
    names = list(stated)
    results: dict[str, LimitState | Bracket] = {}
    if target_width is None:
        given = {"backend": backend, "coupling": coupling, "options": options}
        states = _solved(list(stated.values()), given, workers, lambda k, _: tell(names[k]))
        results = dict(zip(names, states, strict=True))
        rows = [_of_state(name, state) for name, state in zip(names, states, strict=True)]
    else:
        require_width("target_width", target_width)
        if coupling is not None:
            why = "a bracket encloses every load factor, and couples no friction"
            raise InputError("coupling", coupling, why, "leave it out, or `target_width`")
        rows = []
        for name, one in stated.items():
            found = bracket(one.problem, target_width, backend=backend)
            results[name] = found
            rows.append(_of_bracket(name, found))
            tell(name)
    table = pd.DataFrame(rows, columns=_COLUMNS)
    known = table[_known(table)]
    by = known["load_factor"].fillna(known["upper"])
    lent = any(isinstance(own, Bracket) and own.lent for own in results.values())
    governing = str(known["case"].iloc[int(np.argmin(by))]) if len(known) else ""
    table["governs"] = table["case"] == governing
    return LoadCases(
        table=table,
        results=results,
        governing=governing,
        sure=bool(governing) and not lent and _sure(table),
        solve_time=time.perf_counter() - begin,
    )


def _stated(
    problem: Problem, cases: Mapping[str, Sequence[Load] | Problem]
) -> dict[str, Discretisation]:
    """Return all cases, assembled."""
    if not cases:
        raise InputError("cases", cases, "no load case", _BY_NAME)
    stated = {}
    for name, case in cases.items():
        field = f"cases[{name!r}]"
        try:
            own = case if isinstance(case, Problem) else problem.with_loads(reference_loads=case)
            stated[str(name)] = discretise(own)
        except InputError as wrong:
            inner = wrong.field.removeprefix("Problem.")
            raise InputError(f"{field}: {inner}", wrong.value, wrong.reason, wrong.fix) from None
    return stated


def _of_state(name: str, state: LimitState) -> dict[str, Any]:
    lower, upper = proven(state)
    return {
        "case": name,
        "status": state.status.label,
        "load_factor": proven_value(state),
        "lower": lower,
        "upper": upper,
        "rigor": state.rigor.label,
        "residual": np.nan if state.certificate is None else state.certificate.worst[1],
        "seconds": state.build_time + state.solve_time,
        "message": state.report.summary_for(PYTHON),
    }


def _of_bracket(name: str, found: Bracket) -> dict[str, Any]:
    above, below = found.upper_bound.state, found.lower_bound
    status, load_factor = found.status.label, np.nan
    lower, upper = found.lower, found.upper
    # Each status is taken from the bound that proves it, as the other one may follow from its
    # elements alone.
    if above.status in (Status.UNSAFE, Status.FREE):
        status, load_factor, (lower, upper) = above.status.label, proven_value(above), proven(above)
    elif below.status is Status.LOCKED and not found.lent:
        status, load_factor, lower = below.status.label, np.inf, np.inf
    return {
        "case": name,
        "status": status,
        "load_factor": load_factor,
        "lower": lower,
        "upper": upper,
        "rigor": "both bounds strict" if found.strict else Rigor.NOT_CERTIFIED.label,
        "residual": np.nan,
        "seconds": found.history["seconds"].max() if len(found.history) else np.nan,
        "message": found.message,
    }


def _known(table: pd.DataFrame) -> Bools:
    """Return which cases have a load factor, or two that enclose it, shape (cases,)."""
    value, lower, upper = (table[name].to_numpy() for name in ("load_factor", "lower", "upper"))
    enclosed = np.isfinite(lower) & np.isfinite(upper) & (lower <= upper)
    return np.asarray(~np.isnan(value) | enclosed)


def _sure(table: pd.DataFrame) -> bool:
    """Return whether the governing case is proven to be the smallest."""
    if not _known(table).all():
        return False
    least, others = table[table["governs"]].iloc[0], table[~table["governs"]]
    return bool((others["lower"] >= least["upper"]).all())


def _solved(
    problems: Sequence[Discretisation],
    given: Mapping[str, Any],
    workers: int = 1,
    on_state: Told | None = None,
) -> list[LimitState]:
    """Return the limit states of problems, in their order.

    Args:
        problems: assembled problems.
        given: further arguments of `lacore.solve`.
        workers: number of problems solved at a time, each in a separate process. Threads wait for
            the processes, so that problems need not be picklable, and scripts need no guard.
        on_state: called with the number and the state of each as it ends.

    Raises:
        InputError: `workers` is not a positive whole number; anything that `lacore.solve` rejects.
        CapabilityError: see `lacore.solve`.
    """
    require_count("workers", workers)
    tell = on_state or (lambda number, state: None)
    count = min(workers, len(problems))
    processes = [SolverProcess() for _ in range(count)] if count > 1 else []
    idle: SimpleQueue[SolverProcess | None] = SimpleQueue()
    for process in processes:
        idle.put(process)
    if not processes:
        idle.put(None)  # as `lacore.solvers.registry.load_backend` decides

    def one(problem: Discretisation) -> LimitState:
        process = idle.get()
        try:
            return solve(problem, process=process, **given)
        finally:
            idle.put(process)

    found: list[LimitState] = []
    try:
        for number, state in enumerate(each(one, problems, count)):
            found.append(state)
            tell(number, state)
    finally:
        for process in processes:
            process.close()
    return found
