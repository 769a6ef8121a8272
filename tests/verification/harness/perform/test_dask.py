"""Sweeps on a real Dask cluster of two workers on this machine."""

import gc
import importlib
import json
import os
import signal
import sys
import time
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import pandas as pd
import pytest
from click.testing import CliRunner

import lacore_verification.commands.cli as cli
from lacore.reporting.errors import InputError
from lacore_verification.harness.campaigns.run_all import run_all
from lacore_verification.harness.campaigns.sweep import plan
from lacore_verification.harness.store.results import load_results
from lacore_verification.harness.store.store import NAME
from tests.broken_backends import plant
from tests.conftest import ROOT
from tests.processes import alive, marked, wait_for
from tests.verification.results_tables import lasting

# Its event loop leaves sockets of the other side to the garbage collector when a worker is killed.
pytestmark = [
    pytest.mark.filterwarnings("ignore:unclosed:ResourceWarning"),
    pytest.mark.skipif(find_spec("distributed") is None, reason="distributed is not installed"),
    pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc"),
]
BLOCK = ["deformable-block", "--vary", "mu=0.1:0.9:3", "--meshes", "coarse"]
BLOCK += ["--backends", "clarabel"]
EXAMPLES = ROOT / "examples" / "cases"


def command(*arguments):
    return CliRunner().invoke(cli.main, ["sweep", *arguments])


@pytest.fixture(scope="module", autouse=True)
def collected():
    """What the event loop leaves is collected here, not in a test of another file."""
    yield
    gc.collect()


@pytest.fixture
def dask_execution():
    """The module under test; Dask takes half a second to load, so not when tests are collected."""
    return importlib.import_module("lacore_verification.harness.perform.dask")


@pytest.fixture(scope="module")
def cluster():
    """Workers in processes of their own, as on machines of their own."""
    from distributed import Client, LocalCluster

    with (
        LocalCluster(
            n_workers=2, threads_per_worker=1, memory_limit=0, dashboard_address="127.0.0.1:0"
        ) as workers,
        Client(workers, set_as_default=False) as client,
    ):
        yield client


def test_same_results_as_processes_here(cluster, tmp_path):
    here = command(*BLOCK, "--out", str(tmp_path / "here"), "--jobs", "1")
    there = command(
        *BLOCK, "--out", str(tmp_path / "there"), "--scheduler", cluster.scheduler.address
    )
    assert (here.exit_code, there.exit_code) == (0, 0), there.output
    tables = [lasting(load_results(tmp_path / name)) for name in ("here", "there")]
    assert len(tables[0]) == 3
    pd.testing.assert_frame_equal(*tables)


@pytest.mark.slow
def test_nothing_is_left_on_the_workers(cluster, tmp_path):
    """Processes end with the sweep, and so does the plugin that owns them."""
    command(*BLOCK, "--out", str(tmp_path), "--scheduler", cluster.scheduler.address)

    def plugins(dask_worker):
        return [name for name in dask_worker.plugins if name.startswith("lacore")]

    assert not any(cluster.run(plugins).values())
    wait_for(lambda: not children(cluster))


def children(cluster):
    """Ids of the processes that the workers have started."""
    pids = set(cluster.run(os.getpid).values())
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
            words = (folder / "cmdline").read_bytes()
        except OSError:
            continue
        if parent in pids and b"child_process" in words:
            found.append(int(folder.name))
    return found


@pytest.mark.slow
def test_progress_knows_what_is_running(cluster, dask_execution):
    runs = plan(["deformable-block"], ["mu=0.2,0.4"], ["clarabel"], ["coarse"])
    begun = []
    outcomes = list(dask_execution.run_on_cluster(runs, client=cluster, on_start=begun.append))
    assert len(outcomes) == 2
    wait_for(lambda: len(begun) == 2)
    assert {run.key for run in begun} == {run.key for run in runs}


