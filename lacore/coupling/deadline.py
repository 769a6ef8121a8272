"""A clock for searches that could go on: what they have found by then is kept."""

import time
from collections.abc import Callable

from lacore.coupling.run import Iterate


class OutOfTime(Exception):  # noqa: N818  # it is no error: what was found stands
    """The time of a search is over."""


def until(end: float) -> Callable[[Iterate], None]:
    """To be called after each inner solve.

    Args:
        end: s, of `time.perf_counter`.

    Raises:
        OutOfTime: of what is returned, at the first solve that ends after it.
    """

    def check(_: Iterate) -> None:
        if time.perf_counter() >= end:
            raise OutOfTime

    return check
