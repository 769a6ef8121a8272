"""Time of a solve without starting and compiling its backend.

A backend may compile at any time, in this process or in its own. Clocks of the same thread are
stopped meanwhile.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager


class _Compilation(threading.local):
    """Seconds that a thread has spent on compilation."""

    seconds = 0.0


_COMPILATION = _Compilation()


@contextmanager
def compiling() -> Iterator[None]:
    """Count the time within as compilation, also if it ends with an error. Not to be nested."""
    begin = time.perf_counter()
    try:
        yield
    finally:
        _COMPILATION.seconds += time.perf_counter() - begin


class SolveClock:
    """Clock that starts when it is made and is stopped while a backend compiles."""

    def __init__(self) -> None:
        self._begin, self._before = time.perf_counter(), _COMPILATION.seconds

    @property
    def seconds(self) -> float:
        """Time since the start, without `compile_time`, s."""
        return time.perf_counter() - self._begin - self.compile_time

    @property
    def compile_time(self) -> float:
        """Time since the start in which backends were started or compiled, s."""
        return _COMPILATION.seconds - self._before


def started(compile_time: float) -> dict[str, str]:
    """Return a line on the start and compilation of a backend; empty if it was ready.

    Args:
        compile_time: Time of the result, s.
    """
    return (
        {"start": f"{compile_time:.3g} s to start and compile the backend"} if compile_time else {}
    )
