"""`lacore verify`: what is asked, what is answered, and that planted errors are found."""

import json
import os
import re
import shutil
import sqlite3
import subprocess
import sys
from contextlib import closing
from dataclasses import replace
from math import nan

import pytest

import lacore_verification.catalogue.plugins as plugins
from lacore_verification.case import Band, Reference
from lacore_verification.case.band import BRACKET
from lacore_verification.catalogue.catalogue import Catalogue, catalogue, find
from lacore_verification.harness.evidence.limit_state import packed, unpacked
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.harness.store.store import _checksum
from lacore_verification.harness.verdicts.words import FAIL, PASS, SKIPPED
from lacore_verification.harness.verify import (
    Finished,
    answer,
    as_table,
    ask,
    finish,
    runs_of,
    tally,
)
from tests.conftest import ROOT
from tests.processes import SOURCES
from tests.verification.command_line import lacore

PATCH = find("shear-patch:yielding")[0]
STEP = (ROOT / "examples" / "cases" / "block_on_step.py").read_text(encoding="utf-8")
WRONG_STEP = STEP.replace("/ 2 / (h - STEP)", "/ 2 / (h - STEP) * 1.01").replace(
    'id="block-on-step"', 'id="wrong-step"'
)


def run(*arguments):
    return lacore("verify", *arguments)


def checked(questions):
    return finish(questions, run_here(runs_of(questions)))


def only(questions, check):
    (found,) = [question for question in questions if question.check == check]
    return found


def changed(finished, question, **values):
    """Outcomes in which the rows of a question say something else."""
    rows = {
        key: replace(outcome, row=replace(outcome.row, **values))
        for key, outcome in finished.outcomes.items()
        if key in {run.key for run in question.runs}
    }
    return Finished({**finished.outcomes, **rows}, finished.rechecked)


def with_case(question, **fields):
    """The same question on a case with other fields."""
    case = replace(question.case, **fields)
    return replace(question, runs=tuple(replace(run, case=case) for run in question.runs))


# ---- what is asked


def test_names_tell_case_variant_backend_and_check():
    """Of a case of each kind; the whole catalogue is asked for by `pytest verification`."""
    questions = ask(["prandtl-punch", "wall-1", "wedge-in-walls", "hardening-cylinder"])
    names = [question.name for question in questions]
    assert len(set(names)) == len(names)
    assert {
        "prandtl-punch:smooth-clarabel-order",
        "prandtl-punch:smooth-newton-side",
        "wall-1:mu-0.65-highs-associated-value",
        "wedge-in-walls:pushed-down-clarabel-status",
        "prandtl-punch:smooth-clarabel-bracket",
        "prandtl-punch:smooth-clarabel-bracket-gap",
    } <= set(names)
    assert {question.check for question in questions} == {
        "value", "status", "side", "residuals", "order", "bracket", "gap", "path", "steps",
    }  # fmt: skip


def test_by_default_regularised_backends_run_the_coarsest_mesh():
    runs = runs_of(ask(["prandtl-punch:smooth"], ["clarabel", "newton"]))
    levels = {(run.backend, run.mesh) for run in runs if not run.size}
    assert levels == {("clarabel", "coarse"), ("clarabel", "medium"), ("newton", "coarse")}
    named = runs_of(ask(["prandtl-punch:smooth"], ["newton"], ["medium"]))
    assert [(run.backend, run.mesh) for run in named] == [("newton", "medium")]


def test_the_ladder_is_climbed_once_unless_backends_are_named():
    def climbers(*backends):
        questions = ask(["prandtl-punch:smooth"], backends)
        return [question.backend for question in questions if question.check == "order"]

    assert climbers() == ["clarabel"]
    assert climbers("clarabel", "cvxpy", "newton") == ["clarabel", "cvxpy"]
    assert climbers("newton") == []


def test_sides_are_asked_for_where_they_are_promised():
    def asked(name, backend):
        return {q.check for q in ask([name], ["clarabel", backend]) if q.backend == backend}

    assert "side" in asked("prandtl-punch:smooth", "newton")
    assert "side" not in asked("platens-coulomb:mu-0.1", "newton")  # a reaction loop (T19)
    assert "side" not in asked("platens-coulomb:mu-0.1", "clarabel")  # Coulomb friction
    assert "side" not in asked("thick-cylinder", "clarabel")  # curved boundaries
    assert "side" in asked("thick-cylinder", "newton")


