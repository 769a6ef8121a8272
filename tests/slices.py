"""Slices of the slow tests: which tests belong to which one, and the time that a slice may take.

All slow tests take hours. CI runs one slice each day, so that within `SLICES` days all of them run.
"""

import time
from datetime import UTC, datetime
from zlib import crc32

SLICES = 30
"""About 5 000 slow tests of 3 s on the average take 4 h of processor time, 2 h on two cores: of 30
slices each takes 4 to 8 minutes."""
BUDGET = 600.0
"""s, from which no test of a slice is started any more: the last ones may take two minutes."""
LATE = "the time of this slice is over; its other tests run with the next one"
"""Why a test of a slice is skipped."""


def slice_of(name: str) -> int:
    """Return the slice of a test, from 0; it depends on its name alone, not on other tests."""
    return crc32(name.encode()) % SLICES


def slice_of_today() -> int:
    """Return the slice that is due today (UTC), by the day of the year."""
    return datetime.now(UTC).timetuple().tm_yday % SLICES


class Budget:
    """The time of a slice.

    Args:
        seconds: How long tests may be started.
    """

    def __init__(self, seconds: float = BUDGET) -> None:
        self._end = time.monotonic() + seconds

    @property
    def spent(self) -> bool:
        """Whether no test is to be started any more."""
        return time.monotonic() > self._end
