"""The store under attack: nothing that is damaged, foreign or newer is written to or believed."""

import os
import shutil
import signal
import sqlite3
import subprocess
import sys
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import lacore as la
from lacore_verification.harness.campaigns import comparison
from lacore_verification.harness.campaigns.run_all import run_all
from lacore_verification.harness.campaigns.sweep import plan
from lacore_verification.harness.store.results import load_results
from lacore_verification.harness.store.store import (
    _APPLICATION,
    NAME,
    SCHEMA,
    Store,
    entries,
    sessions,
)
from lacore_verification.harness.store.stored_rows import WrongFieldError, _check_stopped
from lacore_verification.runs.run import canonical
from tests.conftest import ROOT
from tests.verification.command_line import run_in_order

ABOUT = {"date": "a day"}


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    """A folder with a store of five runs, and their outcomes."""
    folder = tmp_path_factory.mktemp("store")
    runs = plan(["block-slide:mu-0.2"], ["mu=0.1:0.5:5"], ["clarabel"])
    return folder, run_all(runs, folder / NAME, executor=run_in_order)


@pytest.fixture
def path(original, tmp_path):
    """A copy of it."""
    return Path(shutil.copy(original[0] / NAME, tmp_path / NAME))


def refused(path, message):
    """Neither opened for writing nor read, and not a byte of it changes."""
    before = path.read_bytes()
    with pytest.raises(la.InputError) as caught:
        Store(path, ABOUT)
    assert message in str(caught.value)
    with pytest.raises(la.InputError, match="store"):
        entries(path)
    assert path.read_bytes() == before


def test_rows_are_kept_in_order_and_read_as_they_were(original):
    folder, outcomes = original
    found = entries(folder / NAME)
    assert len(found) == len(outcomes)
    for entry in found:
        (outcome,) = [one for one in outcomes if one.run.key == entry.run]
        # As text: NaN is not equal to itself, and all digits count.
        assert entry.evidence.arrays == outcome.evidence.arrays
        assert canonical(vars(entry.row)) == canonical(vars(outcome.row))
        assert canonical(entry.evidence.residuals) == canonical(dict(outcome.evidence.residuals))
        assert canonical(entry.evidence.history) == canonical(
            [dict(record) for record in outcome.evidence.history]
        )


@pytest.mark.parametrize(
    ("case", "coupling"),
    [("vertical-cut", "bracket"), ("footing-nonassociated:psi-20", "range")],
)
def test_a_run_that_was_refused_leaves_a_store_that_can_be_read(case, coupling, tmp_path):
    """It has no history, and no count of its solves; next time it is asked again, or told."""
    runs = comparison.plan([case], ["highs"], ["coarse"], [coupling])  # which takes no cones
    (first,) = run_all(runs, tmp_path / NAME, executor=run_in_order)
    assert first.row.status != "solved"
    (entry,) = entries(tmp_path / NAME)
    assert np.isnan(entry.row.outer_iterations)
    (again,) = run_all(runs, tmp_path / NAME, executor=run_in_order)
    with pytest.raises(WrongFieldError, match="history"):
        _check_stopped(replace(entry.row, status="solved"))
    assert again.row.status == first.row.status


def test_truncated(path):
    size = path.stat().st_size
    for share in (0.999, 0.9, 0.5, 0.1):
        with path.open("r+b") as file:
            file.truncate(int(size * share))
        refused(path, "is damaged")
    with path.open("r+b") as file:
        file.truncate(50)
    refused(path, "is damaged")


def test_any_flipped_byte_is_found_or_changes_nothing(original, tmp_path):
    """At 80 places drawn with a seed: an error and no write, or the same rows.

    Unused bytes of a page, counters and the provenance of a session change no row.
    """
    whole = (original[0] / NAME).read_bytes()
    before = load_results(original[0])
    path = tmp_path / NAME
    found = 0
    for place in np.random.default_rng(5).integers(0, len(whole), 80):
        damaged = bytearray(whole)
        damaged[place] ^= 0xFF
        path.write_bytes(damaged)
        try:
            table = load_results(tmp_path)
        except la.InputError:
            found += 1
            with pytest.raises(la.InputError):
                Store(path, ABOUT)
            assert path.read_bytes() == damaged
        else:
            pd.testing.assert_frame_equal(table, before)
    assert found > 8


