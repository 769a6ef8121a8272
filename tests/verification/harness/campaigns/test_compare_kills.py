"""A comparison with a solver that always hangs: it ends, and being killed costs it no row."""

import os
import sqlite3
import subprocess
import sys
import time
from contextlib import closing

import numpy as np
import pandas as pd
import pytest

from lacore.solvers.isolation import release_processes
from lacore_verification.harness.campaigns.comparison import plan
from lacore_verification.harness.store.store import NAME
from tests.broken_backends import plant
from tests.processes import SOURCES, alive, marked, wait_for

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc"),
]
CASES, BACKENDS = ["wall-1:mu-0.65", "shear-patch:sliding"], ["clarabel", "Sleeps", "highs"]
LONGEST = 12.0  # s: killed while it starts, while it runs, or while it writes


@pytest.fixture
def start(tmp_path, monkeypatch):
    """Start the comparison; the limit is long enough for a solver that works."""
    plant(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    words = ["compare", *CASES, "--meshes", "coarse"]
    words += ["--backends", ",".join(BACKENDS), "--time-limit", "4", "--jobs", "2"]
    path = os.pathsep.join([str(tmp_path), *SOURCES])

    def started():
        return subprocess.Popen(
            [sys.executable, "-m", "lacore_verification", *words, "--out", str(tmp_path / "out")],
            env=os.environ | {"PYTHONPATH": path},
            cwd=tmp_path,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    return started, tmp_path / "out"


def rows(out):
    """All that the store holds, by run."""
    with closing(sqlite3.connect(out / NAME)) as database:
        return {record[0]: record for record in database.execute("SELECT * FROM runs")}


def finish(process):
    out, errors = process.communicate(timeout=300)
    assert process.returncode == 1, out + errors  # the solver that hangs fails
    return errors


@pytest.mark.parametrize("kills", [2, 30])
def test_killed_at_random_moments_it_ends_with_all_rows_and_pages(start, kills):
    started, out = start
    runs = plan(CASES, BACKENDS, ["coarse"])
    release_processes()  # which said what the backends are
    draw = np.random.default_rng(48)
    with marked() as mark:
        for _ in range(kills):
            process = started()
            time.sleep(draw.uniform(0, LONGEST))
            process.kill()
            process.communicate()
            page, table = out / "index.html", out / "results.csv"
            assert not page.exists() or page.read_text("utf-8").rstrip().endswith("</html>")
            assert not table.exists() or "," in table.read_text("utf-8").splitlines()[-1]
        errors = finish(started())
        first = rows(out)
        table = pd.read_csv(out / "results.csv")
        assert {*first} == {run.key for run in runs}
        assert list(table["backend"]) == [run.backend for run in runs]
        assert set(table["status"][table["backend"] == "Sleeps"]) == {"time limit"}
        assert set(table["verdict"][table["backend"] == "clarabel"]) == {"pass"}, errors
        assert "runs finished" not in (out / "index.html").read_text("utf-8")
        errors = finish(started())
        assert "--retry failed repeats" in errors
        assert "running:" not in errors
        assert rows(out) == first, "a repeated command starts no run"
        wait_for(lambda: not alive(mark))