# ---- what is answered


@pytest.fixture(scope="module")
def cylinder():
    questions = ask(["thick-cylinder"], ["clarabel", "newton"], ["coarse"])
    questions = [question for question in questions if question.coupling != BRACKET]
    return questions, checked(questions)


@pytest.fixture(scope="module")
def punch():
    questions = ask(["prandtl-punch:smooth"], ["clarabel", "newton"], ["coarse"])
    questions = [q for q in questions if q.check != "order" and q.coupling != BRACKET]
    return questions, checked(questions)


def of(questions, check, backend="clarabel"):
    return only([question for question in questions if question.backend == backend], check)


def test_all_is_well(cylinder, punch):
    for questions, finished in (cylinder, punch):
        findings = [answer(question, finished) for question in questions]
        assert [found for found in findings if found.verdict != PASS] == []
        assert tally(findings) == {
            "passed": len(questions),
            "failed": 0,
            "skipped": 0,
            "no_result": 0,
            "no_reference": 0,
        }
        assert len(as_table(findings)) == len(questions)
        assert all(found.why and "\n" not in found.why for found in findings)


def test_order_has_its_interval_and_its_meshes(cylinder):
    questions, finished = cylinder
    found = answer(of(questions, "order"), finished)
    assert found.measured == pytest.approx(1.0, abs=0.02)
    assert found.meshes == "32, 128, 288, 512, 800"
    assert "(95 %)" in found.why


def test_a_wrong_order_is_found(cylinder):
    questions, finished = cylinder
    asked = of(questions, "order")
    stated = asked.case.order_of(asked.variant)
    for wrong in (replace(stated, expected=1.5), replace(stated, tolerance=1e-4, expected=1.006)):
        found = answer(with_case(asked, order=lambda order=wrong: order), finished)
        assert found.verdict == FAIL, found.why
        assert "thick-cylinder:burst" in found.why
        assert f"expected {wrong.expected:g}" in found.why


def test_a_ladder_that_could_not_be_climbed_to_its_end_is_none(cylinder):
    questions, finished = cylinder
    asked = of(questions, "order")
    first = replace(asked, runs=asked.runs[:1])
    short = changed(finished, first, verdict=SKIPPED, why="too small")
    assert answer(asked, short).verdict == SKIPPED
    assert "4 of 5 meshes" in answer(asked, short).why


def test_there_is_no_order_without_the_whole_ladder(cylinder):
    questions, finished = cylinder
    asked = of(questions, "order")
    found = answer(asked, changed(finished, asked, status="stalled"))
    assert found.verdict == FAIL
    assert "no ladder" in found.why


def high(**parameters):
    """Above what the coarse mesh gives by less than the band of `wide`."""
    return Reference(6.2, "planted", "wrong", "exact")


def low(**parameters):
    """Far below what the coarse mesh gives."""
    return Reference(4.0, "planted", "wrong", "exact")


def wide(elements, **parameters):
    return Band(0.1, 0.1, "as wide as a barn door")


def test_an_upper_bound_below_the_reference_is_found(punch):
    questions, finished = punch
    fields = {"reference": high, "band": wide}
    assert answer(with_case(of(questions, "value"), **fields), finished).verdict == PASS
    found = answer(with_case(of(questions, "side"), **fields), finished)
    assert found.verdict == FAIL
    assert found.measured == pytest.approx(6.0258 / 6.2 - 1, abs=1e-4)
    assert "prandtl-punch:smooth coarse clarabel" in found.why
    assert "below (relative) the reference 6.2" in found.why


def test_a_bound_without_its_label_is_found(punch):
    questions, finished = punch
    asked = of(questions, "side")
    found = answer(asked, changed(finished, asked, rigor="discrete"))
    assert found.verdict == FAIL
    assert "labelled 'discrete'" in found.why


