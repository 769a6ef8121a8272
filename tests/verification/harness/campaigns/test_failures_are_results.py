"""Failures are stored like other results; interrupted comparisons leave a page and a table."""

from contextlib import nullcontext
from dataclasses import replace

import pandas as pd
import pytest

import lacore as la
from lacore_verification.harness.campaigns.comparison import plan
from lacore_verification.harness.campaigns.run_all import (
    Repeat,
    describe_failures,
    is_failure,
    run_all,
)
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.harness.perform.processes import lost
from lacore_verification.harness.store.manifest import whole_file
from lacore_verification.harness.store.store import NAME, Store, entries
from lacore_verification.harness.verdicts.words import FAIL, NO_REFERENCE, PASS
from lacore_verification.report import reporting
from lacore_verification.report.reporting import GrowingReport
from tests.verification.command_line import lacore, run_in_order

BACKENDS = ["clarabel", "highs"]


@pytest.fixture
def runs():
    return plan(["wall-1"], BACKENDS)[:2]


def ending(status):
    """An executor whose second run ends without an answer."""

    def execute(runs, *, time_limit, on_start):
        for place, run in enumerate(runs):
            on_start(run)
            if place == 1:
                yield lost(run, status, "planted")
            else:
                yield from run_here([run])

    return execute


class Recorder:
    """An executor that records its runs."""

    def __init__(self):
        self.runs = []

    def __call__(self, runs, **more):
        self.runs += runs
        yield from run_in_order(runs, **more)


@pytest.mark.parametrize("status", [la.Status.TIME_LIMIT, la.Status.FAILED])
def test_what_hung_or_crashed_is_repeated_on_request_only(tmp_path, runs, status):
    path, found = tmp_path / NAME, []
    first = run_all(runs, path, executor=ending(status))
    assert [is_failure(outcome) for outcome in first] == [False, True]
    nothing, retried = Recorder(), Recorder()
    again = run_all(runs, path, executor=nothing, on_found=found.extend)
    assert nothing.runs == []
    assert [outcome.row.status for outcome in again] == ["solved", status.label]
    assert describe_failures(found) == (
        f"1 stored failure is used (1 {status.label}); --retry failed repeats it"
    )
    last = run_all(runs, path, executor=retried, repeat=Repeat.FAILURES)
    assert retried.runs == runs[1:]
    assert [outcome.row.verdict for outcome in last] == [PASS, PASS]
    found.clear()
    run_all(runs, path, executor=nothing, on_found=found.extend)
    assert (nothing.runs, describe_failures(found)) == ([], "")


def test_a_wrong_result_is_a_failure(runs):
    (outcome,) = run_here(runs[:1])
    wrong = replace(outcome, row=replace(outcome.row, verdict=FAIL))
    assert not is_failure(outcome)
    assert is_failure(wrong)
    assert describe_failures([wrong, wrong]) == (
        "2 stored failures are used (2 solved); --retry failed repeats them"
    )


def test_retry_and_fresh_exclude_each_other(tmp_path):
    found = lacore("compare", "wall-1", "--fresh", "--retry", "failed", "--out", tmp_path)
    assert found.exit_code == 2
    assert "--retry = 'failed': --fresh repeats all runs anyway; omit one of them" in found.stderr


