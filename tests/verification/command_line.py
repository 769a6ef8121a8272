"""Commands whose runs and pictures are made in the interpreter of the tests.

To start another one takes longer than most runs. What processes are for is tested where they are
lost (test_broken_backends, test_sweep_kills), and a command as users start it in test_hidden.
"""

from contextlib import contextmanager

import pytest
from click.testing import CliRunner

from verification.commands import cli
from verification.perform.one_run import run_here


def lacore(*words):
    """The result of a command."""
    with one_interpreter():
        return CliRunner().invoke(cli.main, list(map(str, words)))


@contextmanager
def one_interpreter():
    """Nothing below starts a process of ours; backends that need one of their own have it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("verification.perform.processes.run_in_processes", run_in_order)
        patch.setattr("verification.report.drawing._TOGETHER", 1000)
        yield


def run_in_order(runs, jobs=1, *, time_limit, on_start):
    """An executor that runs here."""

    def begun():
        for run in runs:
            on_start(run)
            yield run

    yield from run_here(begun(), time_limit)
