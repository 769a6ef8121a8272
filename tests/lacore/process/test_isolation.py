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
from math import nan
from types import ModuleType

import numpy as np
import pytest

import lacore as la
import lacore.process.child_process
import lacore.process.isolation
from lacore.backend import InnerSolution, checked_answer
from lacore.program import associated_contact, dimensionless
from lacore.regularization import RegularisedValues
from tests.broken_backends import (
    Exits,
    Options,
    Raises,
    Sleeps,
    SleepsInPrepare,
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
    begin = process.processor_time
    process.prepare(Works(), program, Options()).solve(contact)
    assert 0 < begin < process.processor_time


def same(one, other):
    return np.allclose(one.point.velocity, other.point.velocity, rtol=0, atol=1e-7)


def test_answers_are_those_of_the_backend_itself(process, block, answer):
    program, contact = block
    solver = process.prepare(Works(), program, Options())
    for _ in range(2):
        assert same(solver.solve(contact), answer)
    solver.close()
    solver.close()


def test_a_solver_does_not_answer_for_the_program_of_another(process, block, answer):
    program, contact = block
    first = process.prepare(Works(), program, Options())
    second = process.prepare(Works(), *in_program_units(punch())[:1], Options())
    with pytest.raises(RuntimeError, match="given to another program"):
        first.solve(contact)
    first.close()  # leaves the second at work
    assert second.solve(in_program_units(punch())[1]).status is la.Status.SOLVED


@pytest.mark.parametrize(
    ("backend", "limit", "status", "native"),
    [(Sleeps, 0.1, "TIME_LIMIT", "killed"), (Exits, 60.0, "FAILED", "process ended")],
)
def test_a_lost_process_is_final_for_its_solver_only(
    process, block, answer, monkeypatch, backend, limit, status, native
):
    monkeypatch.setattr(lacore.process.isolation, "GRACE", 0.1)
    program, contact = block
    solver = process.prepare(backend(), program, Options(time_limit=limit))
    lost = solver.solve(contact)
    assert (lost.status.name, lost.native_status, lost.point) == (status, native, None)
    assert lost.solve_time > 0
    assert solver.solve(contact) is lost
    solver.close()
    assert same(process.prepare(Works(), program, Options()).solve(contact), answer)


def test_a_prepare_that_hangs_is_the_answer_of_solve(process, block, monkeypatch):
    monkeypatch.setattr(lacore.process.isolation, "GRACE", 0.1)
    program, contact = block
    solver = process.prepare(SleepsInPrepare(), program, Options(time_limit=0.1))
    assert solver.solve(contact).status is la.Status.TIME_LIMIT


def test_killed_from_outside(process, block, tmp_path):
    """As the kernel does when memory runs out."""
    program, contact = block
    file = tmp_path / "pid"

    def kill():
        os.kill(int(wait_for(lambda: file.exists() and file.read_text())), signal.SIGKILL)

    killer = threading.Thread(target=kill)
    killer.start()
    solver = process.prepare(Sleeps(), program, Options(tell=str(file)))
    lost = solver.solve(contact)
    killer.join()
    assert lost.status is la.Status.FAILED
    assert "signal 9" in lost.message


def test_an_interrupt_leaves_nothing_out_of_step(process, block, answer, monkeypatch):
    """The answer to the interrupted request must not be taken for that to the next one."""
    program, contact = block
    solver = process.prepare(Works(), program, Options())
    with monkeypatch.context() as patch:
        patch.setattr(lacore.process.child_process, "_receive", interrupt)
        with pytest.raises(KeyboardInterrupt):
            solver.solve(contact)
    started = []
    with monkeypatch.context() as patch:
        patch.setattr(subprocess, "Popen", started.append)
        solver.close()
    assert not started
    with pytest.raises(RuntimeError, match="was closed"):
        solver.solve(contact)
    assert same(process.prepare(Works(), program, Options()).solve(contact), answer)


def interrupt(pipe):
    raise KeyboardInterrupt


def test_an_error_brings_its_traceback(process, block):
    program, contact = block
    solver = process.prepare(Raises(), program, Options())
    with pytest.raises(ZeroDivisionError, match="planted") as caught:
        solver.solve(contact)
    assert "broken_backends.py" in "".join(traceback.format_exception(caught.value))


def test_what_cannot_be_sent_costs_no_process(process, block, answer):
    class Local(Works):
        """It has no importable name."""

    program, contact = block
    solver = process.prepare(Works(), program, Options())
    with pytest.raises((AttributeError, pickle.PicklingError), match="Local"):
        process.ask(1.0, "load", Local())
    assert same(solver.solve(contact), answer)


def test_a_backend_that_only_the_caller_can_import(process, block, monkeypatch):
    module = ModuleType("only_here")
    module.Elsewhere = type("Elsewhere", (Works,), {"__module__": "only_here"})
    monkeypatch.setitem(sys.modules, "only_here", module)
    with pytest.raises(ModuleNotFoundError, match="only_here"):
        process.prepare(module.Elsewhere(), block[0], Options())


def test_files_in_the_working_directory_shadow_nothing(block, tmp_path, monkeypatch):
    (tmp_path / "numpy.py").write_text("raise RuntimeError('shadowed')\n")
    monkeypatch.chdir(tmp_path)
    program, contact = block
    with la.SolverProcess() as process:
        solver = process.prepare(Works(), program, Options(time_limit=1e300))  # beyond any timer
        assert solver.solve(contact).status is la.Status.SOLVED
    gc.collect()  # pipes left open would warn here


def test_input_errors_arrive_whole(process, block):
    error = la.InputError("r", -1.0, "not positive", "give e.g. 1e-3")
    copy = pickle.loads(pickle.dumps(error))
    assert (str(copy), copy.field, copy.value) == (str(error), "r", -1.0)
    newton = la.find_backend("newton")
    with pytest.raises(la.InputError, match="r = 2: outside"):
        process.prepare(newton, block[0], newton.Options(r=2))


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