@pytest.fixture
def interrupted(tmp_path, monkeypatch):
    """A comparison that Ctrl-C stops after its first run."""

    def execute(runs, *, time_limit, on_start):
        yield from run_here(runs[:1])
        raise KeyboardInterrupt

    words = ("compare", "wall-1", "--backends", ",".join(BACKENDS), "--out", tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(reporting, "pictures_of", lambda subjects: nullcontext({}))
        patch.setattr(
            "tests.verification.command_line.run_in_order",
            lambda runs, jobs, **more: execute(runs, **more),
        )
        return lacore(*words), words


def test_an_interrupted_comparison_writes_what_it_has(interrupted, tmp_path):
    found, words = interrupted
    assert found.exit_code == 130
    assert "repeat the command to continue" in found.stderr
    assert len(pd.read_csv(tmp_path / "results.csv")) == 1
    total = len(plan(["wall-1"], BACKENDS))
    assert f"1 of {total} runs finished" in (tmp_path / "index.html").read_text("utf-8")
    assert lacore(*words).exit_code == 0
    assert len(pd.read_csv(tmp_path / "results.csv")) == total
    assert "runs finished" not in (tmp_path / "index.html").read_text("utf-8")


def test_a_report_completes_the_table_of_a_killed_comparison(tmp_path, runs, monkeypatch):
    monkeypatch.setattr(reporting, "pictures_of", lambda subjects: nullcontext({}))
    run_all(runs, tmp_path / NAME, executor=run_in_order)  # killed before it wrote anything else
    assert lacore("report", tmp_path).exit_code == 0
    assert len(pd.read_csv(tmp_path / "results.csv")) == len(runs)
    assert (tmp_path / "index.html").is_file()


def test_pages_grow_at_small_cost(tmp_path, runs, monkeypatch):
    """They are written a certain time after the start, and then after 100 times what that takes."""
    now, written = [0.0], []
    monkeypatch.setattr(reporting.time, "monotonic", lambda: now[0])

    def write(growing):
        written.append(now[0])
        now[0] += 0.5

    monkeypatch.setattr(GrowingReport, "write", write)
    growing = GrowingReport([*runs, replace(runs[0], mesh="other")], tmp_path)
    outcomes = [lost(run, la.Status.FAILED, "planted") for run in runs]
    while now[0] < 130:
        growing.add(outcomes[0])
        now[0] += 1.0
    assert written == [10.0, 60.5, 111.0]


def test_a_killed_writer_leaves_whole_files(tmp_path):
    path = tmp_path / "results.csv"
    path.write_text("before")

    def write():
        with whole_file(path) as unfinished:
            unfinished.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write()
    assert [file.name for file in tmp_path.iterdir()] == ["results.csv"]
    assert path.read_text() == "before"


def test_logs_are_files_next_to_the_results(tmp_path, runs, monkeypatch):
    monkeypatch.setattr(reporting, "pictures_of", lambda subjects: nullcontext({}))
    folder, other = tmp_path / "results", tmp_path / "other"
    file = f"logs/{runs[0].key}.txt"

    def talking(text):
        def execute(runs, **more):
            for outcome in run_in_order(runs, **more):
                yield replace(outcome, log=text if outcome.run == runs[0] else "")

        return execute

    first, second = run_all(runs, folder / NAME, executor=talking("a <b> c\n"))
    assert (first.row.log, second.row.log) == (file, "")
    assert [path.name for path in (folder / "logs").iterdir()] == [f"{runs[0].key}.txt"]
    assert lacore("report", folder, "--out", other).exit_code == 0
    for place in (folder, other):
        assert (place / file).read_text("utf-8") == "a <b> c\n"
    assert f'<a href="../{file}">' in (other / "cases" / "wall-1.html").read_text("utf-8")
    first, _ = run_all(runs, folder / NAME, executor=talking(""), repeat=Repeat.EVERYTHING)
    assert first.row.log == ""
    assert list((folder / "logs").iterdir()) == []


@pytest.mark.parametrize("log", ["../secret", "javascript:alert(1)", "logs/../../x.txt"])
def test_a_forged_log_is_no_link(tmp_path, runs, log):
    (outcome,) = run_here(runs[:1])
    with Store(tmp_path / NAME, {}) as store:
        store.append(replace(outcome, row=replace(outcome.row, log=log)), "0")
    with pytest.raises(la.InputError, match="no file of a log"):
        entries(tmp_path / NAME)


@pytest.mark.parametrize("verdict", [PASS, FAIL, NO_REFERENCE])
def test_a_run_without_an_answer_is_a_failure_whatever_its_verdict(runs, verdict):
    """A case without a reference judges no value, and a run that was stopped has none."""
    stopped = {la.Status.TIME_LIMIT, la.Status.FAILED}
    for status in (*stopped, la.Status.SOLVED, la.Status.LOCKED):
        own = lost(runs[0], status, "planted")
        outcome = replace(own, row=replace(own.row, verdict=verdict))
        assert is_failure(outcome) == (verdict == FAIL or status in stopped)
