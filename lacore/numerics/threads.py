"""Linear algebra on one thread each, where several problems are solved at a time."""

from contextlib import AbstractContextManager
from typing import Any

from threadpoolctl import threadpool_limits


def one_thread_each() -> AbstractContextManager[Any]:
    """While it is entered, BLAS takes one thread a caller: more would wait for each other.

    Of the whole process: entered once, around all that run at a time.
    """
    limits: AbstractContextManager[Any] = threadpool_limits(1, user_api="blas")
    return limits
