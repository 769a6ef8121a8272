"""A backend in a process of its own: one that hangs, crashes or is killed becomes a status.

The process is a plain interpreter that gets pickled requests on its standard input and answers on
its standard output; it starts no `multiprocessing`, so that callers need no guarded main module.
"""

import faulthandler
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from queue import SimpleQueue
from types import TracebackType
from typing import IO, Any

from lacore.backend import Backend, InnerSolution, PreparedSolver
from lacore.program import FrozenContact, KinematicProgram
from lacore.status import Status

GRACE = 2.0  # s that a solver gets beyond its time limit to come back by itself
_START = 60.0  # s, for the interpreter and the imports of the backend
_SERVE = "from lacore.isolation import serve; serve()"
_LONGEST = threading.TIMEOUT_MAX / 2  # s that a timer can count
_LENGTH = 8  # bytes, of the number before each message that says how long it is


class _LostError(Exception):
    """The process is gone; `status` and the text say how."""

    def __init__(self, status: Status, native: str, message: str) -> None:
        self.status, self.native = status, native
        super().__init__(message)


class SolverProcess:
    """An interpreter that runs backends one after the other; started anew when one kills it.

    A context manager: leaving it stops the process. For one thread at a time: it holds one program.
    """

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._holder: IsolatedSolver | None = None

    def prepare(
        self, backend: Backend, program: KinematicProgram, options: Any
    ) -> "IsolatedSolver":
        """The backend at work on one program in this process; the one before it is dropped."""
        return IsolatedSolver(self, backend, program, options)

    def hand_to(self, solver: "IsolatedSolver | None") -> None:
        """What is asked from now on is about this solver."""
        self._holder = solver

    def held_by(self, solver: "IsolatedSolver") -> bool:
        """Whether the process still has the program of this solver."""
        return self._holder is solver

    def ask(self, limit: float, *request: Any) -> Any:
        """Answer to a request within `limit` seconds; exceptions of the other side are raised.

        Raises:
            _LostError: it took longer and was killed, or it ended.
        """
        message = pickle.dumps((limit, *request))
        if self._process is None:
            self._start()
        process = self._process
        assert process is not None
        assert process.stdin is not None
        assert process.stdout is not None
        late = threading.Event()

        def stop() -> None:
            late.set()
            _kill(process)

        timer = threading.Timer(limit, stop)
        timer.daemon = True  # interrupted while it starts, it must not hold up the end
        sent = b""
        try:
            timer.start()
            _send(process.stdin, message)
            sent = _receive(process.stdout)
        except (OSError, EOFError):
            pass
        except BaseException:  # interrupted between request and answer: out of step
            self.close()
            raise
        finally:
            timer.cancel()
            if timer.is_alive():
                timer.join()  # it may be at work at this very moment
        if late.is_set() or not sent:
            raise self._lost(late.is_set(), limit)
        answer = pickle.loads(sent)
        if isinstance(answer, Exception):
            raise answer
        return answer

    def _start(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", _SERVE],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(path or "." for path in sys.path)},
            start_new_session=True,  # what it starts ends with it; Ctrl-C reaches the caller only
        )
        self.ask(_START, "start")

    def _lost(self, late: bool, limit: float) -> _LostError:
        assert self._process is not None
        process = self._process
        if not late:  # one that ends in good order closes its pipes before
            with suppress(subprocess.TimeoutExpired):
                process.wait(GRACE)
        self.close()
        if late:
            return _LostError(
                Status.TIME_LIMIT,
                "killed",
                f"its process had not come back after {limit:.3g} s and was stopped",
            )
        how = f"exit code {process.returncode}"
        if process.returncode < 0:
            how = f"signal {-process.returncode}, {signal.strsignal(-process.returncode)}"
        return _LostError(Status.FAILED, "process ended", f"its process ended by itself ({how})")

    def close(self) -> None:
        """Stop the process; the next request starts another."""
        process, self._process, self._holder = self._process, None, None
        if process is not None:
            _kill(process)
            process.wait()
            for pipe in (process.stdin, process.stdout):
                assert pipe is not None
                with suppress(BrokenPipeError):  # of what was not read any more
                    pipe.close()

    def __enter__(self) -> "SolverProcess":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


