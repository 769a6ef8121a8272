"""A process of its own: answers belong to their questions."""

import os
import subprocess
import sys
import time

import pytest

from lacore.solvers.child_process import ChildProcess, LostError
from tests.processes import alive, marked, wait_for


class Worker:
    """The other side."""

    def echo(self, value):
        return value

    def fork(self, value):
        """Both copies come back from it, the copy a little later."""
        if os.fork() == 0:
            time.sleep(0.2)
        return value


@pytest.fixture
def child():
    with ChildProcess(f"{__name__}:Worker") as process:
        yield process


@pytest.mark.skipif(sys.platform == "win32", reason="there is no fork")
def test_a_copy_that_work_has_forked_does_not_answer(child):
    with marked() as mark:
        assert child.ask(60.0, "fork", 1) == 1
        wait_for(lambda: len(alive(mark)) == 1)  # the copy has had its time, and is gone
        assert [child.ask(60.0, "echo", n) for n in range(5)] == list(range(5))


def test_an_environment_of_its_own(child):
    assert not child.running
    assert child.ask(60.0, "echo", "first") == "first"
    assert child.running
    child.close()
    assert not child.running
    assert child.ask(60.0, "echo", "again") == "again"


def test_killed_while_it_starts(monkeypatch):
    """Another thread may give up at the very moment in which there is no process yet."""
    child = ChildProcess(f"{__name__}:Worker")
    start = subprocess.Popen

    def slow(*args, **kwargs):
        process = start(*args, **kwargs)
        child.kill()
        return process

    monkeypatch.setattr(subprocess, "Popen", slow)
    with child, pytest.raises(LostError):
        child.ask(60.0, "echo", 1)


_SIGNALLED = """
import os, signal, threading
from lacore.solvers.child_process import ChildProcess, LostError
signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # as gmsh does
def lost():
    with ChildProcess("tests.lacore.solvers.test_child_process:Worker") as child:
        child.ask(60.0, "echo", 1)
        child._process.kill()
        child._process.wait()
        try:
            child.ask(60.0, "echo", bytes(10**6))
        except LostError:
            return
        raise AssertionError
lost()
thread = threading.Thread(target=lost)
thread.start()
thread.join()
print("alive")
"""


@pytest.mark.skipif(sys.platform == "win32", reason="there is no such signal")
def test_a_caller_whose_libraries_let_broken_pipes_end_it():
    ran = subprocess.run([sys.executable, "-c", _SIGNALLED], capture_output=True, text=True)
    assert (ran.returncode, ran.stdout) == (0, "alive\n"), ran.stderr
