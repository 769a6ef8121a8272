"""Findings from the outcomes of runs."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache

import lacore as la
from lacore_verification.case.band import BRACKET
from lacore_verification.harness.evidence.limit_state import recheck
from lacore_verification.harness.evidence.path import recheck_step
from lacore_verification.harness.evidence.span_nodes import as_solved
from lacore_verification.harness.verdicts.words import SKIPPED
from lacore_verification.harness.verify.bracket import bracket, gap, ranged
from lacore_verification.harness.verify.finding import CheckResult, Finding
from lacore_verification.harness.verify.limit_state import (
    lambda_below_exact,
    upper_from_above,
    value,
)
from lacore_verification.harness.verify.order import order
from lacore_verification.harness.verify.path import path, steps
from lacore_verification.harness.verify.questions import Question
from lacore_verification.harness.verify.residuals import Rechecked, residuals
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.row import Row
from lacore_verification.runs.run import Run

SOLVED = la.Status.SOLVED.label


@dataclass(frozen=True)
class Finished:
    """Data of findings, by `Run.key`.

    Attributes:
        outcomes: of all runs.
        rechecked: proofs from the stored states of runs, or why there is no proof.
    """

    outcomes: Mapping[str, Outcome]
    rechecked: Mapping[str, Rechecked] = field(default_factory=dict)

    def of(self, runs: Iterable[Run]) -> list[Outcome]:
        """Return outcomes of runs, with the cases of these runs."""
        return [replace(self.outcomes[run.key], run=run) for run in runs]


def finish(questions: Sequence[Question], outcomes: Iterable[Outcome]) -> Finished:
    """Recompute residuals where required; each problem is discretised once."""
    found = {outcome.run.key: outcome for outcome in outcomes}
    problems: dict[tuple[object, ...], list[Outcome]] = {}
    for question in questions:
        for run in question.runs if question.check == "residuals" else ():
            outcome = found[run.key]
            if outcome.row.status == SOLVED:
                problems.setdefault(run.problem_key, []).append(outcome)
    rechecked: dict[str, Rechecked] = {}
    for neighbours in problems.values():
        rechecked |= _rechecked(neighbours)
    return Finished(found, rechecked)


def _rechecked(neighbours: Sequence[Outcome]) -> dict[str, Rechecked]:
    """Return proofs of runs of one problem; each path has its own at its last step."""
    discretisation = cache(lambda: la.discretise(neighbours[0].run.problem()))
    found: dict[str, Rechecked] = {}
    for own in neighbours:
        try:
            found[own.run.key] = (
                recheck(
                    as_solved(own.run.problem(), discretisation(), own.evidence),
                    own.row,
                    own.evidence,
                )
                if own.run.case.path is None
                else recheck_step(own.run, own.row, own.evidence)
            )
        except Exception as error:  # Cases of users and stored bytes may raise any error.
            found[own.run.key] = f"{type(error).__name__}: {error}"
    return found


def answer(question: Question, finished: Finished) -> Finding:
    """Return the finding on a question; its verdict is ``skipped`` if nothing could be run."""
    outcomes = finished.of(question.runs)
    run = [outcome for outcome in outcomes if outcome.row.verdict != SKIPPED]
    given = (
        _BY_CHECK[question.check](question, run, finished)
        if run
        else CheckResult(SKIPPED, outcomes[0].row.why)
    )
    return Finding(
        case=question.case.id,
        variant=question.variant.name,
        backend=question.backend,
        coupling=question.coupling,
        meshes=_meshes(question, [outcome.row for outcome in run or outcomes]),
        check=question.check,
        verdict=given.verdict,
        measured=given.measured,
        allowed=given.allowed,
        why=given.why,
    )


def _meshes(question: Question, rows: Sequence[Row]) -> str:
    if question.check == "order":
        return ", ".join(f"{row.n_elements:g}" for row in rows)
    if question.check == "steps":
        return rows[0].mesh
    if question.coupling == BRACKET:
        return ", ".join(f"{row.n_elements_lower:g} + {row.n_elements:g}" for row in rows)
    return ", ".join(row.mesh for row in rows)


def _side(question: Question, outcomes: Sequence[Outcome], finished: Finished) -> CheckResult:
    if question.exact:
        pairs = zip(question.runs, question.exact, strict=True)
        beside = {run.key: finished.outcomes[exact.key] for run, exact in pairs}
        return lambda_below_exact(outcomes, beside)
    return upper_from_above(outcomes, question.reference)


_Check = Callable[[Question, Sequence[Outcome], Finished], CheckResult]
_BY_CHECK: Mapping[str, _Check] = {
    "value": lambda question, outcomes, _: value(outcomes, question.reference),
    "status": lambda question, outcomes, _: value(outcomes, question.reference),
    "side": _side,
    "residuals": lambda _, outcomes, finished: residuals(outcomes, finished.rechecked),
    "order": lambda question, outcomes, _: order(question, outcomes),
    "path": lambda _, outcomes, __: path(outcomes),
    "steps": lambda question, outcomes, _: steps(question, outcomes),
    "bracket": lambda question, outcomes, _: bracket(outcomes, question.reference),
    "range": lambda question, outcomes, _: ranged(outcomes, question.reference),
    "gap": lambda _, outcomes, __: gap(outcomes),
}
