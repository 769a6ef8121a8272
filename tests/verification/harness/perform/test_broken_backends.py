"""A backend that hangs, dies or answers nonsense costs its own row and no other."""

import os
import re
import signal
import subprocess
import sys
from math import isnan

import pytest

from lacore_verification.harness.campaigns.comparison import plan
from lacore_verification.harness.perform.processes import run_in_processes
from lacore_verification.harness.store.results import load_results
from lacore_verification.harness.store.store import NAME
from lacore_verification.harness.verdicts.words import FAIL, PASS, SKIPPED
from tests.broken_backends import BACKENDS, COMPILE, UNUSABLE, plant
from tests.processes import SOURCES, alive, hear_ctrl_c, marked, wait_for

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
CASE = "shear-patch:sliding"
GOOD = ["Works", "Talks", "AnswersAtLength", "TakesMemory", "CompilesSlowly"]
BROKEN = {
    "SleepsInPrepare": ("time limit", r"had not come back after 5 s and was stopped"),
    "Sleeps": ("time limit", r"had not come back"),
    "HoldsTheInterpreter": ("time limit", r"had not come back"),
    "IgnoresSignals": ("time limit", r"had not come back"),
    "StartsAProgram": ("time limit", r"had not come back"),
    "SleepsInClose": ("time limit", r"had not come back"),
    "Exits": ("failed", r"ended by itself \(exit code 3\)"),
    "ExitsInPrepare": ("failed", r"ended by itself \(exit code 4\)"),
    "Segfaults": ("failed", r"ended by itself \(signal 11, Segmentation fault\)"),
    "Raises": ("failed", r"ZeroDivisionError: planted"),
    "RaisesOddly": ("failed", r"OddError: this and that"),
    "RunsOutOfMemory": ("failed", r"MemoryError: Unable to allocate"),
    "CompilesInVain": ("failed", r"warm_up\(\) raised ValueError: no compiler"),
    "AnswersNone": ("failed", r"answered 'None' instead of an InnerSolution"),
    "AnswersALambda": ("failed", r"lambda"),
    "AnswersNoPoint": ("failed", r"no point with status SOLVED"),
    "AnswersNaN": ("failed", r"a velocity with NaN"),
    "AnswersWrongShapes": ("failed", r"a velocity of shape \(117,\) instead of \(118,\)"),
    "AnswersWrongStress": ("not certified", r"do not prove the answer"),
}
HANGING = [name for name, row in BROKEN.items() if row[0] == "time limit"]


# A process that hangs, one that ends, an answer that is none, and one that is wrong; all with the
# slow tests: each takes an interpreter or two.
FAST = {
    *("HoldsTheInterpreter", "Segfaults", "RaisesOddly"),
    *("AnswersNaN", "AnswersWrongStress", "TakesMemory", "CannotStart", "CompilesSlowly"),
}


def each(names):
    return [pytest.param(name, marks=[] if name in FAST else [pytest.mark.slow]) for name in names]


@pytest.fixture(scope="module")
def compared(request, tmp_path_factory):
    """Those that are tested now, each followed by one that works; of hanging ones a short limit."""
    folder = tmp_path_factory.mktemp("broken")
    plant(folder)
    mine = [item for item in request.session.items if item.path == request.path]
    asked = {item.callspec.params.get("name") for item in mine if hasattr(item, "callspec")}
    asked &= {*GOOD, *BROKEN, *UNUSABLE}
    hanging = [name for name in HANGING if name in asked]
    others = [name for name in (*GOOD, *BROKEN, *UNUSABLE) if name in asked - {*HANGING}]
    outcomes = []
    with marked() as mark, pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(folder))
        # Of the short one a run that works needs a fifth, so that it ends on a busy machine, too.
        for names, limit in ((hanging, 3.0), (others, 60.0)):
            planned = plan([CASE], [*names, "clarabel"], ["coarse"], ["certified"])
            runs = {run.backend: run for run in planned}
            order = [runs[each] for name in names for each in (name, "clarabel")]
            outcomes += run_in_processes(order, jobs=2, time_limit=limit)
        # Those that solved end by themselves as soon as nobody can ask them any more.
        wait_for(lambda: not alive(mark), patience=10.0)
        left = alive(mark)
    return outcomes, left


def test_every_planted_backend_is_expected():
    patient = {"CompilesForEver"}  # whose limit no run sets: see tests/lacore/solvers
    assert {kind.__name__ for kind in BACKENDS} - patient == {*GOOD, *BROKEN}


@pytest.mark.parametrize("name", each(BROKEN))
def test_a_broken_backend_is_a_row_that_says_how(compared, name):
    (row,) = [outcome.row for outcome in compared[0] if outcome.row.backend == name]
    status, why = BROKEN[name]
    assert (row.status, row.verdict) == (status, FAIL)
    assert re.search(why, row.message)
    assert isnan(row.load_factor)


@pytest.mark.parametrize("name", each(UNUSABLE))
def test_a_package_that_cannot_be_loaded_is_skipped(compared, name):
    (row,) = [outcome.row for outcome in compared[0] if outcome.row.backend == name]
    assert (row.status, row.verdict) == ("skipped", SKIPPED)
    assert UNUSABLE[name][1] in row.message


