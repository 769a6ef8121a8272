"""The analyses that `lacore solve` makes of a problem, and their results."""

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from math import inf, isnan
from typing import Any

import lacore as la
from lacore.bounds.enclosing import has_coulomb
from lacore.coupling.kinds import COUPLINGS
from lacore.errors import InputError, is_number, require_known, require_width
from lacore.files.problem.reading import Stated
from lacore.files.problem.varied import Varied, read_varied
from lacore.reporting.findings import Finding, Message
from lacore.reporting.text import text
from lacore.showing import counted
from verification.problems.asking import Given
from verification.problems.more import MORE, check

_NARROW = 1e-3  # of a range: below it its ends are one

Status = Callable[[str], AbstractContextManager[Callable[[str], None]]]


@dataclass(frozen=True)
class Question:
    """The analyses that are requested in addition to the load factor.

    Attributes:
        backend, coupling: that solve it.
        bracket: width of a bracket; None: none is asked for.
        range: whether all load factors are searched.
        safety: whether the factor of safety is asked for.
        interfaces: whether that divides friction of interfaces as well.
        more: names of `MORE` that are asked for.
        cases: reference loads by the name of their case, as places in the list of the problem.
        varied: number of the file that varies; None: none does.
        target: load factor that is looked for along it.
    """

    backend: str
    coupling: str | None
    bracket: float | None
    range: bool
    safety: bool
    interfaces: bool = False
    more: tuple[str, ...] = ()
    cases: Mapping[str, Sequence[int]] = field(default_factory=dict)
    varied: Varied | None = None
    target: float = 1.0