def test_a_row_that_was_changed_by_hand(path):
    with closing(sqlite3.connect(path)) as database, database:
        database.execute("UPDATE runs SET row = replace(row, 'solved', 'SOLVED')")
    refused(path, "checksum of run")


def test_garbage(tmp_path):
    path = tmp_path / NAME
    path.write_bytes(np.random.default_rng(1).bytes(5000))
    refused(path, "is damaged (file is not a database)")


def test_a_database_of_another_program(tmp_path):
    path = tmp_path / NAME
    with closing(sqlite3.connect(path)) as database, database:
        database.execute("CREATE TABLE runs (run TEXT)")
    refused(path, "is no store of lacore")


def test_newer_schema(path):
    with closing(sqlite3.connect(path)) as database:
        database.execute(f"PRAGMA user_version = {SCHEMA + 1}")
    refused(path, "update lacore")


def test_an_empty_file_is_a_new_store(tmp_path):
    (tmp_path / NAME).touch()
    with pytest.raises(la.InputError, match="no store of lacore"):
        entries(tmp_path / NAME)
    with Store(tmp_path / NAME, ABOUT):
        pass
    assert entries(tmp_path / NAME) == []
    assert sessions(tmp_path / NAME) == {1: ABOUT}


def test_one_writer(path):
    with Store(path, ABOUT):
        with pytest.raises(la.InputError, match="being written by another process"):
            Store(path, ABOUT)
        assert len(entries(path)) == 5  # readers do not mind
    with Store(path, ABOUT):
        pass


def test_a_reader_makes_no_writer_fail(original, path):
    """The writer waits until the reader is through."""
    _, outcomes = original
    with Store(path, ABOUT) as store, closing(sqlite3.connect(path)) as reader:
        rows = reader.execute("SELECT * FROM runs")
        rows.fetchone()
        store._database.execute("PRAGMA busy_timeout = 100")
        with pytest.raises(la.InputError, match=r"locked.*kept"):
            store.append(outcomes[0], "code")
        rows.close()
        store.append(outcomes[0], "code")
    assert len(entries(path)) == 5


def fill(store, outcomes):
    for number in range(100):
        store.append(outcomes[number % 5], f"code {number}")


def test_full_disk(original, path):
    """The row that does not fit is lost with an error; those before it stay."""
    _, outcomes = original
    before = load_results(path)
    with Store(path, ABOUT) as store:
        (pages,) = store._database.execute("PRAGMA page_count").fetchone()
        store._database.execute(f"PRAGMA max_page_count = {pages}")
        with pytest.raises(la.InputError, match=r"disk is full.*free space.*kept"):
            fill(store, outcomes)
        store._database.execute("PRAGMA max_page_count = 100000")
        store.append(outcomes[0], "after")
    after = load_results(path)
    assert sorted(after["run"]) == sorted(before["run"])


