"""Linear algebra on one thread each, where several problems are solved at a time."""

from contextlib import AbstractContextManager
from functools import cache
from typing import Any

from threadpoolctl import ThreadpoolController


def one_thread_each() -> AbstractContextManager[Any]:
    """While it is entered, BLAS takes one thread a caller: more would wait for each other.

    Of the whole process: entered once, around all that run at a time.
    """
    limits: AbstractContextManager[Any] = _controller().limit(limits=1, user_api="blas")
    return limits


@cache
def _controller() -> ThreadpoolController:
    """Of what is loaded: looking for it takes as long as a small solve."""
    return ThreadpoolController()
