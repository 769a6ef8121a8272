"""A backend in a process of its own: what comes back, and what when nothing does."""

import gc
import os
import pickle
import signal
import subprocess
import sys
import threading
import traceback
from dataclasses import replace
from math import isnan, nan

import numpy as np
import pytest

import lacore as la
import lacore.solvers.child_process
import lacore.solvers.isolated_solver
import lacore.solvers.served_process
from lacore.program.kinematic import associated_contact, dimensionless
from lacore.program.regularization import RegularisedValues
from lacore.reporting.errors import BackendError
from lacore.solvers.backend import InnerSolution, checked_answer
from lacore.solvers.compilation import SolveClock
from lacore.solvers.isolation import IsolatedBackend
from lacore.solvers.served_process import Source
from tests.broken_backends import (
    COMPILE,
    CompilesForEver,
    CompilesSlowly,
    Exits,
    Options,
    Raises,
    Sleeps,
    SleepsInPrepare,
    Talks,
    Works,
)
from tests.lacore.models import deformable_block, punch
from tests.processes import wait_for


@pytest.fixture(scope="module")
def process():
    with la.SolverProcess() as process:
        yield process


def in_program_units(problem):
    d = la.discretise(problem)
    program = dimensionless(d.program, d.natural)
    return program, associated_contact(program.contact)


@pytest.fixture(scope="module")
def block():
    return in_program_units(deformable_block(0.5))


@pytest.fixture(scope="module")
def answer(block):
    program, contact = block
    return Works().prepare(program, Options()).solve(contact)


def test_a_process_counts_its_own_time(process, block):
    program, contact = block
    at_work(process, Works, program, Options())
    begin = process.processor_time
    at_work(process, Works, program, Options()).solve(contact)
    assert 0 < begin < process.processor_time


def isolated(process, kind):
    name = kind.__name__
    source = Source(name, f"{kind.__module__}:{name}", file="a test")
    return IsolatedBackend(source, la.find_backend, process)


def at_work(process, kind, program, options):
    return isolated(process, kind).prepare(program, options)


def test_a_backend_is_compiled_once_in_each_process_that_starts_with_it(block, answer):
    program, contact = block
    with la.SolverProcess() as process:
        backend = isolated(process, CompilesSlowly)
        assert backend.version() == "compiled 0 times"  # it may be described without
        assert isnan(process.compile_time)
        clock = SolveClock()
        backend.start()
        backend.start()
        first = process.compile_time
        assert first >= COMPILE
        assert clock.compile_time >= COMPILE
        process.close()
        assert same(backend.prepare(program, Options()).solve(contact), answer)
        assert clock.compile_time >= 2 * COMPILE


def test_compilation_that_does_not_end_costs_its_time_once(block, monkeypatch):
    monkeypatch.setattr(lacore.solvers.served_process, "WARM_UP", 0.3)
    program, contact = block
    with la.SolverProcess() as process:
        backend = isolated(process, CompilesForEver)
        with pytest.raises(la.CapabilityError, match=r"in warm_up\(\): .* not come back"):
            backend.start()
        found = backend.prepare(program, Options()).solve(contact)
        assert found.status is la.Status.TIME_LIMIT
        assert "in warm_up()" in found.message
        assert found.solve_time < 0.3


def same(one, other):
    return np.allclose(one.point.velocity, other.point.velocity, rtol=0, atol=1e-7)


def test_answers_are_those_of_the_backend_itself(process, block, answer):
    program, contact = block
    solver = at_work(process, Works, program, Options())
    for _ in range(2):
        assert same(solver.solve(contact), answer)
    solver.close()
    solver.close()


def test_one_process_holds_several_programs_of_its_backend(process, block, answer):
    program, contact = block
    other, other_contact = in_program_units(punch())
    first = at_work(process, Works, program, Options())
    second = at_work(process, Works, other, Options())
    assert second.solve(other_contact).status is la.Status.SOLVED
    assert same(first.solve(contact), answer)
    first.close()
    assert second.solve(other_contact).status is la.Status.SOLVED


def test_a_process_serves_no_two_backends_at_once(process, block, answer):
    program, contact = block
    first = at_work(process, Works, program, Options())
    second = at_work(process, Talks, program, Options())
    with pytest.raises(RuntimeError, match="given to another backend"):
        first.solve(contact)
    assert same(second.solve(contact), answer)


@pytest.mark.parametrize(
    ("backend", "limit", "status", "native"),
    [(Sleeps, 0.1, "TIME_LIMIT", "killed"), (Exits, 60.0, "FAILED", "process ended")],
)
def test_a_lost_process_is_final_for_its_solver_only(
    process, block, answer, monkeypatch, backend, limit, status, native
):
    monkeypatch.setattr(lacore.solvers.isolated_solver, "GRACE", 0.1)
    program, contact = block
    solver = at_work(process, backend, program, Options(time_limit=limit))
    lost = solver.solve(contact)
    assert (lost.status.name, lost.native_status, lost.point) == (status, native, None)
    assert lost.solve_time > 0
    assert solver.solve(contact) is lost
    solver.close()
    assert same(at_work(process, Works, program, Options()).solve(contact), answer)


def test_a_prepare_that_hangs_is_the_answer_of_solve(process, block, monkeypatch):
    monkeypatch.setattr(lacore.solvers.isolated_solver, "GRACE", 0.1)
    program, contact = block
    solver = at_work(process, SleepsInPrepare, program, Options(time_limit=0.1))
    assert solver.solve(contact).status is la.Status.TIME_LIMIT


