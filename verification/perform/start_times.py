"""The time of a solve without that of starting and compiling its backend."""

from dataclasses import replace

import lacore as la
from lacore.solvers.isolation import IsolatedBackend
from lacore.solvers.registry import load_backend
from lacore.solvers.served_process import ServedProcess
from verification.case.bracketing import BRACKET
from verification.runs.row import Row


class StartTimes:
    """The clock of the process of a backend, from the begin of a run.

    Args:
        backend: Its name; of one that cannot be loaded, or works in this process, rows stay as
            they are.
    """

    def __init__(self, backend: str) -> None:
        self._backend = backend
        process = _process(backend)
        self._before = 0.0 if process is None else process.start_time

    def apart(self, row: Row) -> Row:
        """Return a row with the time of compilation apart from that of the solve.

        The process may have been started again within the run, as after a crash.
        """
        process = _process(self._backend)
        if process is None:
            return row
        row = replace(row, compile_time=process.compile_time)
        started = process.start_time - self._before
        if not started or row.coupling == BRACKET or not row.solve_time > started:
            return row  # it was started after the solves, as what follows a bracket may do
        return replace(row, solve_time=row.solve_time - started)


def _process(backend: str) -> ServedProcess | None:
    try:
        found = load_backend(backend)
    except la.CapabilityError:  # the row says so
        return None
    return found.process if isinstance(found, IsolatedBackend) else None
