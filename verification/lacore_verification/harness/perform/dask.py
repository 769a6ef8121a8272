"""Runs on the workers of a Dask cluster, in the same processes as here.

A worker has one process per thread, so that the time limit of a run is also kept there. If a worker
dies, Dask gives its runs to another one, and only returned results are kept.
"""

import asyncio
import pickle
import sys
import threading
import uuid
from collections.abc import Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, cast

from distributed import (
    CancelledError,
    Client,
    KilledWorker,
    LocalCluster,
    Worker,
    WorkerPlugin,
    as_completed,
    get_worker,
    rpc,
)

import lacore as la
from lacore.reporting.errors import InputError
from lacore.solvers.isolation import release_processes
from lacore_verification.defaults import TIME_LIMIT
from lacore_verification.harness.perform.processes import OnStart, RunProcess, attempt, lost
from lacore_verification.harness.store.provenance import code_version, solvers_of
from lacore_verification.runs.outcome import Evidence, Outcome
from lacore_verification.runs.row import Row
from lacore_verification.runs.run import Run

_PATIENCE = 8  # s, for a scheduler and its workers to respond.


class Children(WorkerPlugin):
    """The processes of one worker, kept between runs; they end with it.

    Args:
        name: of the plugin, one per sweep.
        folders: of cases of users, for imports.
    """

    def __init__(self, name: str, folders: Sequence[str]) -> None:
        self.name = name
        self._folders = folders

    def setup(self, worker: Worker) -> None:
        """Prepare the worker before its first run."""
        sys.path.extend(folder for folder in self._folders if folder not in sys.path)
        self._stop = threading.Event()
        self._lock = threading.Lock()
        self._all: list[RunProcess] = []
        self._idle: list[RunProcess] = []

    def teardown(self, worker: Worker) -> None:
        """End the processes at the end of the sweep or of the worker."""
        self._stop.set()
        with self._lock:
            for child in self._all:
                child.kill()
            for child in self._idle:
                child.close()

    def in_idle_process(self, run: Run, time_limit: float) -> Outcome:
        """Return the outcome of a run, in an idle process."""
        with self._lock:
            child = self._idle.pop() if self._idle else RunProcess()
            if child not in self._all:
                self._all.append(child)
            if self._stop.is_set():  # It was stopped while the run was sent.
                child.kill()
        try:
            return attempt(child, run, time_limit, self._stop)
        finally:
            with self._lock:
                if self._stop.is_set():
                    child.close()
                self._idle.append(child)


def on_worker(
    name: str,
    index: int,
    pickled: bytes,
    time_limit: float,
    solvers: Sequence[str],
    code: str,
) -> tuple[Row, Evidence, str]:
    """Return a run on a worker, and its output.

    Args:
        name: of the plugin.
        index: of the run, for the event of its start.
        pickled: the run; as bytes, because the scheduler need not know the cases.
        time_limit: s.
        solvers: backends of the run.
        code: version of the code of the client, with these.

    Raises:
        InputError: the worker has other code.
    """
    worker = get_worker()
    own = code_version(*solvers)
    release_processes()  # These processes were started to read versions of backends.
    if own != code:
        raise InputError(
            "--scheduler",
            worker.address,
            "this worker has another version of lacore, of Python or of a solver",
            "install the same everywhere: rows say which code they are from",
        )
    worker.log_event(name, index)
    outcome = cast(Children, worker.plugins[name]).in_idle_process(
        pickle.loads(pickled), time_limit
    )
    return outcome.row, outcome.evidence, outcome.log


def run_on_cluster(
    runs: Sequence[Run],
    client: Client,
    folders: Iterable[Path] = (),
    time_limit: float = TIME_LIMIT,
    on_start: OnStart = lambda _: None,
) -> Generator[Outcome, None, None]:
    """Yield outcomes as they come, of all workers; closing the generator stops running ones.

    Args:
        runs: the runs.
        client: of the cluster, see `connected`.
        folders: with cases of users; they have the same paths there.
        time_limit: s, of a run.
        on_start: called from a separate thread.

    Raises:
        InputError: a worker has other code, or the scheduler is gone.
    """
    name = f"lacore-{uuid.uuid4().hex}"
    client.register_plugin(Children(name, [str(folder) for folder in folders]), name=name)
    client.subscribe_topic(name, lambda event: on_start(runs[event[1]]))
    futures: dict[Any, Run] = {}
    for index, run in enumerate(runs):
        solvers = solvers_of(run)
        asked = (name, index, pickle.dumps(run), time_limit, solvers, code_version(*solvers))
        futures[client.submit(on_worker, *asked, pure=False)] = run
    try:
        for future in as_completed(list(futures), loop=client.loop):
            yield _outcome(futures.pop(future), future)
    finally:
        with suppress(OSError, CancelledError, TimeoutError):  # The cluster may be gone.
            client.cancel(list(futures))
            client.unsubscribe_topic(name)
            client.unregister_worker_plugin(name)


def _outcome(run: Run, future: Any) -> Outcome:
    try:
        row, evidence, log = future.result()
    except InputError:
        raise
    except KilledWorker as error:  # Several workers died, each during this run.
        return lost(run, la.Status.FAILED, f"its workers died: {error}")
    except (CancelledError, OSError) as error:
        raise InputError(
            "--scheduler",
            None,
            f"the cluster is gone ({type(error).__name__})",
            "start it and give the same command again: every finished run is kept",
        ) from error
    except Exception as error:  # Errors in transfer; the other runs continue.
        return lost(run, la.Status.FAILED, f"{type(error).__name__}: {error}")
    return Outcome(run, row, evidence, log)


@contextmanager
def connected(address: str, folders: Iterable[Path] = ()) -> Iterator[Client]:
    """Yield a client of the scheduler at an address.

    Raises:
        InputError: it does not respond, has no worker, or a folder does not exist.
    """
    try:
        asyncio.run(asyncio.wait_for(_greet(address), _PATIENCE))
    except Exception as error:  # Any program may be at that address.
        raise InputError(
            "--scheduler",
            address,
            f"does not answer as a Dask scheduler ({type(error).__name__})",
            "start one with `dask scheduler`, and name it as in tcp://127.0.0.1:8786",
        ) from error
    with Client(address, timeout=_PATIENCE, set_as_default=False) as client:
        try:
            client.wait_for_workers(1, timeout=_PATIENCE)
        except TimeoutError as error:
            raise InputError(
                "--scheduler", address, "has no worker", f"start some: `dask worker {address}`"
            ) from error
        for folder in folders:
            if not all(client.run(Path.is_dir, folder).values()):
                raise InputError(
                    "--cases",
                    str(folder),
                    "is not there on every worker",
                    "put it at the same place everywhere",
                )
        yield client


async def _greet(address: str) -> None:
    """Identify a scheduler, because a `Client` without one hangs long after it has given up."""
    async with rpc(address, timeout=_PATIENCE) as scheduler:
        await scheduler.identity()


@contextmanager
def local(jobs: int) -> Iterator[Client]:
    """Yield a client of a cluster in this process, with workers of one thread each.

    The work is done in other processes, so that Ctrl-C is received here only.
    """
    with (
        LocalCluster(
            n_workers=jobs,
            threads_per_worker=1,
            processes=False,
            memory_limit=0,
            dashboard_address="127.0.0.1:0",
        ) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):
        yield client
