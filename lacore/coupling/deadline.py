"""A time limit for searches, which keep their results when it is reached."""

import time
from collections.abc import Callable

from lacore.coupling.run import Iterate


class OutOfTime(Exception):  # noqa: N818  # not an error: the results so far are kept
    """The time limit of a search is reached."""


def until(end: float) -> Callable[[Iterate], None]:
    """Return a function to call after each inner solve, which checks the time.

    The function raises `OutOfTime` at the first solve that ends after the limit.

    Args:
        end: Limit, s, on the clock of `time.perf_counter`.
    """

    def check(_: Iterate) -> None:
        if time.perf_counter() >= end:
            raise OutOfTime

    return check
