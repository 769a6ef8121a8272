"""Findings of a state are stored with its row, and come back with the state."""

from dataclasses import replace

import pytest

from lacore.reporting.findings import restored as restored_findings
from lacore.reporting.kinds import Kind
from lacore_verification.catalogue.catalogue import catalogue
from lacore_verification.harness.evidence.limit_state import restored
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.runs.run import Run


@pytest.fixture(scope="module")
def outcome():
    """Flow of this soil is not associated, which the state reports."""
    case = catalogue()["cavity-cylinder"]
    (variant,) = (own for own in case.variants if own.name == "psi-10")
    run = Run(case, variant, next(iter(case.meshes)), "clarabel", None)
    (found,) = run_here([run])
    return found


def test_findings_come_back_with_a_state(outcome):
    state = restored(outcome.run, outcome.row, outcome.evidence)
    assert state.findings == restored_findings(outcome.row.findings)
    assert [own.kind for own in state.findings] == [Kind.OTHER_LOAD_FACTORS]
    assert state.message == outcome.row.message


def test_results_of_earlier_versions_have_their_text(outcome):
    earlier = replace(outcome.row, findings="", message="solved: to the tolerance; and a note")
    state = restored(outcome.run, earlier, outcome.evidence)
    assert [own.kind for own in state.findings] == [Kind.EARLIER]
    assert earlier.message in state.message
