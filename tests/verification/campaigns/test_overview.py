"""A first look: what it runs, and that its answer fits a screen whatever comes out."""

import io
import time

import pytest
from rich.console import Console

import lacore as la
from verification import progress
from verification.analysis.summary import summaries
from verification.campaigns.comparison import capabilities, is_regularised, plan
from verification.campaigns.overview import overview
from verification.catalogue.catalogue import catalogue
from verification.commands import screen
from verification.perform.one_run import lost
from verification.runs.outcome import Outcome
from verification.runs.row import Row
from verification.verdicts.words import FAIL, NO_RESULT, PASS

FIRST = overview()
DEFAULT = [case for case in catalogue().values() if not case.on_demand]


def test_every_case_is_there_and_every_status():
    assert {run.case.id for run in FIRST} == {case.id for case in DEFAULT}
    stated = {
        (case.id, case.reference_of(variant).status)
        for case in DEFAULT
        for variant in case.variants
    }
    assert stated == {(run.case.id, run.case.reference_of(run.variant).status) for run in FIRST}


def test_every_default_backend_meets_many_cases():
    cases = {name: set() for name in la.backend_names() if not capabilities(name).on_demand}
    for run in FIRST:
        cases[run.backend].add(run.case.id)
    assert min(map(len, cases.values())) >= 10
    assert not [run for run in FIRST if run.case.meshed and capabilities(run.backend).dense]


def test_all_goes_on_from_it():
    """The same keys: what a first look has in its store is not run again."""
    everything = {run.key for run in plan()}
    keys = [run.key for run in FIRST]
    assert len(keys) == len(set(keys)) < len(everything) / 3
    assert set(keys) <= everything


def test_what_deforms_comes_first_and_paths_come_last():
    kinds = [2 if run.case.path else 0 if run.case.meshed else 1 for run in FIRST]
    assert kinds == sorted(kinds)


def test_what_is_named_is_taken_in_place_of_the_choice():
    runs = overview(["newton"], ["fine"])
    assert {run.backend for run in runs} == {"newton"}
    assert {run.mesh for run in runs if run.case.meshed} == {"fine"}
    with pytest.raises(la.InputError, match="clarabel"):
        overview(["clarbel"])


def answered(run, verdict):
    """An outcome of a run, with much to say."""
    if verdict == PASS:
        names = (run.case.id, run.variant.name, run.backend, run.coupling or "certified", run.mesh)
        reference = run.case.reference_of(run.variant)
        row = Row(
            *names, n_elements=100.0, load_factor=1.23456789e-5, error=-1.23456e-3, rigor="upper",
            upper=1.23456789e-5, status="solved", solve_time=123.45, verdict=PASS,
            expected=reference.text,
        )  # fmt: skip
        return Outcome(run, row)
    status = la.Status.FAILED if verdict == FAIL else la.Status.TIME_LIMIT
    return lost(run, status, f"{run.label}: " + "it went wrong at length " * 20)


@pytest.mark.parametrize("runs", [FIRST, plan()], ids=["first look", "all"])
@pytest.mark.parametrize("verdict", [PASS, FAIL, NO_RESULT])
def test_an_answer_is_one_screen(runs, verdict):
    console = Console(file=io.StringIO(), width=200)
    outcomes = [answered(run, verdict) for run in runs]
    screen.show_overview(console, summaries(outcomes))
    screen.show_end(console, "counts", {"Report": "index.html", "Results": "results.csv"}, "more")
    lines = console.file.getvalue().splitlines()
    assert len(lines) <= screen.LINES == 60
    assert max(map(len, lines)) <= screen.WIDTH == 120
    for case in DEFAULT:
        assert any(case.id[:24] in line for line in lines), case.id
    exact = any(not is_regularised(run.backend) for run in runs)
    assert exact
    if verdict == FAIL:
        assert any(line.startswith("FAIL: ") for line in lines)


def test_without_a_terminal_a_line_says_now_and_then_what_runs(capsys, monkeypatch):
    monkeypatch.setattr(progress, "EVERY", 0.02)
    with progress.watching(2) as watch:
        watch.start(FIRST[0])
        watch.finish(answered(FIRST[0], PASS))
        watch.start(FIRST[1])
        time.sleep(0.2)
        watch.finish(answered(FIRST[1], FAIL))
    with progress.status("drawing pictures"):
        time.sleep(0.2)
    lines = capsys.readouterr().err.splitlines()
    assert any(
        line.startswith("1 of 2 runs finished, ") and line.endswith(f"running: {FIRST[1].label}")
        for line in lines
    )
    assert any(line.startswith(f"FAIL {FIRST[1].label}: ") for line in lines)
    assert any(line.startswith("drawing pictures, 0:00:0") for line in lines)


def test_what_is_quick_says_nothing(capsys):
    with progress.watching(1) as watch, progress.status("drawing"):
        watch.start(FIRST[0])
        watch.finish(answered(FIRST[0], PASS))
    assert capsys.readouterr().err == ""
