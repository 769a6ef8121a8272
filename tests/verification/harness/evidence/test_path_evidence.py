"""The load of a path is proven by the stored state of its last step, and by nothing else."""

import io
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from lacore.numerics.arrays import Floats
from lacore_verification.case import SOLVER
from lacore_verification.harness.campaigns.comparison import plan
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.harness.verdicts.words import FAIL, PASS
from lacore_verification.harness.verify.answers import answer, finish
from lacore_verification.harness.verify.finding import Finding
from lacore_verification.harness.verify.questions import ask
from lacore_verification.runs.outcome import Outcome

CASES = [  # a load factor; a force, with contact
    "tension:linear-1",
    pytest.param("upsetting:mu-0.1", marks=pytest.mark.slow),
]


@pytest.fixture(scope="module", params=CASES)
def ran(request: pytest.FixtureRequest) -> Outcome:
    (outcome,) = run_here(plan([request.param], ["clarabel"], ["coarse"]))
    return outcome


def judged(outcome: Outcome) -> Finding:
    run = outcome.run
    (asked,) = (
        question
        for question in ask([f"{run.case.id}:{run.variant.name}"], ["clarabel"], ["coarse"])
        if question.check == "residuals"
    )
    return answer(asked, finish([asked], [outcome]))


def forged(outcome: Outcome, change: Callable[[dict[str, Floats]], None]) -> Outcome:
    with np.load(io.BytesIO(outcome.evidence.arrays)) as archive:
        arrays = dict(archive)
    change(arrays)
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    return replace(outcome, evidence=replace(outcome.evidence, arrays=buffer.getvalue()))


def test_the_stored_state_proves_the_load(ran: Outcome) -> None:
    found = judged(ran)
    assert (found.verdict, found.allowed) == (PASS, f"<= {SOLVER:g}")
    assert "computed afresh" in found.why
    # What the solve itself found, to what the sums of a few hundred terms lose.
    assert found.measured == pytest.approx(max(ran.evidence.residuals.values()), abs=1e-11)


def test_another_load_is_found(ran: Outcome) -> None:
    wrong = replace(ran.row, load_factor=ran.row.load_factor * (1 + 1e-9))
    found = judged(replace(ran, row=wrong))
    assert found.verdict == FAIL
    assert "the row says" in found.why


def test_a_load_changed_everywhere_is_out_of_balance(ran: Outcome) -> None:
    def more(arrays: dict[str, Floats]) -> None:
        arrays["load_factor"] = arrays["load_factor"] + 1e-4

    wrong = forged(ran, more)
    first = judged(wrong)
    assert "the row says" in first.why
    said = float(first.why.rpartition(" ")[2])
    second = judged(replace(wrong, row=replace(wrong.row, load_factor=said)))
    assert second.verdict == FAIL


@pytest.mark.parametrize("part", ["at/nodes", "begin/strain"])
def test_another_configuration_is_found(ran: Outcome, part: str) -> None:
    def other(arrays: dict[str, Floats]) -> None:
        for name in arrays:
            if name.startswith(part):
                arrays[name] = arrays[name] * 1.001

    assert judged(forged(ran, other)).verdict == FAIL


@pytest.mark.parametrize("missing", ["velocity", "times", "begin"])
def test_what_is_missing_is_named(ran: Outcome, missing: str) -> None:
    def less(arrays: dict[str, Floats]) -> None:
        for name in [name for name in arrays if name.startswith(missing)]:
            del arrays[name]

    found = judged(forged(ran, less))
    assert found.verdict == FAIL
    assert "ValueError: no st" in found.why  # state, step


def test_no_bytes_are_no_proof(ran: Outcome) -> None:
    empty = replace(ran, evidence=replace(ran.evidence, arrays=b""))
    assert judged(empty).verdict == FAIL