def test_lambda_above_the_exact_value_is_found(punch):
    questions, finished = punch
    asked = of(questions, "side", "newton")
    (outcome,) = finished.of(asked.runs)
    for relative, verdict in ((1e-6, PASS), (1e-5, FAIL)):  # two solvers may err by 1e-6 each
        value = outcome.row.load_factor * (1 + relative)
        found = answer(asked, changed(finished, asked, load_factor=value))
        assert found.verdict == verdict, found.why


def test_a_row_is_judged_by_the_reference_of_today(punch):
    questions, finished = punch
    found = answer(with_case(of(questions, "value"), reference=low), finished)
    assert all(outcome.row.verdict == PASS for outcome in finished.of(of(questions, "value").runs))
    assert found.verdict == FAIL


def test_a_row_that_differs_from_its_state_is_found(punch):
    questions, finished = punch
    for backend in ("clarabel", "newton"):
        asked = of(questions, "residuals", backend)
        found = answer(asked, changed(finished, asked, load_factor=6.0))
        assert found.verdict == FAIL
        assert "the row says 6, the stored state" in found.why


@pytest.mark.parametrize("backend", ["clarabel", "newton"])
def test_a_load_factor_changed_everywhere_is_out_of_balance(punch, backend):
    """By 1e-4 of itself: the bar is 1e-6 of the total load."""
    questions, finished = punch
    asked = of(questions, "residuals", backend)
    (outcome,) = finished.of(asked.runs)
    value = outcome.row.load_factor * (1 + 1e-4)
    arrays = packed(replace(unpacked(outcome.evidence.arrays), load_factor=value))
    forged = replace(
        outcome,
        row=replace(outcome.row, load_factor=value),
        evidence=replace(outcome.evidence, arrays=arrays),
    )
    found = answer(asked, finish([asked], [forged]))
    assert found.verdict == FAIL
    assert found.measured > 1e-5
    assert "above 1e-06, computed afresh" in found.why


def test_what_was_not_solved_fails_once_and_what_was_not_run_is_skipped(punch):
    questions, finished = punch
    value, side, residuals = (of(questions, check) for check in ("value", "side", "residuals"))
    stalled = changed(finished, value, status="stalled", message="stalled: so it is")
    assert answer(value, stalled).verdict == FAIL
    assert "stalled: so it is" in answer(value, stalled).why
    assert {answer(side, stalled).verdict, answer(residuals, stalled).verdict} == {SKIPPED}
    lost = changed(finished, value, status="time limit", n_elements=nan, why="stopped after 1 s")
    assert answer(value, lost).verdict == FAIL
    assert "stopped after 1 s" in answer(value, lost).why
    missing = changed(finished, value, status="skipped", verdict=SKIPPED, why="no licence")
    assert answer(value, missing).verdict == SKIPPED
    assert answer(value, missing).why == "no licence"


@pytest.mark.parametrize(
    ("backend", "claimed", "verdict"),
    [("newton", False, "no result"), ("newton", True, FAIL), ("clarabel", False, FAIL)],
)
def test_only_a_regularised_backend_may_say_that_it_has_no_result(punch, backend, claimed, verdict):
    """And not that it has one, where residuals refute it."""
    questions, finished = punch
    value = of(questions, "value", backend)
    (key,) = (run.key for run in value.runs)
    stuck = changed(
        finished, value, status="not certified", load_factor=nan, P=nan, claimed=claimed
    ).outcomes
    evidence = stuck[key].evidence
    unbalanced = replace(evidence, residuals={**evidence.residuals, "equilibrium": 0.1})
    found = answer(value, Finished({**stuck, key: replace(stuck[key], evidence=unbalanced)}, {}))
    assert found.verdict == verdict
    assert tally([found])["no_result"] == (verdict == "no result")


def test_a_wrong_status_is_found():
    asked = only(ask(["wedge-in-walls:pushed-down"], ["clarabel"]), "status")
    finished = checked([asked])
    assert answer(asked, finished).verdict == PASS
    found = answer(asked, changed(finished, asked, status="solved", load_factor=3.0))
    assert found.verdict == FAIL
    assert found.allowed == "locked"


# ---- from the command line