LIMITED = """
import resource, sys
limit = int(sys.argv[1])
resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
from lacore_verification.commands.cli import main
main(sys.argv[2:])
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="limits of the kernel")
def test_a_sweep_on_a_full_disk_says_so_and_goes_on_later(tmp_path):
    """Files cannot grow beyond 60 kB; each row takes about 10."""
    out = tmp_path / "out"
    words = ["sweep", "block-slide:mu-0.2", "--vary", "mu=0.1:0.5:20", "--backends", "clarabel"]
    words += ["--jobs", "1", "--out", str(out)]

    def command(*start):
        return subprocess.run(
            [sys.executable, *start, *words], cwd=ROOT, capture_output=True, text=True
        )

    stopped = command("-c", LIMITED, "60000")
    assert stopped.returncode == 2, stopped.stderr
    assert "Traceback" not in stopped.stderr
    assert "every finished run is kept" in " ".join(stopped.stderr.split())
    before = load_results(out)
    assert 0 < len(before) < 20
    assert command("-m", "lacore_verification").returncode == 0
    after = load_results(out)
    assert len(after) == 20
    kept = after[after["run"].isin(before["run"])].reset_index(drop=True)
    pd.testing.assert_frame_equal(kept, before)


def test_a_folder_that_cannot_be(tmp_path):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(la.InputError, match="name another folder"):
        Store(tmp_path / "file" / "out" / NAME, ABOUT)
    assert (tmp_path / "file").read_text() == "mine"


@pytest.mark.skipif(
    not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everywhere"
)
def test_a_read_only_folder(original, tmp_path):
    folder = tmp_path / "closed"
    shutil.copytree(original[0], folder)
    (folder / f"{NAME}.lock").unlink(missing_ok=True)
    before = (folder / NAME).read_bytes()
    (folder / NAME).chmod(0o400)
    folder.chmod(0o500)
    try:
        with pytest.raises(la.InputError, match="cannot be used"):
            Store(folder / NAME, ABOUT)
        assert len(load_results(folder)) == 5
    finally:
        folder.chmod(0o700)
    assert (folder / NAME).read_bytes() == before


HALF_A_COMMIT = """
import os, signal, sqlite3, sys
database = sqlite3.connect(sys.argv[1], isolation_level=None)
database.execute("PRAGMA cache_size = 1")
database.execute("BEGIN IMMEDIATE")
database.execute("UPDATE runs SET arrays = zeroblob(200000)")
print("written", flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGKILL")
def test_killed_amid_a_commit(original, path):
    """Pages are in the file already, their old contents in the journal: readers undo them."""
    whole = path.read_bytes()
    done = subprocess.run([sys.executable, "-c", HALF_A_COMMIT, str(path)], capture_output=True)
    assert done.returncode == -signal.SIGKILL
    assert path.read_bytes() != whole
    pd.testing.assert_frame_equal(load_results(path), load_results(original[0]))
    assert path.read_bytes() == whole


@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGKILL")
def test_killed_while_it_was_made(tmp_path):
    """Even the first transaction may be half done; then there is no store yet."""
    half = f"""
import os, signal, sqlite3
database = sqlite3.connect({str(tmp_path / NAME)!r}, isolation_level=None)
database.execute("PRAGMA cache_size = 1")
database.execute("BEGIN")
database.execute("PRAGMA application_id = {_APPLICATION}")
database.execute("CREATE TABLE one (x BLOB)")
database.execute("INSERT INTO one VALUES (zeroblob(200000))")
os.kill(os.getpid(), signal.SIGKILL)
"""
    subprocess.run([sys.executable, "-c", half], capture_output=True)
    assert (tmp_path / NAME).stat().st_size > 0
    with Store(tmp_path / NAME, ABOUT):
        pass
    assert entries(tmp_path / NAME) == []


HOLDS = """
import sys, time
from pathlib import Path
from lacore_verification.harness.store.store import Store
with Store(Path(sys.argv[1]), {}):
    print("open", flush=True)
    time.sleep(3600)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGKILL")
def test_the_lock_of_a_killed_writer_is_none(path):
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDS, str(path)], cwd=ROOT, stdout=subprocess.PIPE, text=True
    )
    with process:
        assert process.stdout.readline() == "open\n"
        with pytest.raises(la.InputError, match="being written by another process"):
            Store(path, ABOUT)
        process.kill()
    assert path.with_name(f"{NAME}.lock").exists()
    with Store(path, ABOUT):
        pass
    assert len(entries(path)) == 5


def test_nothing_that_is_read_is_run(path):
    """Text is JSON, arrays are plain: an attacker's pickle stays bytes."""
    rooms = [
        ROOT / "verification" / "lacore_verification" / room
        for room in ("harness/store", "harness/evidence", "runs")
    ]
    text = "".join(file.read_text() for room in rooms for file in room.glob("*.py"))
    assert "allow_pickle=False" in text
    assert "import pickle" not in text
    assert "eval(" not in text
    assert "allow_pickle=True" not in text