@pytest.mark.slow
def test_time_limit_holds_and_bad_rows_cost_themselves_only(
    cluster, tmp_path, monkeypatch, dask_execution
):
    plant(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    runs = plan(
        ["shear-patch:sliding"], ["p0=0.3,0.4"], ["Sleeps", "Exits", "clarabel"], ["coarse"]
    )
    begin = time.monotonic()
    outcomes = list(
        dask_execution.run_on_cluster(runs, client=cluster, folders=[tmp_path], time_limit=4.0)
    )
    # Two that hang 6 s each (limit and grace), four that take a fraction of a second, or of the
    # limit on a busy machine, and processes to start.
    assert time.monotonic() - begin < 60
    by_backend = {(o.row.backend, o.row.status) for o in outcomes}
    assert by_backend == {("Sleeps", "time limit"), ("Exits", "failed"), ("clarabel", "solved")}
    assert len(outcomes) == 6


@pytest.mark.slow
def test_cases_of_users_reach_the_workers(cluster, tmp_path):
    address = cluster.scheduler.address
    words = ["block-on-step", "--cases", str(EXAMPLES), "--vary", "h=0.5,1.5", "--json"]
    result = command(
        *words, "--backends", "clarabel", "--out", str(tmp_path), "--scheduler", address
    )
    assert result.exit_code == 0, result.output
    rows = json.loads(result.stdout)["rows"]
    assert [row["status"] for row in rows] == ["solved"] * 2


def test_a_folder_that_workers_do_not_have(cluster, tmp_path, dask_execution):
    address = cluster.scheduler.address
    with (
        pytest.raises(InputError, match="not there on every worker"),
        dask_execution.connected(address, [tmp_path / "elsewhere"]),
    ):
        raise AssertionError("there is nothing to connect for")


@pytest.mark.slow
def test_a_worker_that_dies_loses_and_doubles_nothing(cluster, tmp_path, dask_execution):
    """Killed with its process amid a run: the other one, or its successor, does the work."""
    runs = plan(["prandtl-punch:smooth"], ["r=1e-1:1e-4:24:log"], ["newton"], ["coarse"])
    killed = []

    def kill_one(outcome):
        if not killed:
            killed.append(min(cluster.run(os.getpid).values()))
            os.kill(killed[0], signal.SIGKILL)

    outcomes = run_all(
        runs, tmp_path / NAME, on_finish=kill_one,
        executor=partial(dask_execution.run_on_cluster, client=cluster),
    )  # fmt: skip
    assert killed
    assert [outcome.run.key for outcome in outcomes] == [run.key for run in runs]
    assert {outcome.row.status for outcome in outcomes} == {"solved"}
    table = load_results(tmp_path)
    assert sorted(table["run"]) == sorted(run.key for run in runs)
    cluster.wait_for_workers(2, timeout=60)


@pytest.mark.slow
def test_stopping_early_stops_the_workers(cluster, tmp_path, monkeypatch, dask_execution):
    plant(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    runs = plan(["shear-patch:sliding"], ["p0=0.3:0.4:6"], ["Sleeps"], ["coarse"])
    quick = plan(["shear-patch:sliding"], ["p0=0.3"], ["clarabel"], ["coarse"])
    outcomes = dask_execution.run_on_cluster(quick + runs, client=cluster, folders=[tmp_path])
    next(outcomes)
    outcomes.close()
    wait_for(lambda: not children(cluster))


def test_a_run_that_comes_after_the_end_starts_nothing(tmp_path, monkeypatch, dask_execution):
    """Reading a run takes time, in which the sweep may have been stopped."""
    plant(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    (run,) = plan(["deformable-block"], ["mu=0.2"], ["Sleeps"], ["coarse"])
    kept = dask_execution.Children("late", [])
    kept.setup(None)
    kept.teardown(None)
    with marked() as mark:
        outcome = kept.in_idle_process(run, time_limit=600.0)
        wait_for(lambda: not alive(mark))
    assert outcome.row.status == "failed"


def test_other_code_on_the_workers_is_refused(cluster, tmp_path, monkeypatch, dask_execution):
    monkeypatch.setattr(dask_execution, "code_version", lambda *_: "other")
    result = command(
        *BLOCK, "--out", str(tmp_path / "out"), "--scheduler", cluster.scheduler.address
    )
    assert result.exit_code == 2
    assert "another version of lacore" in result.output


@pytest.mark.slow
@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "nonsense://x", ""])
def test_a_scheduler_that_does_not_answer(tmp_path, address):
    begin = time.monotonic()
    result = command(*BLOCK, "--out", str(tmp_path / "out"), "--scheduler", address)
    assert time.monotonic() - begin < 10 + 2  # the 10 s; a busy machine
    assert result.exit_code == 2, result.output
    assert "does not answer as a Dask scheduler" in result.output
    assert result.output.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_cluster_of_nobody(tmp_path, monkeypatch, dask_execution):
    from distributed import LocalCluster

    monkeypatch.setattr(dask_execution, "_PATIENCE", 1)
    with LocalCluster(n_workers=0, dashboard_address="127.0.0.1:0") as empty:
        words = ["--out", str(tmp_path / "out"), "--scheduler", empty.scheduler_address]
        result = command(*BLOCK, *words)
    assert result.exit_code == 2
    assert "has no worker" in result.output
    assert not (tmp_path / "out").exists()


def test_a_missing_package(tmp_path, monkeypatch):
    monkeypatch.delitem(sys.modules, "lacore_verification.harness.perform.dask", raising=False)
    monkeypatch.delattr("lacore_verification.harness.perform.dask", raising=False)
    monkeypatch.setitem(sys.modules, "distributed", None)
    result = command(*BLOCK, "--out", str(tmp_path / "out"), "--dask")
    assert result.exit_code == 2
    assert "pip install 'lacore-limit-analysis[dask]'" in result.output
    assert not (tmp_path / "out").exists()


def test_one_of_both(tmp_path):
    result = command(*BLOCK, "--out", str(tmp_path / "out"), "--dask", "--scheduler", "x")
    assert result.exit_code == 2


@pytest.mark.slow
def test_a_cluster_for_one_sweep(tmp_path):
    with marked() as mark:
        result = command(*BLOCK, "--out", str(tmp_path), "--dask", "--jobs", "2")
        assert result.exit_code == 0, result.output
        wait_for(lambda: alive(mark) == [os.getpid()] or not alive(mark))
    assert len(load_results(tmp_path)) == 3
