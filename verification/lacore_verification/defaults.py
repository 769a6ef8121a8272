"""What commands and their help say before anything is loaded that solves."""

import os
from collections.abc import Mapping
from typing import Any

STOPPED = 130
"""Exit code after Ctrl-C, as shells report it."""

TIME_LIMIT = 600.0
"""s, of a run: ten times what the largest default one needs."""

_RAW = {"damping": 1.0, "anderson": 0}
RAW: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    "paper": ("reaction", {"start": "zero", **_RAW}),
    **{f"{name}-raw": (name, _RAW) for name in ("reaction", "shift")},
}
"""Loops without damping and acceleration by name; ``paper`` starts from zero reactions, too."""


def cores() -> int:
    """Cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not everywhere
        return os.cpu_count() or 1