class IsolatedSolver:
    """A prepared solver whose work is done by a `SolverProcess`.

    `load_time`, s: what the process took to start and to import the backend.
    """

    def __init__(
        self, process: SolverProcess, backend: Backend, program: KinematicProgram, options: Any
    ) -> None:
        self._process = process
        self._limit = min(float(options.time_limit) + GRACE, _LONGEST)
        self._lost: InnerSolution | None = None
        process.hand_to(self)
        begin = time.perf_counter()
        self._ask(_START, "load", backend)  # imports are not to be paid from the time limit
        self.load_time = time.perf_counter() - begin
        self._ask(self._limit, "prepare", program, options)

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """As the backend does; a process lost is a status, and final.

        Raises:
            RuntimeError: the process was closed, or given to another program, in the meantime.
        """
        if self._lost is None and not self._process.held_by(self):
            raise RuntimeError("the process of this solver was closed or given to another program")
        answer: InnerSolution = self._ask(self._limit, "solve", contact)
        return self._lost or answer

    def _ask(self, limit: float, *request: Any) -> Any:
        if self._lost is not None:
            return None
        begin = time.perf_counter()
        try:
            return self._process.ask(limit, *request)
        except _LostError as lost:
            spent = time.perf_counter() - begin
            self._lost = InnerSolution(lost.status, lost.native, 0, spent, None, message=str(lost))
            return None

    def close(self) -> None:
        """Drop the solver in the process; the process stays."""
        if self._process.held_by(self):
            self._process.hand_to(None)
            self._ask(self._limit, "close")


@contextmanager
def preparing(
    backend: Backend, options: Any
) -> Iterator[Callable[[KinematicProgram], PreparedSolver]]:
    """A backend at work on one program after the other, isolated where it asks for it."""
    if not backend.capabilities.isolated:
        yield lambda program: backend.prepare(program, options)
        return
    with SolverProcess() as process:
        yield lambda program: process.prepare(backend, program, options)


def serve() -> None:
    """The other side: answer requests until standard input ends.

    Solvers read nothing, and what they print goes to standard error.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the caller stops this process
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(nowhere, 0)
    os.dup2(2, 1)
    inbox: SimpleQueue[bytes] = SimpleQueue()
    threading.Thread(target=_read_all, args=(requests, inbox), daemon=True).start()
    worker = _Worker()
    while True:
        try:
            limit, kind, *arguments = pickle.loads(inbox.get())
            # Should the caller die, and the solver hold the interpreter so that `_read_all` does
            # not notice: this watch needs no interpreter.
            faulthandler.dump_traceback_later(limit + GRACE, exit=True, file=nowhere)
            answer = pickle.dumps(getattr(worker, kind)(*arguments))
        except Exception as error:  # the caller's to handle
            answer = _pickled(error)
        faulthandler.cancel_dump_traceback_later()
        _send(answers, answer)


class _Worker:
    """What can be asked of the process."""

    def __init__(self) -> None:
        self._backend: Backend | None = None
        self._solver: PreparedSolver | None = None

    def start(self) -> None:
        """Nothing: the answer says that the process is up."""

    def load(self, backend: Backend) -> None:
        self._backend, self._solver = backend, None
        _forget_peak_memory()

    def prepare(self, program: KinematicProgram, options: Any) -> None:
        assert self._backend is not None
        self._solver = self._backend.prepare(program, options)

    def solve(self, contact: FrozenContact) -> Any:
        assert self._solver is not None
        answer = self._solver.solve(contact)
        if isinstance(answer, InnerSolution):  # anything else is for `checked_answer`
            return replace(answer, peak_memory=_peak_memory())
        return answer

    def close(self) -> None:
        solver, self._solver = self._solver, None
        if solver is not None:
            solver.close()


def _read_all(requests: IO[bytes], inbox: SimpleQueue[bytes]) -> None:
    """Pass requests on; end the process when there is nobody left to answer, also amid a solve."""
    with suppress(EOFError, OSError):
        while True:
            inbox.put(_receive(requests))
    _kill_group(os.getpid())
    os._exit(0)


def _send(pipe: IO[bytes], message: bytes) -> None:
    pipe.write(len(message).to_bytes(_LENGTH, "little"))
    pipe.write(message)
    pipe.flush()


def _receive(pipe: IO[bytes]) -> bytes:
    """The next message; raises `EOFError` where there is none, or half of one."""
    head = pipe.read(_LENGTH)
    length = int.from_bytes(head, "little")
    message = pipe.read(length) if len(head) == _LENGTH else b""
    if not message or len(message) < length:
        raise EOFError
    return message


def _kill(process: subprocess.Popen[bytes]) -> None:
    """Stop a process and what it has started."""
    _kill_group(process.pid)
    process.kill()


def _kill_group(leader: int) -> None:
    if sys.platform != "win32":
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(leader, signal.SIGKILL)


def _pickled(error: Exception) -> bytes:
    error.add_note("In the process of the backend:\n" + traceback.format_exc())
    try:
        sent = pickle.dumps(error)
        pickle.loads(sent)
    except Exception:  # an exception with arguments of its own may not survive the way
        return pickle.dumps(RuntimeError(f"{type(error).__name__}: {error}"))
    return sent


def _forget_peak_memory() -> None:
    """Let the kernel count the peak afresh, where it can (Linux)."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


def _peak_memory() -> float:
    """Peak resident memory since the last `_forget_peak_memory`, MB; NaN where nobody counts."""
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
    except OSError:
        return float("nan")
    counts = [int(line.split()[1]) for line in lines if line.startswith("VmHWM:")]
    return counts[0] * 1024 / 1e6 if counts else float("nan")
