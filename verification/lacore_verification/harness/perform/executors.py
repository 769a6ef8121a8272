"""Executors of commands: processes here, or a Dask cluster."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from lacore.reporting.errors import InputError, install_command

if TYPE_CHECKING:
    from lacore_verification.harness.perform.processes import Executor

_Command = TypeVar("_Command", bound=Callable[..., Any])


def dask_options(command: _Command) -> _Command:
    """Add the arguments `on_dask` and `scheduler` to a command."""
    on_this_machine = click.option(
        "--dask",
        "on_dask",
        is_flag=True,
        help="Run on a local Dask cluster with --jobs workers.",
    )
    on_others = click.option(
        "--scheduler",
        metavar="ADDRESS",
        help="Run on the workers of the Dask scheduler at this address, such as"
        " tcp://127.0.0.1:8786. The workers need the same version of lacore, and the folders of"
        " --cases under the same paths.",
    )
    return on_this_machine(on_others(command))


def require_one_place(on_dask: bool, scheduler: str | None) -> None:
    """Raise `InputError` if two clusters are given."""
    if on_dask and scheduler is not None:
        raise InputError("--dask", None, "--scheduler is given, too", "omit one of them")


@contextmanager
def executor_of(
    jobs: int, on_dask: bool, scheduler: str | None, folders: Sequence[Path] = ()
) -> "Iterator[Executor]":
    """Yield the executor of runs; `folders` are those of cases of users, for imports elsewhere.

    Raises:
        InputError: Dask is not installed, or the scheduler cannot be used.
    """
    if not on_dask and scheduler is None:
        from lacore_verification.harness.perform.processes import run_in_processes

        yield partial(run_in_processes, jobs=jobs)
        return
    try:
        from lacore_verification.harness.perform import dask as dask_execution
    except ImportError as error:
        raise InputError(
            "--dask" if on_dask else "--scheduler",
            scheduler,
            "needs the package distributed",
            install_command("dask"),
        ) from error
    with ExitStack() as stack:
        if scheduler is not None:
            client = stack.enter_context(dask_execution.connected(scheduler, folders))
        else:
            client = stack.enter_context(dask_execution.local(jobs))
        yield partial(dask_execution.run_on_cluster, client=client, folders=folders)
