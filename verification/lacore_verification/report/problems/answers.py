"""Analyses of a problem by `lacore solve`, and their results."""

import time
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any

import lacore as la
from lacore.coupling.kinds import COUPLINGS
from lacore.files.problem.reading import Stated
from lacore.files.problem.varied import Varied, read_varied
from lacore.reporting.errors import InputError, is_number, require_known, require_width
from lacore.reporting.findings import Finding, Message
from lacore.reporting.text import text
from lacore_verification.report.problems.asking import Given, Question
from lacore_verification.report.problems.bounding import proven_bracket
from lacore_verification.report.problems.more import ANALYSES, check

Status = Callable[[str], AbstractContextManager[Callable[[str], None]]]


@dataclass(frozen=True)
class ProblemResults:
    """Results of a problem.

    Attributes:
        state: Its limit state.
        results: Results of analyses by their name in `ANALYSES`; a text states why there is none.
        seconds: Time of all of them.
        advice: Advice on larger domains; see `lacore.advice`.
        refused: Invalid input of an analysis that was requested, found after the first solve.
    """

    state: la.LimitState
    results: Mapping[str, Any]
    seconds: float
    advice: tuple[Finding, ...] = ()
    refused: InputError | None = None

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Findings of the state, and advice."""
        return (*self.state.findings, *self.advice)

    @property
    def report(self) -> Message:
        """Status of the state with all findings, to be rendered for a reader."""
        return self.state.status.report(self.findings)

    @property
    def bracket(self) -> la.Bracket | None:
        """The bracket, if both of its bounds are proven."""
        return proven_bracket(self.results)

    @property
    def good(self) -> bool:
        """Whether all results are certified, and bounds as close as requested."""
        return self.state.status is la.Status.SOLVED and all(
            not isinstance(own, str) and ANALYSES[name].good(own)
            for name, own in self.results.items()
        )


def asked(stated: Stated, backend: str | None = None, **more: Any) -> Question:
    """Return the analyses requested by the file and the command line.

    Args:
        stated: the file.
        backend: backend instead of that of the file.
        more: Values of options, by the names of analyses, and `interfaces` and `vary`.

    Raises:
        InputError: an unknown backend or coupling, or an invalid width; for the file with its line.
    """
    own = stated.asked
    if backend is not None:
        la.find_backend(backend)
    _check_file(stated)

    def value(name: str) -> Any:
        given = more.get(name)
        return getattr(own, name) if given is None or given is False else given

    if more.get("bracket") is not None:
        require_width("--bracket", more["bracket"])
    target = value("critical")
    if target is not None and not is_number(target):
        raise InputError("--critical", target, "not a load factor", "give a finite number")
    names = tuple(
        name
        for name, analysis in ANALYSES.items()
        if analysis.automatic is None and value(name) not in (None, False)
    )
    varied = _varied(stated, more.get("vary"))
    if varied is not None and not any(ANALYSES[name].varies for name in names):
        why, fix = "no analysis uses this number", "add --critical, --limit or --worst"
        raise InputError("--vary", varied.name, why, fix)
    for name in names:
        check(name, stated, varied)
    interfaces = bool(value("interfaces"))
    if interfaces and "safety" not in names:
        why, fix = "has an effect only with --safety", "add --safety"
        if own.interfaces:
            raise stated.source.error(("solve", "interfaces"), True, why, fix)
        raise InputError("--interfaces", None, why, fix)
    return Question(
        backend=backend or own.backend,
        coupling=own.coupling,
        analyses=names,
        bracket=value("bracket"),
        interfaces=interfaces,
        cases=stated.cases,
        varied=varied,
        target=1.0 if target is None else target,
    )


def _check_file(stated: Stated) -> None:
    """Check names and numbers that do not depend on the problem; errors have their line."""
    for key, known in _CHECKS.items():
        try:
            known(getattr(stated.asked, key))
        except InputError as error:
            at = ("solve", key)
            raise stated.source.error(at, error.value, error.reason, error.fix) from error


def _varied(stated: Stated, given: str | None) -> Varied | None:
    """Return the varied number of the command line, or else of the file."""
    if given is not None:
        return read_varied(stated.source, given, "--vary")
    if stated.asked.vary is not None:
        return read_varied(stated.source, stated.asked.vary, ("solve", "vary"))
    return None


def answered(problem: la.Problem, question: Question, doing: Status) -> ProblemResults:
    """Compute the requested analyses.

    Args:
        problem: the problem.
        question: the requested analyses.
        doing: shows progress on the terminal.

    Raises:
        InputError, CapabilityError: an analysis is not supported, as far as that is known before.
    """
    begin = time.perf_counter()
    engine = la.find_backend(question.backend)
    if engine.capabilities.regularised and any(ANALYSES[own].exact for own in question.analyses):
        raise InputError(
            "--backend",
            question.backend,
            "regularised backends prove no range and no factor of safety",
            "use 'clarabel'",
        )
    for name in question.analyses:
        ANALYSES[name].require(problem)
    with doing("solving"):
        state = la.solve(problem, question.backend, question.coupling)
        advice = la.advice(state)
    results: dict[str, Any] = {}
    refused: InputError | None = None
    for name, own in ANALYSES.items():
        if own.automatic is None:
            if name not in question.analyses:
                continue
        elif not own.automatic(state):
            continue
        with doing(own.doing) as tell:
            try:
                results[name] = own.ask(Given(state, question, tell))
            except InputError as error:  # The load factor remains a valid result.
                refused = error if own.binding and refused is None else refused
                results[name] = text("no result: {}", error.text)
    return ProblemResults(state, results, time.perf_counter() - begin, advice, refused)


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
