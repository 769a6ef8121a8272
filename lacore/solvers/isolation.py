"""Backends in processes of their own, which only solve: what hangs, crashes or lies stays there.

The process of a backend gets programs and returns numbers. Loops, certificates and verdicts are
computed on this side, from a program that the backend has never seen, by code that it cannot reach.
"""

from __future__ import annotations

import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any

from lacore.errors import BackendError, CapabilityError, InputError
from lacore.program import FrozenContact, KinematicProgram
from lacore.solvers.child_process import GRACE, LONGEST, START, ChildProcess, LostError
from lacore.solvers.contract import Backend, Capabilities, InnerSolution, Writer, failed_answer
from lacore.solvers.description import Description, describe, read_description
from lacore.solvers.plain_answers import read_answer
from lacore.status import Status

_WORKER = "lacore.solvers.solver_worker:SolverWorker"
MOST_PROCESSES = 12  # that a thread keeps: as many as backends are compared, of some 80 MB each
ISOLATE = "LACORE_ISOLATE_BACKENDS"
"""Environment variable of processes in which all backends are isolated, also those of lacore."""
_CODEC = "lacore.solvers.plain_answers:PlainAnswers"


@dataclass(frozen=True)
class Source:
    """Where a backend is found.

    Attributes:
        name: Under which it is registered, with its variant: ``cvxpy:SCS``.
        target: ``module:attribute`` of its class.
        variant: Of a family; empty for the backend itself.
        file: Which registers it, for messages.
    """

    name: str
    target: str
    variant: str = ""
    file: str = ""


class SolverProcess:
    """An interpreter in which a backend works; started again when the backend kills it.

    It serves one backend at a time: for another one it is started again. A context manager:
    leaving it stops the process. For one thread at a time.

    Example:
        >>> with la.SolverProcess() as process:  # a solver that crashes does not end this one
        ...     state = la.solve(la.examples.beam(), process=process)
        >>> round(state.load_factor, 3)
        2.0
    """

    def __init__(self) -> None:
        self._process = ChildProcess(_WORKER, {ISOLATE: ""}, _CODEC)
        self._source: Source | None = None
        self._generation = 0
        self._count = 0
        self._note = ""

    def prepare(self, backend: Backend, program: KinematicProgram, options: Any) -> IsolatedSolver:
        """Put a backend to work on a program in this process.

        Args:
            backend: Registered or not; its class must be importable there, and need no arguments.
            program: In units of the program.
            options: Of the backend.
        """
        return self.isolated(backend).prepare(program, options)

    def isolated(self, backend: Backend) -> IsolatedBackend:
        """Return a backend as it works in this process.

        Args:
            backend: See `prepare`.
        """
        if isinstance(backend, IsolatedBackend):
            return backend.within(self)
        kind, variant = type(backend), backend.name.partition(":")[2]
        source = Source(backend.name, f"{kind.__module__}:{kind.__qualname__}", variant)
        return IsolatedBackend(source, lambda _: backend, self)

    def open(self, source: Source) -> Any:
        """Start the process with a backend, and return what the backend says of itself.

        Raises:
            LostError: It hangs or ends while it is imported.
            BackendError: It raises.
        """
        if self._process.running:
            self.close()
        self._generation += 1
        about = self._process.ask(START, "open", source.target, source.variant)
        self._source = source
        return about

    def serve(self, source: Source) -> None:
        """Have the backend at work here, in a process that nothing else uses.

        Raises:
            LostError, BackendError: See `open`.
        """
        if self._source == source and self._process.running and self._was_busy():
            self.replace_for("it computed while nothing was asked of it")
        if self._source != source or not self._process.running:
            self.open(source)

    def _was_busy(self) -> bool:
        try:
            return bool(self._process.ask(START, "was_busy"))
        except LostError:
            return False  # it is started again anyway

    def new_number(self) -> int:
        """A number for a program that is prepared here."""
        self._count += 1
        return self._count

    @property
    def generation(self) -> int:
        """How often the process was started."""
        return self._generation

    def replace_for(self, why: str) -> None:
        """Stop the process, and note why; see `take_note`."""
        self._note = f"the process of the backend was replaced: {why}"
        self.close()

    def take_note(self) -> str:
        """Return why the process was last replaced, and forget it; empty if it was not."""
        note, self._note = self._note, ""
        return note

    def holds(self, generation: int) -> bool:
        """Whether it still is the process that was started then."""
        return self._generation == generation and self._process.running

    @property
    def processor_time(self) -> float:
        """What it has used since it was started, s; NaN where it is lost."""
        if not self._process.running:
            return 0.0
        try:
            return float(self.ask(START, "processor_time"))
        except LostError:
            return float("nan")

    def ask(self, limit: float, *request: Any) -> Any:
        """As `ChildProcess.ask`."""
        return self._process.ask(limit, *request)

    def close(self) -> None:
        """Stop the process; the next request starts another."""
        self._source = None
        self._process.close()

    def __enter__(self) -> SolverProcess:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


