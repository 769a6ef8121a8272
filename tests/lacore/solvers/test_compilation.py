"""Starting and compiling a backend is no part of the time of a solve."""

import time
from threading import Event, Thread
from types import SimpleNamespace

import pytest

import lacore as la
import lacore_backends.auto
import lacore_backends.interior_point
from lacore.program.kinematic import associated_contact
from lacore.solvers.compilation import SolveClock, compiling
from lacore.solvers.solver_worker import SolverWorker
from tests.broken_backends import COMPILE, Works, plant
from tests.lacore.models import punch


@pytest.fixture
def seconds(monkeypatch):
    """A clock that is set by hand."""
    now = [0.0]
    monkeypatch.setattr(time, "perf_counter", lambda: now[0])
    return now


def test_a_clock_stands_still_while_a_backend_compiles(seconds):
    early = SolveClock()
    seconds[0] += 1.0
    with compiling():
        seconds[0] += 20.0
    late = SolveClock()
    seconds[0] += 2.0
    assert (early.seconds, early.compile_time) == (3.0, 20.0)
    assert (late.seconds, late.compile_time) == (2.0, 0.0)


def test_compilation_that_fails_is_no_solve_time(seconds):
    @compiling()
    def compiles():
        seconds[0] += 4.0
        raise ValueError("no compiler")

    clock = SolveClock()
    with pytest.raises(ValueError, match="no compiler"):
        compiles()
    assert (clock.seconds, clock.compile_time) == (0.0, 4.0)


def test_compilation_in_another_thread_is_its_own(seconds):
    def compiles():
        with compiling():
            seconds[0] += 8.0

    clock, other = SolveClock(), Thread(target=compiles)
    other.start()
    other.join()
    assert (clock.seconds, clock.compile_time) == (8.0, 0.0)


def twice(solve):
    """Two results, and the time of the first as it is seen from outside."""
    begin = time.perf_counter()
    first = solve()
    return first, solve(), time.perf_counter() - begin


@pytest.mark.parametrize(
    "solve",
    [
        lambda: la.solve(punch(), backend="CompilesSlowly"),
        lambda: la.lower_bound(punch(), "CompilesSlowly"),
    ],
    ids=["solve", "lower_bound"],
)
def test_the_first_solve_of_a_plug_in_waits_for_its_warm_up(tmp_path, monkeypatch, solve):
    plant(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    first, second, whole = twice(solve)
    la.find_backend("CompilesSlowly").process.close()
    assert first.status is second.status is la.Status.SOLVED
    assert first.compile_time >= COMPILE
    assert first.solve_time <= whole - first.compile_time
    assert second.compile_time == 0.0
    assert "s to start and compile the backend" in repr(first)
    assert "compile" not in repr(second)


@pytest.mark.parametrize("name", ["interior_point", "auto"])
def test_backends_of_lacore_compile_outside_of_the_solve_time(monkeypatch, name):
    """However often they compiled before."""
    if name == "auto":
        monkeypatch.setattr(lacore_backends.auto, "_COMPILED", 0)
        monkeypatch.setattr(lacore_backends.auto, "_LEAST", 0)
    lacore_backends.interior_point._compiled.cache_clear()
    first, second, whole = twice(lambda: la.solve(punch(), backend=name))
    assert first.compile_time > 0.0
    assert first.solve_time <= whole - first.compile_time
    assert first.history["solve_time"].sum() <= first.solve_time
    assert second.compile_time == 0.0


class ComputesWhileItCompiles(Works):
    """One second of both clocks, of which it uses a processor all the time."""

    def warm_up(self):
        CLOCKS["perf_counter"] += 1.0
        CLOCKS["process_time"] += 1.0


CLOCKS = {"perf_counter": 0.0, "process_time": 0.0}


def test_compilation_is_not_taken_for_threads_that_were_left_behind(monkeypatch):
    """A process that is replaced for them would compile again."""
    for name in CLOCKS:
        monkeypatch.setattr(time, name, lambda name=name: CLOCKS[name])
    worker = SolverWorker()
    worker.open(f"{__name__}:ComputesWhileItCompiles", "")
    worker.warm_up()
    CLOCKS["perf_counter"] += 0.5
    assert not worker.was_busy()
    CLOCKS["perf_counter"] += 1.0
    CLOCKS["process_time"] += 1.0
    assert worker.was_busy()


class RunsAThread(Works):
    """A thread for each prepared solver, until it is closed."""

    def prepare(self, program, options):
        end = Event()
        Thread(target=end.wait, name="of a solver", daemon=True).start()
        return SimpleNamespace(solve=lambda contact: None, close=end.set)


def test_a_process_in_which_a_solver_is_prepared_is_kept(monkeypatch):
    """What runs and computes there may belong to this solver, which would be lost."""
    for name in CLOCKS:
        monkeypatch.setattr(time, name, lambda name=name: CLOCKS[name])
    program = la.discretise(la.examples.beam()).program
    worker = SolverWorker()
    worker.open(f"{__name__}:RunsAThread", "")
    for number in (1, 2):
        worker.prepare(number, program, {})
    worker.close(2)
    CLOCKS["perf_counter"] += 1.0
    CLOCKS["process_time"] += 1.0
    assert not worker.was_busy()
    assert worker.rest() == ""
    worker.prepare(3, program, {})
    solvers = [worker._solvers.pop(number) for number in (1, 3)]
    CLOCKS["perf_counter"] += 1.0
    CLOCKS["process_time"] += 1.0
    assert worker.was_busy()
    assert "threads (of a solver" in worker.rest()
    for solver, *_ in solvers:
        solver.close()


class SolvesForASecond(Works):
    """One second of both clocks for each solve."""

    def prepare(self, program, options):
        return self

    def solve(self, contact):
        CLOCKS["perf_counter"] += 1.0
        CLOCKS["process_time"] += 1.0

    def close(self):
        pass


def test_a_solve_after_the_end_of_another_program_is_no_idling(monkeypatch):
    """Paths with friction solve one program before and after others."""
    for name in CLOCKS:
        monkeypatch.setattr(time, name, lambda name=name: CLOCKS[name])
    program = la.discretise(la.examples.beam()).program
    worker = SolverWorker()
    worker.open(f"{__name__}:SolvesForASecond", "")
    for number in (1, 2):
        worker.prepare(number, program, {})
    worker.close(2)
    worker.rest()  # as after the end of each program
    worker.solve(1, associated_contact(program.contact))
    assert not worker.was_busy()
