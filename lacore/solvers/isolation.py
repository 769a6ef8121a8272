"""Backends in separate processes that only solve, so hangs, crashes and false claims stay there.

The process of a backend receives programs and returns numbers. Loops, certificates and verdicts are
computed on this side, from a copy of the program and by code that the backend cannot reach.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from functools import cached_property, partial
from pathlib import Path
from typing import Any

from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.reporting.errors import BackendError, CapabilityError, InputError
from lacore.reporting.status import Status
from lacore.solvers.child_process import START, LostError
from lacore.solvers.contract import Backend, Capabilities, Writer
from lacore.solvers.description import Description, describe, read_description
from lacore.solvers.isolated_solver import IsolatedSolver
from lacore.solvers.served_process import ServedProcess, Source

MOST_PROCESSES = 12  # limit per thread: as many as backends are compared, of about 80 MB each


class SolverProcess(ServedProcess):
    """Interpreter for one backend at a time, restarted after a crash.

    For another backend it is started again. A context manager: leaving it stops the process. For
    one thread at a time.

    Example:
        >>> with la.SolverProcess() as process:  # a solver that crashes does not end this one
        ...     state = la.solve(la.examples.beam(), process=process)
        >>> round(state.load_factor, 3)
        2.0
    """

    def prepare(self, backend: Backend, program: KinematicProgram, options: Any) -> IsolatedSolver:
        """Prepare a backend for a program in this process.

        Args:
            backend: Registered or not; its class must be importable there, and need no arguments.
            program: Dimensionless program.
            options: Options of the backend.
        """
        return self.isolated(backend).prepare(program, options)

    def isolated(self, backend: Backend) -> IsolatedBackend:
        """Return a backend that works in this process.

        Args:
            backend: See `prepare`.
        """
        if isinstance(backend, IsolatedBackend):
            return backend.within(self)
        kind, variant = type(backend), backend.name.partition(":")[2]
        source = Source(backend.name, f"{kind.__module__}:{kind.__qualname__}", variant)
        return IsolatedBackend(source, lambda _: backend, self)


def make_ready(backend: Backend) -> None:
    """Let a backend start and compile, if it works in a separate process.

    A backend that fails to do so reports it instead of an answer.
    """
    if isinstance(backend, IsolatedBackend):
        with suppress(CapabilityError):
            backend.start()


class KeptProcesses(threading.local):
    """Processes that are kept for the backends of a thread, least recently used first."""

    def __init__(self) -> None:
        self._by_source: OrderedDict[Source, SolverProcess] = OrderedDict()

    def of(self, source: Source) -> SolverProcess:
        """Return the process of a backend; the oldest one is stopped if there are too many."""
        found = self._by_source.setdefault(source, SolverProcess())
        self._by_source.move_to_end(source)
        if len(self._by_source) > MOST_PROCESSES:
            self._by_source.popitem(last=False)[1].close()
        return found

    def close(self) -> None:
        """Stop all of them; the next request to a backend starts its process again."""
        while self._by_source:
            self._by_source.popitem()[1].close()


_KEPT = KeptProcesses()


def release_processes() -> None:
    """Stop the processes that are kept for the backends of this thread."""
    _KEPT.close()


class IsolatedBackend:
    """Backend whose work and description come from a separate process.

    Args:
        source: Where the backend is found.
        process: Process in which it works; None: one is kept for each calling thread.
        find: Function that finds a backend by its name (for pickle).
    """

    def __init__(
        self, source: Source, find: Callable[[str], Backend], process: SolverProcess | None = None
    ) -> None:
        self._source, self._find, self._given = source, find, process
        self._known: Description | None = None
        self._fault = ""

    @property
    def process(self) -> SolverProcess:
        """Process of the backend for this thread."""
        return _KEPT.of(self._source) if self._given is None else self._given

    def within(self, process: SolverProcess) -> IsolatedBackend:
        """Return the same backend, at work in another process."""
        found = IsolatedBackend(self._source, self._find, process)
        found._known, found._fault = self._known, self._fault
        return found

    def knowing(self, backend: Backend) -> IsolatedBackend:
        """Return itself, with the description of one of our backends in this process."""
        self._known = read_description(describe(backend), self._source.name, self._source.file)
        return self

    @property
    def about(self) -> Description:
        """Description of the backend, requested once, also if that fails.

        Raises:
            CapabilityError: It cannot be imported, or its description is wrong.
        """
        if self._known is not None:
            return self._known
        if self._fault:
            raise CapabilityError(self._fault)
        try:
            self._known = self._asked()
        except CapabilityError as error:
            self._fault = str(error)
            raise
        return self._known

    def _asked(self) -> Description:
        name, file = self._source.name, self._source.file
        try:
            data = self.process.open(self._source)
        except (LostError, BackendError) as error:
            raise CapabilityError(f"backend {name!r} cannot be loaded: {error} ({file})") from error
        return read_description(data, name, file)

    def start(self) -> None:
        """Start the process of the backend and let it compile, unless it is at work.

        Raises:
            CapabilityError: It cannot be imported, or does not compile.
        """
        try:
            self.process.warm_up(self._source)
        except (LostError, BackendError) as error:
            raise CapabilityError(f"backend {self.name!r} cannot be loaded: {error}") from error

    @property
    def name(self) -> str:
        """Name under which it is registered."""
        return self._source.name

    @property
    def title(self) -> str:
        """A line for tables."""
        return self.about.title

    @property
    def source(self) -> str:
        """The paper of the method."""
        return self.about.source

    @property
    def capabilities(self) -> Capabilities:
        """Capabilities of the backend."""
        return self.about.capabilities

    @property
    def statuses(self) -> Mapping[Any, Status]:
        """Every native status of the solver as text, with its meaning."""
        return self.about.statuses

    @cached_property
    def Options(self) -> type:  # noqa: N802  # it is a class
        """Class of its options; the backend itself rejects values out of range."""
        return self.about.options_class(self._check, partial(_remade, self._find))

    def _check(self, options: Any) -> None:
        values = asdict(options)
        if values == {own.name: own.default for own in self.about.options}:
            return
        try:
            self.process.serve(self._source)
            self.process.ask(START, "check_options", values)
        except (LostError, BackendError) as error:
            raise InputError(
                f"options of backend {self.name!r}",
                values,
                f"the backend does not take them: {error}",
                "see its options with `lacore backends`",
            ) from error

    def unavailable(self) -> str:
        """Return why it cannot run and how to install it; empty if it can."""
        return self.about.missing

    def version(self) -> str:
        """Return the name and version of the solver."""
        return self.about.version

    def variants(self) -> Sequence[str]:
        """Return the known solvers of a family."""
        return self.about.variants or ()

    @property
    def writers(self) -> Mapping[str, Writer]:
        """Functions that write a program to a file, by format."""
        return {ending: partial(self._write, ending) for ending in self.about.formats}

    def _write(
        self, ending: str, program: KinematicProgram, contact: FrozenContact, path: Path
    ) -> None:
        self.process.serve(self._source)
        self.process.ask(START, "write", ending, program, contact, str(Path(path).absolute()))

    def prepare(self, program: KinematicProgram, options: Any) -> IsolatedSolver:
        """Return the backend prepared for a program; a lost process is reported by `solve`."""
        return IsolatedSolver(self.process, self._source, program, options)

    def __reduce__(self) -> tuple[Callable[[str], Backend], tuple[str]]:
        """Pickle by name: processes stay where they are."""
        return self._find, (self._source.name,)


def _remade(find: Callable[[str], Backend], name: str, values: dict[str, Any]) -> Any:
    return find(name).Options(**values)
