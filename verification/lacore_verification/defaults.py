"""Defaults of commands and their help, available without loading solvers."""

import os
from collections.abc import Mapping
from typing import Any

STOPPED = 130
"""Exit code after Ctrl-C, as shells report it."""

TIME_LIMIT = 600.0
"""s, time limit of a run: ten times the time of the largest default one."""

_RAW = {"damping": 1.0, "anderson": 0}
RAW: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    "paper": ("reaction", {"start": "zero", **_RAW}),
    **{f"{name}-raw": (name, _RAW) for name in ("reaction", "shift")},
}
"""Loops without damping and acceleration by name; ``paper`` starts from zero reactions, too."""


def cores() -> int:
    """Return the number of cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not available on all systems
        return os.cpu_count() or 1
