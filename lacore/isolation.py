"""A backend in a process of its own: one that hangs, crashes or is killed becomes a status.

The process is a plain interpreter that reads pickled requests on its standard input and answers
on its standard output; it starts no `multiprocessing`, so that callers need no guarded main module.
"""

import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any

from lacore.backend import Backend, InnerSolution, PreparedSolver
from lacore.program import FrozenContact, KinematicProgram
from lacore.status import Status

GRACE = 2.0  # s that a solver gets beyond its time limit to come back by itself
_START = 60.0  # s, for the interpreter and the imports of the backend
_SERVE = "from lacore.isolation import serve; serve()"


class _LostError(Exception):
    """The process is gone; `status` and the text say how."""

    def __init__(self, status: Status, native: str, message: str) -> None:
        self.status, self.native = status, native
        super().__init__(message)


class SolverProcess:
    """An interpreter that runs backends one after the other; started anew when one kills it.

    A context manager: leaving it stops the process.
    """

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None

    def prepare(
        self, backend: Backend, program: KinematicProgram, options: Any
    ) -> "IsolatedSolver":
        """The backend at work on one program in this process; the one before it is dropped."""
        return IsolatedSolver(self, backend, program, options)

    def ask(self, request: tuple[Any, ...], limit: float) -> Any:
        """Answer to a request within `limit` seconds; exceptions of the other side are raised.

        Raises:
            _LostError: it took longer and was killed, or it ended.
        """
        if self._process is None:
            self._start()
        process = self._process
        assert process is not None
        assert process.stdin is not None
        assert process.stdout is not None
        late = threading.Event()

        def stop() -> None:
            late.set()
            process.kill()

        timer = threading.Timer(limit, stop)
        timer.start()
        try:
            pickle.dump(request, process.stdin)
            process.stdin.flush()
            answer = pickle.load(process.stdout)
        except (OSError, EOFError, pickle.UnpicklingError) as error:
            raise self._lost(late.is_set(), limit) from error
        except BaseException:  # interrupted between request and answer: out of step
            self.close()
            raise
        finally:
            timer.cancel()
        if isinstance(answer, Exception):
            raise answer
        return answer

    def _start(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-c", _SERVE],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        )
        self.ask(("start",), _START)

    def _lost(self, late: bool, limit: float) -> _LostError:
        assert self._process is not None
        self._process.kill()
        code = self._process.wait()
        self.close()
        if late:
            return _LostError(
                Status.TIME_LIMIT,
                "killed",
                f"its process had not come back after {limit:.3g} s and was stopped",
            )
        how = f"exit code {code}"
        if code < 0:
            how = f"signal {-code}, {signal.strsignal(-code)}"
        return _LostError(Status.FAILED, "process ended", f"its process ended by itself ({how})")

    def close(self) -> None:
        """Stop the process; the next request starts another."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            for pipe in (self._process.stdin, self._process.stdout):
                assert pipe is not None
                with suppress(BrokenPipeError):  # of what was not read any more
                    pipe.close()
            self._process = None

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
    """A prepared solver whose work is done by a `SolverProcess`."""

    def __init__(
        self, process: SolverProcess, backend: Backend, program: KinematicProgram, options: Any
    ) -> None:
        self._process, self._limit = process, float(options.time_limit) + GRACE
        self._lost: InnerSolution | None = None
        self._ask("prepare", backend, program, options)

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """As the backend does; a process lost is a status, and final."""
        answer = self._ask("solve", contact)
        return self._lost or answer

    def _ask(self, *request: Any) -> Any:
        if self._lost is not None:
            return None
        begin = time.perf_counter()
        try:
            return self._process.ask(request, self._limit)
        except _LostError as lost:
            spent = time.perf_counter() - begin
            self._lost = InnerSolution(lost.status, lost.native, 0, spent, None, message=str(lost))
            return None

    def close(self) -> None:
        """Drop the solver in the process; the process stays."""
        self._ask("close")


def serve() -> None:
    """The other side: answer requests until standard input ends.

    What the solvers print goes to standard error: standard output carries the answers.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the caller stops this process
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    solver: PreparedSolver | None = None
    while True:
        try:
            kind, *arguments = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        answer: Any = None
        try:
            if kind == "prepare":
                _forget_peak_memory()
                backend, program, options = arguments
                solver = backend.prepare(program, options)
            elif kind == "solve":
                assert solver is not None
                answer = replace(solver.solve(*arguments), peak_memory=_peak_memory())
            elif kind == "close" and solver is not None:
                solver.close()
                solver = None
            sent = pickle.dumps(answer)
        except Exception as error:  # the caller's to handle
            sent = _pickled(error)
        answers.write(sent)
        answers.flush()


def _pickled(error: Exception) -> bytes:
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