@pytest.mark.parametrize("name", each(GOOD))
def test_noise_and_size_break_nothing(compared, name):
    (row,) = [outcome.row for outcome in compared[0] if outcome.row.backend == name]
    assert (row.status, row.verdict) == ("solved", PASS), row.message


LOGGED = {
    "Talks": r"noise\nnoise\nnoise",
    "Segfaults": r"Segmentation fault[\s\S]*in solve",
    "RaisesOddly": r"in solve[\s\S]*OddError",
}


@pytest.mark.parametrize("name", each(LOGGED))
def test_what_a_run_prints_is_in_its_log(compared, name):
    logs = {outcome.row.backend: outcome.log for outcome in compared[0]}
    assert re.search(LOGGED[name], logs[name]), logs[name]
    assert logs["clarabel"] == ""


def test_the_next_backend_is_none_the_worse(compared):
    rows = [outcome.row for outcome in compared[0] if outcome.row.backend == "clarabel"]
    assert len(rows) == len(compared[0]) / 2 >= 1
    assert {row.verdict for row in rows} == {PASS}, [row.message for row in rows]
    assert len({row.load_factor for row in rows}) == 1


def test_peak_memory_is_that_of_the_backend(compared):
    peak = {outcome.row.backend: outcome.row.peak_memory_mb for outcome in compared[0]}
    assert 30 < peak["clarabel"] < 1000
    assert peak["TakesMemory"] > 200  # which it takes; an interpreter with a solver has less
    assert peak["TakesMemory"] > peak["clarabel"]
    assert isnan(peak["HoldsTheInterpreter"])


def test_compilation_is_no_solve_time(compared):
    rows = {outcome.row.backend: outcome.row for outcome in compared[0]}
    slow = rows["CompilesSlowly"]
    assert slow.compile_time >= COMPILE > slow.solve_time
    assert isnan(rows["TakesMemory"].compile_time)


def test_the_time_that_a_backend_reports_is_next_to_ours(compared):
    rows = {outcome.row.backend: outcome.row for outcome in compared[0]}
    row = rows["CompilesSlowly"]
    assert 0 < row.reported_time < row.solver_time < row.solve_time
    assert isnan(rows["HoldsTheInterpreter"].reported_time)


def test_a_short_program_is_timed_at_the_beginning_and_repeated(compared):
    before = [outcome.row.calibration_before for outcome in compared[0]]
    assert sum(time > 0 for time in before) >= 2  # of two processes for each limit
    assert any(outcome.row.calibration_after > 0 for outcome in compared[0])


def test_no_process_is_left(compared):
    assert compared[1] == []


@pytest.fixture
def started(tmp_path):
    """Start `lacore compare` with a backend that hangs after one that works; see to its end."""
    plant(tmp_path)
    path = os.pathsep.join([str(tmp_path), *SOURCES])
    results = tmp_path / "out" / NAME

    def start(backend, time_limit):
        command = [sys.executable, "-m", "lacore_verification", "compare", CASE]
        command += ["--backends", f"clarabel,{backend}", "--meshes", "coarse"]
        command += ["--couplings", "certified"]  # one run of each backend
        command += ["--time-limit", str(time_limit), "--out", str(results.parent), "--jobs", "1"]
        process = subprocess.Popen(
            command,
            env=os.environ | {"PYTHONPATH": path},
            cwd=tmp_path,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=hear_ctrl_c,
        )
        wait_for(lambda: results.exists() and len(load_results(results)) == 1)
        return process, results

    return start


@pytest.mark.slow
@pytest.mark.parametrize("backend", ["Sleeps", "HoldsTheInterpreter"])
def test_kill_9_keeps_the_finished_rows_and_leaves_no_process(started, backend):
    """Where the solver holds the interpreter, its process ends when its time limit is over."""
    with marked() as mark:
        process, results = started(backend, time_limit=10)  # enough on a busy machine
        assert len(alive(mark)) >= 2
        process.kill()
        process.communicate()
    wait_for(lambda: not alive(mark))
    row = load_results(results).squeeze()
    assert (row["backend"], row["verdict"]) == ("clarabel", PASS)


@pytest.mark.parametrize(
    ("sent", "code"),
    [(signal.SIGINT, 130), pytest.param(signal.SIGTERM, 143, marks=pytest.mark.slow)],
)
def test_a_signal_stops_at_once_and_keeps_the_finished_rows(started, sent, code):
    with marked() as mark:
        process, results = started("IgnoresSignals", time_limit=600)
        process.send_signal(sent)
        out, err = process.communicate(timeout=60)
        assert process.returncode == code
        assert not alive(mark)
    assert "repeat the command to continue" in err
    assert "Traceback" not in out + err
    row = load_results(results).squeeze()
    assert (row["backend"], row["verdict"]) == ("clarabel", PASS)
    assert "1 of 2 runs finished" in (results.parent / "index.html").read_text("utf-8")