def test_a_wrong_reference_in_a_case_of_ones_own_is_exit_code_1(tmp_path, monkeypatch):
    (tmp_path / "wrong_step.py").write_text(WRONG_STEP)
    monkeypatch.setattr(sys, "path", [*sys.path])  # the folder is on it as long as this runs
    options = ["--cases", tmp_path, "--backends", "clarabel", "--out", tmp_path / "out", "--full"]
    done = run("wrong-step:square", *options)
    assert done.exit_code == 1, done.output
    (line,) = [line for line in done.stdout.splitlines() if line.startswith("FAIL value: ")]
    assert "wrong-step:square" in line
    assert "1.25 not in [" in line
    assert "the reference is 1.2625" in line
    assert (
        "below (relative) the reference 1.2625" in done.stdout
    )  # without friction, an upper bound
    assert "1 checks pass, 2 FAIL" in done.stdout


def planted_reference(**parameters):
    return Reference(0.61, "planted", "wrong", "exact")


@pytest.mark.slow
def test_a_wrong_reference_in_a_built_in_case_is_exit_code_1(tmp_path, monkeypatch):
    wrong = {**catalogue(), PATCH.id: replace(PATCH, reference=planted_reference)}
    known = Catalogue(wrong, dict.fromkeys(wrong, "lacore"))
    monkeypatch.setattr(plugins, "catalogue", lambda: known)
    result = run("shear-patch:yielding", "--backends", "clarabel", "--out", tmp_path, "--json")
    assert result.exit_code == 1
    document = json.loads(result.stdout)
    assert document["summary"]["failed"] == 2
    value, bracket = (found for found in document["checks"] if found["verdict"] == FAIL)
    assert value["case"] == bracket["case"] == "shear-patch"
    assert "shear-patch:yielding coarse clarabel: 0.6" in value["why"]
    assert "the reference is 0.61" in value["why"]
    assert bracket["check"] == "bracket"
    assert "no less than: planted, lies outside of what is proven" in bracket["why"]


SHEAR = ("shear-patch:yielding", "--backends", "clarabel", "--meshes", "coarse")


@pytest.fixture(scope="module")
def verified(tmp_path_factory):
    """Folder of a verification that passed."""
    folder = tmp_path_factory.mktemp("verified")
    assert run(*SHEAR, "--out", folder).exit_code == 0
    return folder


@pytest.fixture
def stored(verified, tmp_path):
    """A copy of it, and a function that changes its stored state and verifies again."""
    shutil.copytree(verified, tmp_path, dirs_exist_ok=True)
    arguments = (*SHEAR, "--out", tmp_path, "--full")

    def tamper(change, forge):
        with closing(sqlite3.connect(tmp_path / "results.sqlite")) as database, database:
            names = [row[1] for row in database.execute("PRAGMA table_info(runs)")]
            rows = """SELECT * FROM runs WHERE identity LIKE '%"coupling":null%'"""
            (record,) = database.execute(rows)
            record = dict(zip(names, record, strict=True))
            record["arrays"] = packed(change(unpacked(record["arrays"])))
            sealed = [record[name] for name in names if name != "checksum"]
            checksum = _checksum(sealed) if forge else record["checksum"]
            statement = "UPDATE runs SET arrays = ?, checksum = ? WHERE run = ?"
            database.execute(statement, (record["arrays"], checksum, record["run"]))
        return run(*arguments)

    return tamper


def overstressed(point):
    return replace(point, stress=tuple(1.001 * stress for stress in point.stress))


def test_a_tampered_state_is_found_even_with_its_checksum_forged(stored):
    result = stored(overstressed, forge=True)
    assert result.exit_code == 1
    assert "FAIL residuals: shear-patch:yielding coarse clarabel" in result.stdout
    assert "computed afresh" in result.stdout
    assert "FAIL value" not in result.stdout


@pytest.mark.parametrize(
    "change",
    [
        lambda point: replace(point, velocity=point.velocity[:-1]),
        lambda point: replace(point, velocity=nan * point.velocity),
        lambda point: replace(point, velocity=point.velocity.astype(str)),
        lambda point: replace(point, stress=()),
        lambda point: replace(point, load_factor=0.61),
    ],
    ids=["of another problem", "not numbers", "text", "without stress", "another load factor"],
)
def test_a_state_that_is_none_of_this_row_is_found(stored, change):
    result = stored(change, forge=True)
    assert result.exit_code == 1, result.output
    assert "FAIL residuals: shear-patch:yielding coarse clarabel" in result.stdout
    assert "Traceback" not in result.output


