"""Runs on the workers of a Dask cluster: the same processes as here, started there.

A worker has a process of ours a thread, so that the time limit of a run holds there, too. A worker
that dies costs nothing: Dask gives its runs to another one, and only what has come back is kept.
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

_PATIENCE = 8  # s, for a scheduler and its workers to answer


class Children(WorkerPlugin):
    """The processes of one worker, kept between runs; they end with it.

    Args:
        name: of the plugin, one a sweep.
        folders: of cases of users, for imports.
    """

    def __init__(self, name: str, folders: Sequence[str]) -> None:
        self.name = name
        self._folders = folders

    def setup(self, worker: Worker) -> None:
        """On the worker, before its first run."""
        sys.path.extend(folder for folder in self._folders if folder not in sys.path)
        self._stop = threading.Event()
        self._lock = threading.Lock()
        self._all: list[RunProcess] = []
        self._idle: list[RunProcess] = []

    def teardown(self, worker: Worker) -> None:
        """On the worker, at the end of the sweep or of the worker."""
        self._stop.set()
        with self._lock:
            for child in self._all:
                child.kill()
            for child in self._idle:
                child.close()

    def in_idle_process(self, run: Run, time_limit: float) -> Outcome:
        """Outcome of a run, in a process that has nothing else to do."""
        with self._lock:
            child = self._idle.pop() if self._idle else RunProcess()
            if child not in self._all:
                self._all.append(child)
            if self._stop.is_set():  # while the run came here
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
    """A run, on a worker, and what it printed.

    Args:
        name: of the plugin.
        index: of the run, for the news that it has begun.
        pickled: the run; as bytes, because the scheduler need not know the cases.
        time_limit: s.
        solvers: backends of the run.
        code: version of the code that asks, with these.

    Raises:
        InputError: the worker has other code.
    """
    worker = get_worker()
    own = code_version(*solvers)
    release_processes()  # in which backends were asked for their versions
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
    """Outcomes as they come, of all workers; closing the generator stops all that are at work.

    Args:
        runs: what to do.
        client: of the cluster, see `connected`.
        folders: with cases of users; they are at the same place there.
        time_limit: s, of a run.
        on_start: called by a thread of its own.

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
        with suppress(OSError, CancelledError, TimeoutError):  # of a cluster that is gone
            client.cancel(list(futures))
            client.unsubscribe_topic(name)
            client.unregister_worker_plugin(name)


def _outcome(run: Run, future: Any) -> Outcome:
    try:
        row, evidence, log = future.result()
    except InputError:
        raise
    except KilledWorker as error:  # several, each while it was at this run
        return lost(run, la.Status.FAILED, f"its workers died: {error}")
    except (CancelledError, OSError) as error:
        raise InputError(
            "--scheduler",
            None,
            f"the cluster is gone ({type(error).__name__})",
            "start it and give the same command again: every finished run is kept",
        ) from error
    except Exception as error:  # on the way there or back: the other runs go on
        return lost(run, la.Status.FAILED, f"{type(error).__name__}: {error}")
    return Outcome(run, row, evidence, log)


@contextmanager
def connected(address: str, folders: Iterable[Path] = ()) -> Iterator[Client]:
    """A client of the scheduler at an address.

    Raises:
        InputError: it does not answer, has no worker, or a folder is not there.
    """
    try:
        asyncio.run(asyncio.wait_for(_greet(address), _PATIENCE))
    except Exception as error:  # whatever is at that address may answer anything
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
    """Ask a scheduler who it is: a `Client` of nobody hangs long after it has given up."""
    async with rpc(address, timeout=_PATIENCE) as scheduler:
        await scheduler.identity()


@contextmanager
def local(jobs: int) -> Iterator[Client]:
    """A client of a cluster in this process, of that many workers of one thread.

    The work is done in processes anyway, and so Ctrl-C comes here only.
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