@dataclass(frozen=True)
class Answer:
    """What came out.

    Attributes:
        state: the limit state.
        interval: load factors that its mechanism carries; None where there is no choice.
        stability: of the dead loads; None without any.
        bracket, range, safety: as asked for.
        more: answers by their name in `MORE`; a text says why there is none.
        seconds: of all of it.
        advice: on larger domains; see `lacore.advice`.
    """

    state: la.LimitState
    interval: la.Interval | None
    stability: la.Stability | None
    bracket: la.Bracket | None
    range: la.CoulombRange | la.SoilRange | None
    safety: la.SafetyFactor | None
    more: Mapping[str, Any]
    seconds: float
    advice: tuple[Finding, ...] = ()

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Findings of the state, and advice."""
        return (*self.state.findings, *self.advice)

    @property
    def report(self) -> Message:
        """Status of the state with all findings, to be rendered for a reader."""
        return self.state.status.report(self.findings)

    @property
    def bracketed(self) -> bool:
        """Whether a bracket that was asked for has both ends, in order."""
        return self.bracket is not None and 0 <= self.bracket.width < inf

    @property
    def good(self) -> bool:
        """Whether all that was asked for is certified, and as narrow as asked for."""
        proven = [self.state.status is la.Status.SOLVED]
        if self.bracket is not None:
            proven.append(self.bracket.width <= self.bracket.target_width)
        if self.range is not None:
            proven.append(self.range.lowest is not None)
        if self.safety is not None:
            proven.append(not isnan(self.safety.width))
        proven += [
            not isinstance(own, str) and MORE[name].good(own) for name, own in self.more.items()
        ]
        return all(proven)


def asked(stated: Stated, backend: str | None = None, **more: Any) -> Question:
    """What the file asks for, and the command line beside it.

    Args:
        stated: the file.
        backend: in place of that of the file.
        more: `bracket`, `range`, `safety`, `interfaces`, those of `MORE`, where they are asked for.

    Raises:
        InputError: an unknown backend or coupling, a width that is none; of the file with its line.
    """
    own = stated.asked
    if backend is not None:
        la.find_backend(backend)
    for key, known in _CHECKS.items():
        try:
            known(getattr(own, key))
        except InputError as error:
            raise stated.source.error(
                ("solve", key), error.value, error.reason, error.fix
            ) from error
    if (width := more.get("bracket")) is not None:
        require_width("--bracket", width)
    goals = {"critical": more.get("critical", own.critical)}
    wanted = tuple(
        name
        for name in MORE
        if (goals[name] is not None if name in goals else more.get(name) or getattr(own, name))
    )
    if goals["critical"] is not None and not is_number(goals["critical"]):
        raise InputError(
            "--critical", goals["critical"], "not a load factor", "give a finite number"
        )
    varied = _varied(stated, more.get("vary"))
    if varied is not None and not any(MORE[name].varies for name in wanted):
        raise InputError(
            "--vary",
            varied.name,
            "no analysis uses this number",
            "add --critical, --limit or --worst",
        )
    for name in wanted:
        check(name, stated, varied)
    safety = bool(more.get("safety") or own.safety)
    interfaces = bool(more.get("interfaces") or own.interfaces)
    if interfaces and not safety:
        why, fix = "has an effect only with --safety", "add --safety"
        if own.interfaces:
            raise stated.source.error(("solve", "interfaces"), True, why, fix)
        raise InputError("--interfaces", None, why, fix)
    return Question(
        backend=backend or own.backend,
        coupling=own.coupling,
        bracket=own.bracket if width is None else width,
        range=bool(more.get("range") or own.range),
        safety=safety,
        interfaces=interfaces,
        more=wanted,
        cases=stated.cases,
        varied=varied,
        target=1.0 if goals["critical"] is None else goals["critical"],
    )


def _varied(stated: Stated, given: str | None) -> Varied | None:
    """Of the command line, or else of the file."""
    if given is not None:
        return read_varied(stated.source, given, "--vary")
    if stated.asked.vary is not None:
        return read_varied(stated.source, stated.asked.vary, ("solve", "vary"))
    return None


def answered(problem: la.Problem, question: Question, doing: Status) -> Answer:
    """Answer a question.

    Args:
        problem: of whom.
        question: what is asked.
        doing: says on the terminal what is being done.

    Raises:
        InputError, CapabilityError: what cannot be asked of it, as far as that shows.
    """
    begin = time.perf_counter()
    engine = la.find_backend(question.backend)
    if (question.range or question.safety) and engine.capabilities.regularised:
        raise InputError(
            "--backend",
            question.backend,
            "regularised backends prove no range and no factor of safety",
            "use 'clarabel'",
        )
    with doing("solving"):
        state = la.solve(problem, question.backend, question.coupling)
        advice, interval, stability = la.advice(state), None, None
        if state.status is la.Status.SOLVED and has_coulomb(problem):
            interval = None if engine.capabilities.regularised else state.interval()
        if problem.dead_loads:
            stability = state.stability()
    bracket = found = safety = None
    if question.bracket is not None:
        with doing("computing bounds") as tell:
            bracket = la.bracket(
                problem, question.bracket, backend=question.backend, on_step=_telling(tell)
            )
    if question.safety:
        with doing("computing the factor of safety"):
            safety = la.safety_factor(
                problem, interfaces=question.interfaces, backend=question.backend
            )
    if question.range:  # last: it takes longest, and what is refused is to be said before
        with doing("searching for other load factors") as tell:
            found = _range(problem, question.backend, tell)
    others: dict[str, Any] = {}
    for name in question.more:
        with doing(MORE[name].doing) as tell:
            given = _given(state, question, tell)
            try:
                others[name] = MORE[name].ask(given)
            except InputError as error:  # the load factor remains a valid result
                others[name] = text("no result: {}", error.text)
    seconds = time.perf_counter() - begin
    return Answer(state, interval, stability, bracket, found, safety, others, seconds, advice)


def _given(state: la.LimitState, question: Question, tell: Callable[[str], None]) -> Given:
    return Given(
        state=state,
        places=question.cases,
        backend=question.backend,
        coupling=question.coupling,
        bracket=question.bracket,
        varied=question.varied,
        target=question.target,
        tell=tell,
    )


def _telling(tell: Callable[[str], None]) -> Callable[[Any], None]:
    return lambda step: tell(f"{step.lower:.5g} to {step.upper:.5g}, {step.elements} elements")


def _check_bracket(width: float | None) -> None:
    if width is not None:
        require_width("bracket", width)


def _check_coupling(name: str | None) -> None:
    if name is not None:
        require_known("coupling", name, COUPLINGS)


_CHECKS: Mapping[str, Callable[[Any], object]] = {
    "backend": la.find_backend,
    "coupling": _check_coupling,
    "bracket": _check_bracket,
}


def _range(
    problem: la.Problem, backend: str, tell: Callable[[str], None]
) -> la.CoulombRange | la.SoilRange:
    if la.discretise(problem).program.frictional:
        return la.soil_range(problem, backend, on_progress=_found_so_far(tell, "load_factor"))
    return la.coulomb_range(problem, backend, on_progress=_found_so_far(tell, "low", "high"))


def _found_so_far(
    tell: Callable[[str], None], *columns: str
) -> Callable[[Mapping[str, Any]], None]:
    """Tells the lowest and the highest load factor in columns of the rows that come."""
    rows: list[Mapping[str, Any]] = []

    def progress(row: Mapping[str, Any]) -> None:
        rows.append(row)
        found = [one[name] for one in rows for name in columns if not isnan(one[name])]
        ends = f"{min(found):.5g} to {max(found):.5g}" if found else "none yet"
        tell(f"{ends}, {counted(len(rows), 'state')}")

    return progress