def test_killed_from_outside(process, block, tmp_path):
    """As the kernel does when memory runs out."""
    program, contact = block
    file = tmp_path / "pid"

    def kill():
        os.kill(int(wait_for(lambda: file.exists() and file.read_text())), signal.SIGKILL)

    killer = threading.Thread(target=kill)
    killer.start()
    solver = at_work(process, Sleeps, program, Options(tell=str(file)))
    lost = solver.solve(contact)
    killer.join()
    assert lost.status is la.Status.FAILED
    assert "signal 9" in lost.message


def test_an_interrupt_leaves_nothing_out_of_step(process, block, answer, monkeypatch):
    """The answer to the interrupted request must not be taken for that to the next one."""
    program, contact = block
    solver = at_work(process, Works, program, Options())
    with monkeypatch.context() as patch:
        patch.setattr(lacore.solvers.child_process, "_receive", interrupt)
        with pytest.raises(KeyboardInterrupt):
            solver.solve(contact)
    started = []
    with monkeypatch.context() as patch:
        patch.setattr(subprocess, "Popen", started.append)
        solver.close()
    assert not started
    with pytest.raises(RuntimeError, match="was closed"):
        solver.solve(contact)
    assert same(at_work(process, Works, program, Options()).solve(contact), answer)


def interrupt(pipe):
    raise KeyboardInterrupt


def test_an_error_brings_its_traceback(process, block):
    program, contact = block
    solver = at_work(process, Raises, program, Options())
    with pytest.raises(BackendError, match="ZeroDivisionError: planted") as caught:
        solver.solve(contact)
    assert "broken_backends.py" in "".join(traceback.format_exception(caught.value))


def test_a_backend_that_cannot_be_imported_is_named(process):
    nowhere = type("Elsewhere", (), {"__module__": "only_here"})
    with pytest.raises(la.CapabilityError, match=r"'Elsewhere' cannot be loaded.*only_here"):
        assert isolated(process, nowhere).about


def test_files_in_the_working_directory_shadow_nothing(block, tmp_path, monkeypatch):
    (tmp_path / "numpy.py").write_text("raise RuntimeError('shadowed')\n")
    monkeypatch.chdir(tmp_path)
    program, contact = block
    with la.SolverProcess() as process:
        solver = at_work(process, Works, program, Options(time_limit=1e300))  # beyond any timer
        assert solver.solve(contact).status is la.Status.SOLVED
    gc.collect()  # pipes left open would warn here


def test_input_errors_arrive_whole(process, block):
    error = la.InputError("r", -1.0, "not positive", "give e.g. 1e-3")
    copy = pickle.loads(pickle.dumps(error))
    assert (str(copy), copy.field, copy.value) == (str(error), "r", -1.0)
    newton = la.find_backend("newton", process)
    with pytest.raises(la.InputError, match="r = 2: outside") as caught:
        newton.Options(r=2)
    assert (caught.value.field.endswith("r"), caught.value.value) == (True, 2)
    options = newton.Options(r=0.5)
    copy = pickle.loads(pickle.dumps(options))
    assert (copy.r, copy.tolerance) == (0.5, options.tolerance)


def test_solve_reports_the_peak_memory_of_an_isolated_backend(process):
    problem = deformable_block(0.5)
    assert np.isnan(la.solve(problem).peak_memory)
    state = la.solve(problem, process=process)
    assert state.status is la.Status.SOLVED
    if sys.platform == "linux":
        assert 30 < state.peak_memory < 1000


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"velocity": np.zeros(3)}, "velocity of shape (3,)"),
        ({"velocity": None}, "velocity of shape ()"),
        ({"load_factor": nan}, "load_factor with NaN"),
        ({"load_factor": np.ones(1)}, "load_factor of shape (1,)"),
        ({"stress": ()}, "stresses for 0 of 1 groups"),
        ({"stress": (np.zeros((1, 2)),)}, "stress of 'block' of shape (1, 2)"),
        ({"mean_stress": (np.array(["a"]),)}, "mean_stress of 'block' of shape (1,)"),
        ({"normal_reaction": np.zeros((2, 2))}, "normal_reaction of shape (2, 2)"),
        ({"tangential_reaction": np.zeros(1)}, "tangential_reaction of shape (1,)"),
    ],
)
def test_a_point_of_the_wrong_kind_is_dropped(block, answer, change, fault):
    point = replace(answer.point, **change)
    for given, left in (("SOLVED", "FAILED"), ("STALLED", "STALLED")):
        broken = replace(answer, status=la.Status[given], point=point)
        checked = checked_answer(block[0], False, broken)
        assert (checked.status.name, checked.point) == (left, None)
        assert fault in checked.message


def test_a_good_answer_passes(block, answer):
    assert checked_answer(block[0], False, answer) == answer
    values = RegularisedValues(1.0, 1.0, 1.0, nan)
    regularised = replace(answer, regularised=values)
    assert checked_answer(block[0], True, regularised).point is answer.point
    assert "T19" in checked_answer(block[0], True, answer).message
    limit = InnerSolution(la.Status.TIME_LIMIT, "", 0, 0.0, None)
    assert checked_answer(block[0], False, limit) == limit
    assert checked_answer(block[0], False, "nonsense").status is la.Status.FAILED
