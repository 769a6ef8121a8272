"""Ranges of soils in the verification run: what is asked, and what stands beside it on a page."""

from dataclasses import replace
from math import nan

import pytest

import lacore as la
from lacore_verification.case import RANGE, UNKNOWN
from lacore_verification.catalogue.catalogue import find
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.harness.store.store import Store, entries
from lacore_verification.harness.verdicts.words import FAIL, NO_REFERENCE, PASS, SKIPPED
from lacore_verification.harness.verify import answer, ask, finish
from lacore_verification.report.page import results_frame
from lacore_verification.report.tables import beside_table, ranges_table
from lacore_verification.runs.run import Run

FOOTING = find("footing-nonassociated")[0]
SMALL = {"nx": 3, "ny": 2, "ratio": 2.0}


def asked():
    """The question on the footing, on a mesh that is searched in a second."""
    (found,) = (q for q in ask(["footing-nonassociated:psi-20"], ["clarabel"]) if q.check == RANGE)
    return replace(found, runs=tuple(replace(run, size=SMALL) for run in found.runs))


@pytest.fixture(scope="module")
def searched():
    question = asked()
    return question, finish([question], run_here(question.runs))


def changed(searched, **fields):
    question, finished = searched
    ((key, outcome),) = finished.outcomes.items()
    row = replace(outcome.row, **fields)
    return question, replace(finished, outcomes={key: replace(outcome, row=row)})


def test_a_range_is_asked_for_where_flow_is_not_associated():
    def of(name):
        return {question.check for question in ask([name], ["clarabel"])}

    assert RANGE in of("footing-nonassociated") & of("platens-soil:psi-0")
    assert RANGE not in of("platens-soil:associated") | of("punch-indentation")
    assert RANGE not in of("platens-coulomb")  # friction of contact has searches of its own


def test_both_ends_are_certified_and_below_the_associated_load(searched):
    found = answer(*searched)
    (outcome,) = searched[1].outcomes.values()
    row = outcome.row
    assert found.verdict == row.verdict == PASS, found.why
    assert row.lower <= row.davis <= row.lowest <= row.highest <= row.upper  # T54; Davis: no bound
    assert (
        0
        <= found.measured
        == pytest.approx(2 * (row.highest - row.lowest) / (row.highest + row.lowest))
    )
    assert row.gap == outcome.evidence.residuals["gap"] <= 5e-5
    assert row.outer_iterations == sum(step["solves"] for step in outcome.evidence.history)


@pytest.mark.parametrize(
    ("fields", "told"),
    [
        ({"highest": 60.0}, "not between the associated"),
        ({"lowest": 40.0, "highest": 39.0}, "not between the associated"),
        ({"upper": nan}, "not between the associated"),  # nothing is proven of the mesh
        ({"lower": nan}, "not between the associated"),
        ({"lower": 38.9}, "not between the associated"),
        ({"lowest": 0.0, "highest": 0.0}, "not between the associated"),
        ({"lowest": nan}, "no load factor is certified"),
        ({"status": "not certified"}, "no load factor is certified"),
        ({"lower": 5.0, "lowest": 10.0}, "not in"),
    ],
)
def test_planted_errors_are_found(searched, fields, told):
    found = answer(*changed(searched, **fields))
    assert found.verdict == FAIL
    assert told in found.why


def test_without_a_reference_nothing_passes(searched):
    question, finished = searched
    case = replace(question.case, reference=lambda **_: UNKNOWN)
    runs = tuple(replace(run, case=case) for run in question.runs)
    assert answer(replace(question, runs=runs), finished).verdict == NO_REFERENCE


@pytest.mark.parametrize(
    ("fields", "told"),
    [({}, ""), ({"lowest": 30.0}, "row.lowest"), ({"highest": 33.9}, "row.highest")],
)
def test_a_stored_range_is_that_of_its_searches(searched, tmp_path, fields, told):
    (outcome,) = changed(searched, **fields)[1].outcomes.values()
    path = tmp_path / "results.sqlite"
    with Store(path, {"lacore": "0"}) as store:
        store.append(outcome, "code")
    if told:
        with pytest.raises(la.InputError, match=told):
            entries(path)
    else:
        (entry,) = entries(path)
        assert (entry.row.lowest, entry.row.davis) == (outcome.row.lowest, outcome.row.davis)


def test_associated_flow_has_no_range():
    case, (variant, *_) = find("platens-soil:associated")
    run = Run(case, variant, "coarse", "clarabel", RANGE, size={"nx": 2, "ny": 1, "ratio": 1.0})
    (outcome,) = run_here([run])
    assert outcome.row.verdict == SKIPPED
    assert "unique" in outcome.row.why


def test_what_others_say_stands_beside_it(searched):
    (outcome,) = searched[1].outcomes.values()
    (table,) = beside_table(FOOTING, [outcome])
    rows = {record["what"]: record for record in table.records}
    assert rows["lowest state found"]["value"] == outcome.row.lowest
    assert rows["associated flow on the same mesh"]["share"] == 1
    # REFERENCES: the fit at psi = 20, Davis's strength, and Prandtl's load
    assert rows["Loukidis and Salgado 2009"]["value"] == pytest.approx(29.89, abs=0.005)
    assert rows["Davis's strength"]["value"] == pytest.approx(28.537, abs=5e-4)
    assert rows["associated flow"]["value"] == pytest.approx(30.139628, abs=1e-6)
    assert all(record["source"] for record in table.records)
    assert len(ranges_table(results_frame([outcome])).records) == 1
    assert beside_table(find("strip-footing")[0], [outcome]) == []
