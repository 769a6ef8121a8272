"""Load factor of a state as one number, its error, and proven bounds."""

import numpy as np

from lacore.coupling.kinds import COUPLINGS
from lacore.limit.cells import from_above, from_below
from lacore.limit.hinging import excess
from lacore.limit.outcome import strict_bound
from lacore.limit.state import LimitState
from lacore.reporting.status import Rigor, Scope, Status

_PROVEN = {Status.LOCKED: np.inf, Status.UNSAFE: -np.inf, Status.FREE: 0.0}


def proven_value(state: LimitState) -> float:
    """Return the load factor, as inf if LOCKED, -inf if UNSAFE and 0 if FREE; NaN if not certified.

    Analyses can then compare numbers instead of statuses: a structure that collapses under its
    dead loads carries less than any load factor, and a locked one carries more.
    """
    return _PROVEN.get(state.status, state.load_factor)


def error(state: LimitState) -> float:
    """Return the error of a load factor by its residuals, in its unit; 0 for infinite ones.

    It is the largest residual times ``D + |Fd.u| + |alpha|``, the power at ``F0.u = 1``.
    """
    if state.status in _PROVEN:
        return 0.0
    if state.status is not Status.SOLVED or state.certificate is None or state.point is None:
        return np.nan
    u, full = state.point.velocity, state.discretisation.full
    dead = abs(float(full.dead_load @ u))
    return state.certificate.worst[1] * (2 * abs(state.load_factor) + 2 * dead)


def proven(state: LimitState) -> tuple[float, float]:
    """Return proven bounds of every load factor of the problem of a state; -inf and inf without.

    For blocks and frames without Coulomb friction, these are the load factor with its error. The
    result on one mesh of a deformable body is an upper bound at most, and one with Coulomb friction
    may be one of several load factors. A coupling that solves another problem counts if that bounds
    the stated one.
    """
    stated = state.discretisation.problem
    exact = state.discretisation.scope is Scope.ITSELF
    below, above = (exact and not wrong(stated) for wrong in (from_above, from_below))
    normal, kind = state.discretisation.full.associated_flow, COUPLINGS[state.coupling]
    if state.status is Status.LOCKED:
        locked = below and (normal or not kind.may_be_stronger)
        return (np.inf, np.inf) if locked else (-np.inf, np.inf)
    if state.status is Status.UNSAFE:
        falls = strict_bound(state.discretisation) and (normal or not kind.may_be_weaker)
        return -np.inf, -np.inf if falls else np.inf
    if exact and state.bracket is not None:
        low, high = state.bracket
        return low if below else -np.inf, high if above else np.inf
    if state.rigor not in (Rigor.UPPER, Rigor.LOWER):
        return -np.inf, np.inf
    value = state.load_factor
    near = error(state)
    if excess(state) > 0:  # members under line loads: at most by the tolerance
        near = max(near, 2 * state.tolerance * abs(value))
    lower = value - near if below and normal else -np.inf
    return lower, value + near if state.rigor is Rigor.UPPER else np.inf
