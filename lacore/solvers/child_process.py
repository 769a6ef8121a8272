"""A separate interpreter that can be stopped: a hang, a crash or an exit becomes a status.

The process is a plain interpreter that reads pickled requests from its standard input and writes
its answers to its standard output; it starts no `multiprocessing`, so that callers need no guarded
main module. A `Codec` writes and reads answers. Pickled answers come only from code of lacore,
since reading them may run any code.
"""

import ctypes
import faulthandler
import os
import pickle
import signal
import subprocess
import sys
import threading
import traceback
import weakref
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from io import TextIOWrapper
from pathlib import Path
from pkgutil import resolve_name
from queue import SimpleQueue
from types import TracebackType
from typing import IO, Any, Protocol, Self

from lacore.reporting.status import Status
from lacore.solvers.process_log import ProcessLog

GRACE = 2.0  # s that work may take beyond its limit before it is stopped
START = 60.0  # s, for the interpreter and its imports
LONGEST = threading.TIMEOUT_MAX / 2  # longest time of a timer, s
_SERVE = "from lacore.solvers.child_process import serve; serve({!r}, {!r})"
ENDED = "process ended"
"""Native status of a solve in which the process of the backend ended."""
_LINES = 1  # _IOLBF of the C library
_LENGTH = 8  # bytes of the length before each message


class LostError(Exception):
    """The process has ended; `status`, `native` and the text describe how."""

    def __init__(self, status: Status, native: str, message: str) -> None:
        self.status, self.native = status, native
        super().__init__(message)


class Codec(Protocol):
    """Writes and reads the answers and errors of the other side."""

    def answer(self, value: Any) -> bytes:
        """Encode what a method returned."""

    def error(self, error: Exception) -> bytes:
        """Encode what a method raised."""

    def read(self, message: bytes) -> Any:
        """Decode an answer; raise the error that was sent instead."""


class Pickled:
    """Codec for answers of any kind from trusted code."""

    def answer(self, value: Any) -> bytes:
        """Encode what a method returned, see `Codec.answer`."""
        return pickle.dumps((value, None))

    def error(self, error: Exception) -> bytes:
        """Encode what a method raised; an exception that cannot be pickled is sent as text."""
        try:
            sent = pickle.dumps((None, error))
            pickle.loads(sent)
        except Exception:  # Exceptions with additional arguments may fail to be read.
            return pickle.dumps((None, RuntimeError(f"{type(error).__name__}: {error}")))
        return sent

    def read(self, message: bytes) -> Any:
        """Decode an answer or raise the error, see `Codec.read`."""
        value, error = pickle.loads(message)
        if error is not None:
            raise error
        return value


class ChildProcess:
    """Interpreter that answers requests one after the other, and restarts after a crash.

    A context manager: leaving it stops the process. For one thread at a time.

    Args:
        worker: ``module:Class`` of the other side. A request is the name of a method with its
            arguments.
        environment: Variables in addition to those of this process.
        codec: ``module:Class`` of the `Codec` of its answers.
        log: Keeps the output of the process; None: it prints to the streams of this process.
    """

    def __init__(
        self,
        worker: str,
        environment: Mapping[str, str] | None = None,
        codec: str = f"{__name__}:{Pickled.__name__}",
        log: ProcessLog | None = None,
    ) -> None:
        self._worker, self._codec_name = worker, codec
        self._codec: Codec = resolve_name(codec)()
        self._environment = dict(environment or {})
        self._log = log
        self._process: subprocess.Popen[bytes] | None = None
        self._killed = False

    @property
    def running(self) -> bool:
        """Whether the process is running, with all the data it has received."""
        return self._process is not None

    def ask(self, limit: float, *request: Any) -> Any:
        """Return the answer to a request within `limit` seconds.

        Exceptions of the process are raised.

        Raises:
            LostError: it took longer and was killed, or it ended.
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
        timer.daemon = True  # If the start is interrupted, the timer must not delay the exit.
        sent = b""
        try:
            timer.start()
            _send(process.stdin, message)
            sent = _receive(process.stdout)
        except (OSError, EOFError):
            pass
        # An interruption between request and answer leaves the process out of step.
        except BaseException:
            self.close()
            raise
        finally:
            timer.cancel()
            if timer.is_alive():
                timer.join()  # The timer may be running at this very moment.
        if late.is_set() or not sent:
            raise self._lost(late.is_set(), limit)
        return self._codec.read(sent)

    def _start(self) -> None:
        places = [path or "." for path in sys.path]
        log = None if self._log is None else self._log.open()
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-c", _SERVE.format(self._worker, self._codec_name)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=log,
                env=os.environ | self._environment | {"PYTHONPATH": os.pathsep.join(places)},
                # Its own children end with it, and Ctrl-C reaches only this process.
                start_new_session=True,
            )
        finally:
            if log is not None:
                os.close(log)
        self._end = weakref.finalize(self, _end, self._process)  # also when the interpreter ends
        if self._killed:  # during the start
            _kill(self._process)
        self.ask(START, "")

    def _lost(self, late: bool, limit: float) -> LostError:
        assert self._process is not None
        process = self._process
        if not late:  # A process that ends normally closes its pipes first.
            with suppress(subprocess.TimeoutExpired):
                process.wait(GRACE)
        self.close()
        if late:
            return LostError(
                Status.TIME_LIMIT,
                "killed",
                f"its process had not come back after {limit:.3g} s and was stopped",
            )
        how = f"exit code {process.returncode}"
        if process.returncode < 0:
            how = f"signal {-process.returncode}, {signal.strsignal(-process.returncode)}"
        return LostError(Status.FAILED, ENDED, f"its process ended by itself ({how})")

    def kill(self) -> None:
        """Stop for good, from any thread; a thread that waits for an answer is notified."""
        self._killed = True
        process = self._process
        if process is not None:
            _kill(process)

    def close(self) -> None:
        """Stop the process; the next request starts another."""
        process, self._process = self._process, None
        if process is not None:
            self._end()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def serve(worker_name: str, codec_name: str) -> None:
    """Answer requests, on the other side, until standard input ends.

    The methods cannot read it, and their output goes to standard error.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # The caller stops this process.
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(nowhere, 0)
    os.dup2(2, 1)
    _print_at_once()
    inbox: SimpleQueue[bytes] = SimpleQueue()
    threading.Thread(target=_read_all, args=(requests, inbox), daemon=True).start()
    worker: Any = None
    codec: Codec = resolve_name(codec_name)()
    me = os.getpid()
    while True:
        try:
            limit, kind, *arguments = pickle.loads(inbox.get())
            # If the caller dies while the solver holds the interpreter lock, `_read_all` does not
            # notice it; this watchdog needs no interpreter.
            faulthandler.dump_traceback_later(limit + GRACE, exit=True, file=nowhere)
            if worker is None:
                worker = resolve_name(worker_name)()
            answer = codec.answer(getattr(worker, kind)(*arguments) if kind else None)
        except Exception as error:  # The caller handles it.
            answer = _sent(codec, error)
        if os.getpid() != me:  # A forked copy must not answer as well.
            os._exit(0)
        faulthandler.cancel_dump_traceback_later()
        _send(answers, answer)