class KeptProcesses(threading.local):
    """The processes that are kept for the backends of a thread, least recently used first."""

    def __init__(self) -> None:
        self._by_source: OrderedDict[Source, SolverProcess] = OrderedDict()

    def of(self, source: Source) -> SolverProcess:
        """The process of a backend; the oldest one is stopped where there are too many."""
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
    """A backend whose work, and whose word about itself, come from a process of its own.

    Args:
        source: Where the backend is found.
        process: In which it works; None: one that is kept for each thread that asks.
        find: Function that finds a backend by its name (for pickle).
    """

    def __init__(
        self, source: Source, find: Callable[[str], Backend], process: SolverProcess | None = None
    ) -> None:
        self._source, self._find, self._given = source, find, process
        self._known: Description | None = None

    @property
    def process(self) -> SolverProcess:
        """In which the backend works for this thread."""
        return _KEPT.of(self._source) if self._given is None else self._given

    def within(self, process: SolverProcess) -> IsolatedBackend:
        """Return the same backend, at work in another process."""
        found = IsolatedBackend(self._source, self._find, process)
        found._known = self._known
        return found

    def knowing(self, backend: Backend) -> IsolatedBackend:
        """Return itself, with what a backend of ours says of itself in this process."""
        self._known = read_description(describe(backend), self._source.name, self._source.file)
        return self

    @property
    def about(self) -> Description:
        """What the backend says of itself; asked once.

        Raises:
            CapabilityError: It cannot be imported, or describes itself wrongly.
        """
        if self._known is not None:
            return self._known
        name, file = self._source.name, self._source.file
        try:
            data = self.process.open(self._source)
        except (LostError, BackendError) as error:
            raise CapabilityError(f"backend {name!r} cannot be loaded: {error} ({file})") from error
        self._known = read_description(data, name, file)
        return self._known

    def start(self) -> None:
        """Start the process of the backend, unless it is at work.

        Raises:
            CapabilityError: It cannot be imported.
        """
        try:
            self.process.serve(self._source)
        except (LostError, BackendError) as error:
            raise CapabilityError(f"backend {self.name!r} cannot be loaded: {error}") from error

    @property
    def name(self) -> str:
        """As registered."""
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
        """What it can do."""
        return self.about.capabilities

    @property
    def statuses(self) -> Mapping[Any, Status]:
        """Every native status of the solver as text, and what it means here."""
        return self.about.statuses

    @cached_property
    def Options(self) -> type:  # noqa: N802  # it is a class
        """Its options; values out of range are rejected by the backend itself."""
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
        """Why it cannot run here and how to get it; empty where it can."""
        return self.about.missing

    def version(self) -> str:
        """The solver and its version."""
        return self.about.version

    def variants(self) -> Sequence[str]:
        """Of a family, the solvers that it knows of."""
        return self.about.variants or ()

    @property
    def writers(self) -> Mapping[str, Writer]:
        """By format, how a program is written to a file."""
        return {ending: partial(self._write, ending) for ending in self.about.formats}

    def _write(
        self, ending: str, program: KinematicProgram, contact: FrozenContact, path: Path
    ) -> None:
        self.process.serve(self._source)
        self.process.ask(START, "write", ending, program, contact, str(Path(path).absolute()))

    def prepare(self, program: KinematicProgram, options: Any) -> IsolatedSolver:
        """The backend at work on one program; a process that is lost is the answer of `solve`."""
        return IsolatedSolver(self.process, self._source, program, options)

    def __reduce__(self) -> tuple[Callable[[str], Backend], tuple[str]]:
        """Pickle by name: processes stay where they are."""
        return self._find, (self._source.name,)


def _remade(find: Callable[[str], Backend], name: str, values: dict[str, Any]) -> Any:
    return find(name).Options(**values)


class IsolatedSolver:
    """A prepared solver whose work is done by a `SolverProcess`."""

    def __init__(
        self, process: SolverProcess, source: Source, program: KinematicProgram, options: Any
    ) -> None:
        self._process = process
        self._limit = min(float(options.time_limit) + GRACE, LONGEST)
        self._lost: InnerSolution | None = None
        self._number = process.new_number()
        self._closed = False
        self._asked(partial(process.serve, source))  # imports are not to be paid from the limit
        self._generation = process.generation
        self._asked(
            partial(process.ask, self._limit, "prepare", self._number, program, asdict(options))
        )

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """As the backend does; a process lost is a status, and final.

        Raises:
            RuntimeError: The process was closed, or given to another backend, in the meantime.
            BackendError: The backend raised an error.
        """
        if self._lost is None and not self._process.holds(self._generation):
            raise RuntimeError("the process of this solver was closed or given to another backend")
        begin = time.perf_counter()
        sent = self._asked(partial(self._process.ask, self._limit, "solve", self._number, contact))
        if self._lost is not None:
            return self._lost
        return _read(sent, time.perf_counter() - begin)

    def _asked(self, ask: Callable[[], Any]) -> Any:
        if self._lost is not None:
            return None
        begin = time.perf_counter()
        try:
            return ask()
        except LostError as lost:
            spent = time.perf_counter() - begin
            self._lost = InnerSolution(lost.status, lost.native, 0, spent, None, message=str(lost))
            return None

    def close(self) -> None:
        """Drop the solver in the process; a process in which something is left running ends."""
        if self._closed or self._lost is not None or not self._process.holds(self._generation):
            return
        self._closed = True
        self._asked(partial(self._process.ask, self._limit, "close", self._number))
        left = self._asked(partial(self._process.ask, START, "rest"))
        if left:
            self._process.replace_for(f"it was left with {left}")


def _read(sent: Any, seconds: float) -> InnerSolution:
    try:
        return read_answer(sent["answer"], seconds, float(sent["memory"]))
    except (KeyError, TypeError, ValueError) as error:
        return failed_answer(f"its process sent no answer: {error}", seconds)
