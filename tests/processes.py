"""Processes that were started under a mark in their environment, however far removed (Linux)."""

import signal
import time
import uuid
from contextlib import contextmanager
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCES = tuple(map(str, (ROOT, ROOT / "backends", ROOT / "verification")))
"""Folders with our packages, for PYTHONPATH."""
MARK = "LACORE_TEST_MARK"


@contextmanager
def marked():
    """Everything started inside carries the mark that this gives."""
    mark = uuid.uuid4().hex
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(MARK, mark)
        yield mark


def hear_ctrl_c():
    """In a new process, before its program: shells let what they start in the background ignore it.

    So would these tests and all that they start.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def alive(mark):
    """Ids of living processes (no zombies) with the mark."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if f"{MARK}={mark}".encode() in (folder / "environ").read_bytes():
                found.append(int(folder.name))
        except OSError:  # gone meanwhile, or not ours
            continue
    return found


def wait_for(condition, patience=60.0):
    """The first true value of a condition."""
    deadline = time.monotonic() + patience
    while not (value := condition()):
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.05)
    return value
