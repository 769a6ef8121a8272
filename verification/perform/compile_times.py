"""The time that a backend took to compile, next to the times of its solves."""

from dataclasses import replace

import lacore as la
from lacore.solvers.isolation import IsolatedBackend
from lacore.solvers.registry import load_backend
from verification.runs.row import Row


def with_compile_time(row: Row) -> Row:
    """Return a row with the time of the warm-up in the process of its backend.

    Rows of a backend that cannot be loaded, or works in this process, stay as they are.
    """
    try:
        found = load_backend(row.backend)
    except la.CapabilityError:  # the row says so
        return row
    if not isinstance(found, IsolatedBackend):
        return row
    return replace(row, compile_time=found.process.compile_time)