def _print_at_once() -> None:
    """Write each line to a pipe as soon as it ends, before the process is killed."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(line_buffering=True)
    with suppress(Exception):  # If the C library has a different form, lines may be lost.
        library = ctypes.CDLL(None)
        for name in ("stdout", "stderr"):
            library.setvbuf(ctypes.c_void_p.in_dll(library, name), None, _LINES, 0)


def _read_all(requests: IO[bytes], inbox: SimpleQueue[bytes]) -> None:
    """Pass requests on, and end the process when the caller is gone, also during a solve."""
    with suppress(EOFError, OSError):
        while True:
            inbox.put(_receive(requests))
    _kill_group(os.getpid())
    os._exit(0)


def _send(pipe: IO[bytes], message: bytes) -> None:
    with _unsignalled():
        pipe.write(len(message).to_bytes(_LENGTH, "little"))
        pipe.write(message)
        pipe.flush()


@contextmanager
def _unsignalled() -> Iterator[None]:
    """Raise an exception if a pipe is closed, even where the signal would end this process.

    Python ignores that signal, but libraries of the caller, such as gmsh, may have restored it.
    """
    if sys.platform == "win32":
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGPIPE})
    try:
        yield
    finally:
        if signal.SIGPIPE not in before:
            while signal.SIGPIPE in signal.sigpending():
                signal.sigwait({signal.SIGPIPE})
            signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGPIPE})


def _receive(pipe: IO[bytes]) -> bytes:
    """Return the next message; raises `EOFError` if there is none, or half of one."""
    head = pipe.read(_LENGTH)
    length = int.from_bytes(head, "little")
    message = pipe.read(length) if len(head) == _LENGTH else b""
    if not message or len(message) < length:
        raise EOFError
    return message


def _end(process: subprocess.Popen[bytes]) -> None:
    """Stop a process, wait for its end, and close its pipes."""
    _kill(process)
    process.wait()
    for pipe in (process.stdin, process.stdout):
        assert pipe is not None
        with suppress(BrokenPipeError), _unsignalled():  # data that was not read
            pipe.close()


def _kill(process: subprocess.Popen[bytes]) -> None:
    """Stop a process and its children."""
    _kill_group(process.pid)
    process.kill()


def _kill_group(leader: int) -> None:
    if sys.platform != "win32":
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(leader, signal.SIGKILL)


def _sent(codec: Codec, error: Exception) -> bytes:
    error.add_note("In its process:\n" + traceback.format_exc())
    return codec.error(error)


def forget_peak_memory() -> None:
    """Let the kernel count the peak afresh, where it can (Linux)."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


def peak_memory() -> float:
    """Return the peak resident memory since `forget_peak_memory`, MB; NaN where it is unknown."""
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
    except OSError:
        return float("nan")
    counts = [int(line.split()[1]) for line in lines if line.startswith("VmHWM:")]
    return counts[0] * 1024 / 1e6 if counts else float("nan")