def test_a_damaged_store_is_exit_code_2(stored):
    result = stored(overstressed, forge=False)
    assert result.exit_code == 2
    assert "checksum" in result.stderr


def test_checks_are_kept_and_shown(tmp_path):
    result = run("shear-patch:yielding", "--backends", "clarabel,newton", "--out", tmp_path)
    assert result.exit_code == 0, result.output
    assert re.search(r"^shear-patch +1 +6 of 6 .* pass$", result.stdout, re.MULTILINE)
    assert "lacore manual" in result.stdout.splitlines()[-1]
    assert "6 checks pass, 0 FAIL, 0 skipped; 4 runs" in result.stdout
    assert (tmp_path / "checks.csv").read_text().count("\n") == 1 + 6
    assert (tmp_path / "results.sqlite").is_file()


@pytest.mark.parametrize(
    ("arguments", "fix"),
    [
        (["prandl-punch"], "did you mean 'prandtl-punch'?"),
        (["--backends", "clarbel"], "did you mean 'clarabel'?"),
        (["shear-patch", "--meshes", "corse"], "did you mean 'coarse'?"),
        (["--time-limit", "nan"], "--time-limit"),
        (["--cases", "/nowhere"], "--cases"),
    ],
)
def test_bad_input_is_one_sentence_and_exit_code_2(tmp_path, arguments, fix):
    result = run(*arguments, "--out", tmp_path / "new")
    assert result.exit_code == 2
    assert fix in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "new").exists()


def test_ctrl_c_says_how_to_go_on(tmp_path, monkeypatch):
    def stopped(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr("lacore_verification.harness.campaigns.run_all.run_all", stopped)
    result = run("shear-patch", "--out", tmp_path)
    assert result.exit_code == 130
    assert "repeat the command to continue" in result.stderr


def test_nothing_verified_is_exit_code_1(tmp_path):
    result = run("block-between-walls:mu-0.3", "--backends", "newton", "--out", tmp_path)
    assert result.exit_code == 1
    assert "skipped: newton, 2 times: penalties let go" in result.stdout
    assert "nothing was verified" in result.stderr


@pytest.fixture
def collected(tmp_path):
    """Run pytest as users of an installed package would, far from the repository."""

    def run_pytest(*arguments):
        folder = tmp_path / "nowhere"
        folder.mkdir()
        path = os.pathsep.join([str(tmp_path), *SOURCES])
        command = [
            sys.executable,
            "-m",
            "pytest",
            "--pyargs",
            "lacore_verification.case_checks",
            "-v",
        ]
        done = subprocess.run(
            [*command, "-p", "no:cacheprovider", *arguments],
            cwd=folder,
            env={**os.environ, "PYTHONPATH": path},
            capture_output=True,
            text=True,
        )
        return done, set(re.findall(r"test_case\[(\S+)\] (\w+)", done.stdout))

    return run_pytest


@pytest.mark.slow
def test_pytest_makes_the_same_checks(collected):
    done, found = collected("-k", "prandtl-punch:smooth-clarabel- and not regularised")
    assert done.returncode == 0, done.stdout
    checks = ("value", "side", "residuals", "order", "bracket", "bracket-gap")
    assert found == {(f"prandtl-punch:smooth-clarabel-{check}", "PASSED") for check in checks}


@pytest.mark.slow
def test_pytest_checks_cases_of_installed_packages(collected, tmp_path):
    (tmp_path / "wrong_step.py").write_text(WRONG_STEP)
    info = tmp_path / "wrong_step-0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: wrong-step\nVersion: 0\n")
    (info / "entry_points.txt").write_text("[lacore.cases]\nwrong-step = wrong_step:CASE\n")
    done, found = collected("-k", "wrong-step:square-clarabel")
    assert done.returncode == 1, done.stdout
    assert ("wrong-step:square-clarabel-value", "FAILED") in found
    assert ("wrong-step:square-clarabel-residuals", "PASSED") in found
    assert "the reference is 1.2625" in done.stdout
