"""Sweeps that are killed, interrupted and resumed: nothing is lost, doubled or different."""

import os
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from lacore.reporting.errors import InputError
from lacore_verification.harness.campaigns.sweep import plan
from lacore_verification.harness.store.results import load_results
from lacore_verification.harness.store.store import NAME, sessions
from tests.conftest import ROOT
from tests.processes import alive, hear_ctrl_c, marked, wait_for
from tests.verification.results_tables import lasting

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc"),
]
CASE, VARY = "prandtl-punch:smooth", "r=1e-1:1e-4:300:log"
BACKENDS, MESHES = ["newton", "clarabel-regularised", "clarabel"], ["coarse"]
RUNS = 601
KILLS = 20


def sweep(out, *more):
    """The command, at work."""
    words = ["sweep", CASE, "--vary", VARY, "--backends", ",".join(BACKENDS)]
    words += ["--meshes", *MESHES, "--out", str(out), "--jobs", "2", *more]
    return subprocess.Popen(
        [sys.executable, "-m", "lacore_verification", *words],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,  # Ctrl-C on a terminal goes to the whole group
        preexec_fn=hear_ctrl_c,
    )


def finished(process):
    """Exit code and stderr; none of the processes of ours hangs for long."""
    _, errors = process.communicate(timeout=300)
    return process.returncode, errors


def rows(out):
    """All that the store holds, bit by bit, by key and code."""
    if not (out / NAME).exists():
        return {}
    with closing(sqlite3.connect(out / NAME)) as database:
        if not database.execute("PRAGMA page_count").fetchone()[0]:
            return {}
        return {record[:2]: record for record in database.execute("SELECT * FROM runs")}


def count(out):
    """Rows in the store; quick, so that the writer hardly notices."""
    try:
        with closing(sqlite3.connect(f"file:{out / NAME}?mode=rw", uri=True)) as database:
            return database.execute("SELECT count(*) FROM runs").fetchone()[0]
    except sqlite3.OperationalError:  # no file, or no table yet
        return 0


def opened(out):
    """How often the store was opened for writing."""
    try:
        return len(sessions(out / NAME))
    except InputError:
        return 0


def child_processes(mark):
    """Those that perform runs."""
    found = []
    for pid in alive(mark):
        try:
            words = Path(f"/proc/{pid}/cmdline").read_bytes()
        except OSError:
            continue
        if b"child_process" in words:
            found.append(pid)
    return found


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    out = tmp_path_factory.mktemp("uninterrupted")
    code, errors = finished(sweep(out))
    assert code == 0, errors
    table = load_results(out)
    assert len(table) == RUNS
    return lasting(table)


def complete(out, uninterrupted, *more):
    """Resume to the end, and compare with a run that nothing disturbed."""
    code, errors = finished(sweep(out, *more))
    assert code == 0, errors
    pd.testing.assert_frame_equal(lasting(load_results(out)), uninterrupted, check_exact=True)
    assert len(rows(out)) == RUNS


def kept(before, after):
    """Whether all that was there is there still, as it was."""
    return all(after.get(key) == record for key, record in before.items())


@pytest.mark.parametrize("more", [(), ("--dask",)], ids=["processes", "dask"])
def test_killed_at_random_moments(tmp_path, uninterrupted, more):
    """SIGKILL, while it starts, while its workers start, while it writes."""
    if more:
        pytest.importorskip("distributed")
    kills = KILLS if not more else 5
    draw = np.random.default_rng(20260)
    before, progress = {}, []
    with marked() as mark:
        for number in range(kills):
            times = opened(tmp_path)
            process = sweep(tmp_path, *more)
            if number % 4 == 0:  # while it starts
                time.sleep(draw.uniform(0, 2))
            elif number % 4 == 1:  # while its workers start, or have started
                wait_for(lambda n=times: opened(tmp_path) > n)
                time.sleep(draw.uniform(0, 2))
            else:  # while it writes rows
                wait_for(lambda known=before: count(tmp_path) > len(known))
                time.sleep(draw.uniform(0, 0.3))
            process.kill()
            assert finished(process)[0] == -signal.SIGKILL
            after = rows(tmp_path)
            assert kept(before, after)
            progress.append(len(after) - len(before))
            before = after
        wait_for(lambda: not alive(mark))  # workers follow by themselves
        assert len({key for key, _ in before}) == len(before)
        assert 0 < sum(progress) < RUNS, progress
        complete(tmp_path, uninterrupted, *more)
    assert kept(before, rows(tmp_path))


def test_workers_killed_alone(tmp_path, uninterrupted):
    """Their runs are done again, by their successors; no row tells.

    Successors are left alone: a run that is lost twice is a row that says so.
    """
    with marked() as mark:
        process = sweep(tmp_path)
        wait_for(lambda: count(tmp_path) > 20)
        workers = child_processes(mark)
        assert len(workers) == 2
        for number, worker in enumerate(workers):
            wait_for(lambda enough=50 * number: count(tmp_path) > enough)
            os.kill(worker, signal.SIGKILL)
        code, errors = finished(process)
        assert code == 0, errors
        assert not alive(mark)
    pd.testing.assert_frame_equal(lasting(load_results(tmp_path)), uninterrupted, check_exact=True)


@pytest.mark.parametrize("more", [(), ("--dask",)], ids=["processes", "dask"])
def test_ctrl_c(tmp_path, uninterrupted, more):
    """One sentence, exit code 130, nothing left at work; then the same command goes on."""
    if more:
        pytest.importorskip("distributed")
    with marked() as mark:
        process = sweep(tmp_path, *more)
        wait_for(lambda: count(tmp_path) > 3)
        os.killpg(process.pid, signal.SIGINT)
        code, errors = finished(process)
        assert code == 130, errors
        assert "Traceback" not in errors
        assert "repeat the command to continue" in errors
        wait_for(lambda: not alive(mark))
        before = rows(tmp_path)
        assert 3 < len(before) < RUNS
        complete(tmp_path, uninterrupted, *more)
    assert kept(before, rows(tmp_path))


def test_the_plan_is_what_is_in_the_store(uninterrupted):
    runs = plan([CASE], [VARY], BACKENDS, MESHES)
    assert sorted(run.key for run in runs) == list(uninterrupted["run"])
