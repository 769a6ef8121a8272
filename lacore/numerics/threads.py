"""Linear algebra with one thread per caller, when several problems are solved at a time."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager
from functools import cache
from threading import Lock
from types import TracebackType
from typing import Any, TypeVar

from threadpoolctl import ThreadpoolController

Item = TypeVar("Item")
Result = TypeVar("Result")


class _Shared:
    """Limit that several callers enter and leave in any order."""

    def __init__(self) -> None:
        self._lock, self._inside = Lock(), 0
        self._limit: Any = None

    def __enter__(self) -> None:
        with self._lock:
            if not self._inside:
                self._limit = _controller().limit(limits=1, user_api="blas")
            self._inside += 1

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with self._lock:
            self._inside -= 1
            if not self._inside:
                self._limit.restore_original_limits()


_OF_THE_PROCESS = _Shared()  # The number of threads belongs to the process.


def one_thread_each() -> AbstractContextManager[None]:
    """Limit BLAS to one thread per caller, since more would wait for each other.

    The limit applies to the whole process. The last caller that leaves it restores the number of
    threads that the first one found.
    """
    return _OF_THE_PROCESS


def each(work: Callable[[Item], Result], items: Sequence[Item], threads: int) -> Iterator[Result]:
    """Yield the results of items in their order, several computed at a time.

    The order and the results do not depend on the number of threads. Solvers release the
    interpreter, so threads suffice. Items that nobody waits for any more are left out.
    """
    threads = min(threads, len(items))
    if threads < 2:
        yield from map(work, items)
        return
    with one_thread_each(), ThreadPoolExecutor(threads) as pool:
        yield from pool.map(work, items)


@cache
def _controller() -> ThreadpoolController:
    """Return the controller of the loaded libraries.

    Finding them takes as long as a small solve.
    """
    return ThreadpoolController()
