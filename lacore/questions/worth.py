"""What a state says of the load factor, as one number with its error."""

import numpy as np

from lacore.limit.state import LimitState
from lacore.status import Status

_PROVEN = {Status.LOCKED: np.inf, Status.UNSAFE: -np.inf, Status.FREE: 0.0}


def worth(state: LimitState) -> float:
    """Load factor that is proven: inf where LOCKED, -inf where UNSAFE, 0 where FREE, else NaN.

    So that no question has to be told apart by statuses: what falls under its dead loads carries
    less than any load, what is locked more.
    """
    return _PROVEN.get(state.status, state.load_factor)


def error(state: LimitState) -> float:
    """By how much a load factor may be wrong by its own residuals, in its unit; 0 of proven ends.

    The largest residual times the power turned over, ``D + |Fd.u| + |alpha|`` at ``F0.u = 1``.
    """
    if state.status in _PROVEN:
        return 0.0
    if state.status is not Status.SOLVED or state.certificate is None or state.point is None:
        return np.nan
    u, full = state.point.velocity, state.discretisation.full
    dead = abs(float(full.dead_load @ u))
    return state.certificate.worst[1] * (2 * abs(state.load_factor) + 2 * dead)
