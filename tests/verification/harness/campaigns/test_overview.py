"""The first comparison: its runs, how close they are, and that its summary fits a screen."""

import io
import time
from dataclasses import replace
from functools import cache
from math import nan

import pytest
from rich.console import Console

import lacore as la
from lacore_verification.case import BRACKET, CLOSE
from lacore_verification.catalogue.catalogue import catalogue
from lacore_verification.commands import screen
from lacore_verification.harness import progress
from lacore_verification.harness.analysis.profiles import rates
from lacore_verification.harness.analysis.summary import summaries
from lacore_verification.harness.campaigns.comparison import capabilities, is_regularised, plan
from lacore_verification.harness.campaigns.overview import LARGE, everything, overview, variants
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.harness.perform.processes import lost
from lacore_verification.harness.store.results import as_table
from lacore_verification.harness.verdicts.words import FAIL, NO_REFERENCE, NO_RESULT, PASS
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.row import Row

DEFAULT = [case for case in catalogue().values() if not case.on_demand]


@cache
def first():
    """Runs of the first comparison; to choose them loads all backends."""
    return overview()


def test_every_case_is_there_and_every_status():
    assert {run.case.id for run in first()} == {case.id for case in DEFAULT}
    stated = {
        (case.id, case.reference_of(variant).status)
        for case in DEFAULT
        for variant in case.variants
    }
    assert stated == {(run.case.id, run.case.reference_of(run.variant).status) for run in first()}


def test_every_default_backend_meets_many_cases():
    cases = {name: set() for name in la.backend_names() if not capabilities(name).on_demand}
    for run in first():
        cases[run.backend].add(run.case.id)
    assert min(map(len, cases.values())) >= 10
    assert not [run for run in first() if run.case.meshed and capabilities(run.backend).dense]


def test_all_continues_from_it():
    """The keys are the same, so stored results are not run again; coarse meshes are added."""
    every = everything()
    keys = [run.key for run in first()]
    assert len(keys) == len(set(keys)) < len(every) / 3
    assert {run.key for run in every} == {*keys, *(run.key for run in plan())}
    cases = [run.case.id for run in every]
    assert cases == sorted(cases, key=[case.id for case in DEFAULT].index)


def test_a_case_runs_the_variant_meshes_and_bracket_that_it_names():
    for case in DEFAULT:
        variant = variants(case)[0]
        own = [run for run in first() if run.case is case and run.variant is variant]
        assert variant.name == (case.first.variant or case.variants[0].name)
        meshes = {run.mesh for run in own if run.coupling != BRACKET}
        if case.first.meshes is not None:
            assert meshes == set(case.first.meshes)
        brackets = [run.settings["target_width"] for run in own if run.coupling == BRACKET]
        assert brackets == ([case.first.bracket] if case.first.bracket else [])
        assert case.first.bracket <= CLOSE


def test_one_exact_backend_runs_what_is_expensive():
    """Further meshes, brackets, paths, other statuses, and large cases."""
    for case in DEFAULT:
        main, *others = variants(case)
        for variant in variants(case):
            own = [run for run in first() if run.case is case and run.variant is variant]
            if variant in others or case.path is not None or LARGE in case.tags:
                assert len({run.backend for run in own}) == 1
        levels = case.first.meshes or ()
        quick = [run for run in first() if run.case is case and run.variant is main]
        if levels and levels[0] != next(iter(case.meshes)):
            assert all(capabilities(run.backend).paths for run in quick)


def _close_runs():
    """One exact run for each mesh and bracket of deformable bodies."""
    exact = [run for run in first() if run.case.meshed and not is_regularised(run.backend)]
    runs = {(run.case.id, run.variant.name, run.mesh, run.coupling): run for run in reversed(exact)}
    return [*runs.values()]


@pytest.mark.slow
@pytest.mark.parametrize("case", [case.id for case in DEFAULT if case.meshed])
def test_runs_are_close_to_the_reference(case):
    """Regularised backends agree with the exact ones, and rigid bodies are exact."""
    for run in _close_runs():
        if run.case.id != case:
            continue
        (found,) = summaries(list(run_here([run])))
        assert found.verdict in (PASS, NO_REFERENCE), run.label
        if found.verdict == PASS:
            assert abs(found.error) <= CLOSE, run.label


def test_paths_come_first_and_rigid_bodies_come_last():
    kinds = [0 if run.case.path else 1 if run.case.meshed else 2 for run in first()]
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


@pytest.mark.parametrize("chosen", [first, everything], ids=["first", "all"])
@pytest.mark.parametrize("verdict", [PASS, FAIL, NO_RESULT])
def test_an_answer_is_one_screen(chosen, verdict):
    runs = chosen()
    console = Console(file=io.StringIO(), width=200)
    outcomes = [answered(run, verdict) for run in runs]
    screen.show_overview(console, summaries(outcomes))
    screen.show_rates(console, rates(as_table(one.record() for one in outcomes), ["backend"]))
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
        watch.start(first()[0])
        watch.finish(answered(first()[0], PASS))
        watch.start(first()[1])
        time.sleep(0.2)
        watch.finish(answered(first()[1], FAIL))
    with progress.status("drawing pictures"):
        time.sleep(0.2)
    lines = capsys.readouterr().err.splitlines()
    assert any(
        line.startswith("1 of 2 runs finished, ") and line.endswith(f"running: {first()[1].label}")
        for line in lines
    )
    assert any(line.startswith(f"FAIL {first()[1].label}: ") for line in lines)
    assert any(line.startswith("drawing pictures, 0:00:0") for line in lines)


def test_what_is_quick_says_nothing(capsys):
    with progress.watching(1) as watch, progress.status("drawing"):
        watch.start(first()[0])
        watch.finish(answered(first()[0], PASS))
    assert capsys.readouterr().err == ""


def test_failures_come_first_and_then_the_largest_errors():
    def row(number, error, verdict=PASS):
        outcome = answered(first()[number], PASS)
        return replace(outcome, row=replace(outcome.row, error=error, verdict=verdict))

    numbers = {run.case.id: place for place, run in reversed([*enumerate(first())])}
    names = ["prandtl-punch", "vertical-cut", "layer-rough", "block-slide"]
    errors = (0.01, -0.3, 0.98, nan)
    outcomes = [row(numbers[name], error) for name, error in zip(names, errors, strict=True)]
    outcomes.append(row(numbers["wall-1"], 0.0, FAIL))
    console = Console(file=io.StringIO(), width=200)
    screen.show_overview(console, summaries(outcomes))
    lines = console.file.getvalue().splitlines()
    cases = [line.split(":")[0] for line in lines[2:7]]
    assert cases == ["wall-1", "layer-rough", "vertical-cut", "prandtl-punch", "block-slide"]
    assert "+98 %" in lines[3]
    assert "-30 %" in lines[4]
