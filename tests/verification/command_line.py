"""Commands whose runs and pictures are made in the interpreter of the tests.

To start another one takes longer than most runs. What processes are for is tested where they are
lost (test_broken_backends, test_sweep_kills), and a command as users start it in test_wheel.
"""

import struct
from contextlib import contextmanager

import pytest
from click.testing import CliRunner

from lacore_verification.commands import cli
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.report.blocks import Picture


def lacore(*words, rendered=True):
    """The result of a command.

    Without pictures of the problem, the mechanism and the bracket, a page of `lacore solve` takes a
    tenth of the time.
    """
    with one_interpreter(rendered):
        return CliRunner().invoke(cli.main, list(map(str, words)))


@contextmanager
def one_interpreter(rendered=True):
    """Nothing below starts a process of ours; backends that need one of their own have it."""
    with pytest.MonkeyPatch.context() as patch:
        if not rendered:
            patch.setattr("lacore_verification.report.problems.page._picture", empty_picture)
        patch.setattr(
            "lacore_verification.harness.perform.processes.run_in_processes", run_in_order
        )
        patch.setattr("lacore_verification.harness.perform.pool.TOGETHER", 1000)
        yield


def empty_picture(name, caption, _thing, _units):
    """A picture of the size 1 by 1 in place of one of a thing."""
    return Picture(name, caption, b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + struct.pack(">II", 1, 1))


def run_in_order(runs, jobs=1, *, time_limit, on_start):
    """An executor that runs here."""

    def begun():
        for run in runs:
            on_start(run)
            yield run

    yield from run_here(begun(), time_limit)
